// SPDX-License-Identifier: LGPL-2.1-or-later
// The base's yaw rate from a gyro whose bias is learnt while the base stands:
//
//   rate = measured - bias;   bias = mean of the samples of a span in which the base stood
//
// The base stands where the robot reports a rate of 0, or where the camera sees no motion while the head rests. A span is
// not used if the gyro itself does not rest in it, or if the picture has turned altogether although no single frame
// shows it (a slow turn). Until the first span there is no rate. Times are of one clock. Pure; allocates nothing.
#pragma once

#include <array>
#include <optional>

#include "control/base_rate.h"
#include "sensing/pir_model.h"

namespace cerberus::control {

class GyroBias {
 public:
  using Time = motion::Time;

  struct Parameters {
    // Duration of a span. derived: the mean of 50 samples with 0.05 degrees a second of noise (MPU-6050, ICM-20602 at
    // 20 Hz bandwidth, data sheets) is good to 0.007 degrees a second, less than a rule or a pose notices.
    Time span = std::chrono::seconds(1);
    // Largest standard deviation of a span's samples, radians a second. derived: ten times the noise of these gyros; a
    // turn that begins within the span exceeds it.
    double rest = sensing::radians(0.5);
    // Largest bias, radians a second. The MPU-6050's zero-rate output is at most 20 degrees a second (data sheet);
    // beyond that a turn was taken for standing.
    double most = sensing::radians(25);
    // Share by which a new span replaces the old bias. derived: temperature changes a bias within minutes, so five
    // spans may share the work.
    double blend = 0.2;
    // Turn of the picture, radians, up to which a frame shows a standing camera: twice the noise of PoseEstimate.
    double frame_turn = sensing::radians(0.06);
    // The same over a span. derived: a turn of 0.3 degrees a second.
    double span_turn = sensing::radians(0.3);
  };

  GyroBias() = default;
  explicit GyroBias(const Parameters& parameters) : parameters_(parameters) {}
  void reset();

  // Adds a sample, radians a second. A time before the last one's begins anew. Returns the base's rate; nothing while
  // the bias is unknown, and while a rate that the robot reported holds (sensing::kBaseLifetime): its own word goes
  // first.
  std::optional<double> add(Time time, double measured);
  // Adds a frame that was taken at `time`. turn: of the picture since the frame before, as if the base stood; nothing:
  // not measured. rests: the head does. Without effect while a rate that the robot reported holds. Frames may be late,
  // by a second at most.
  void frame(Time time, const std::optional<Turn>& turn, bool rests);
  // The robot reports its rate, radians a second.
  void robot(Time time, double rate);

  std::optional<double> bias() const { return bias_; }

 private:
  struct Sample {
    Time time{};
    double rate = 0;
  };
  static constexpr unsigned kKept = 256;  // over 2 s at 100 samples a second

  const Sample& newest_sample() const { return samples_[(next_ + kKept - 1) % kKept]; }
  void stands(Time time);
  void learn(Time from, Time until);

  Parameters parameters_;
  std::array<Sample, kKept> samples_{};
  unsigned next_ = 0, count_ = 0;
  std::optional<double> bias_;
  std::optional<Time> since_;     // the base stands since then
  Turn turned_;                   // of the picture since then
  std::optional<Time> reported_;  // when the robot spoke last
  Time newest_{};                 // evidence that the base stands
};

}  // namespace cerberus::control
