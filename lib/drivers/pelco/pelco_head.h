// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that speaks Pelco-D, over a serial line or a converter on TCP or UDP. The protocol acknowledges nothing: what
// is in force is sent again every kRepeat, so that a lost frame costs a fifth of a second, and a stop kStops times.
// Positions are queried only if the options declare that the head answers. A head without them is stopped at its limits
// by the speeds that it was sent, and finds its reference by going to a preset, where the options name one.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/pelco/pelco_d.h"
#include "drivers/transport/stream_device.h"

namespace cerberus::drivers {

struct PelcoOptions {
  std::string device;  // byte_stream.h
  int baud = 2400;
  int address = 1;        // 1 to 255
  double pan_speed = 40;  // degrees a second of the fastest step; the steps are taken as a straight line
  double tilt_speed = 20;
  bool feedback = false;  // ask for positions
  int home_preset = 0;    // the preset that looks straight ahead, 1 to 255; 0: there is none
  double home_time = 10;  // seconds after which the head has reached it, from anywhere
};

class PelcoHead final : public StreamDevice {
 public:
  explicit PelcoHead(const PelcoOptions& options)
      : StreamDevice("Pelco-D head", options.device, options.baud), options_(options) {
    reports_ = options.feedback;
    measured_ = {kUnknown, kUnknown};
  }
  std::string check() const override;
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  bool stopping() const override { return stops_owed_ > 0; }
  void home(Time now) override;
  std::optional<HomedLine> take_homed(Time now) override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::optional<double> take_zoom() override { return std::exchange(zoom_, std::nullopt); }
  void zoom(double position, Time) override { zoom_order_ = position; }

  static constexpr std::chrono::milliseconds kRepeat{200};
  static constexpr std::chrono::milliseconds kStopAgain{50};  // a frame takes 29 ms at 2400 baud
  static constexpr int kStops = 5;
  static constexpr std::chrono::milliseconds kSilence{
      1000};  // without a position, of a head that reports them
  // Older positions of the two axes make no pose. derived: each is queried every kRepeat, and one answer may be lost
  static constexpr std::chrono::milliseconds kPairAge{400};
  static constexpr double kRate = 10;  // commands a second
  // The zoom of a head that reports positions is asked for, too.
  static constexpr std::chrono::milliseconds kZoomPeriod{500};
  static constexpr int kZoomInquiries = 3;  // without an answer, after which it is asked for seldom
  static constexpr std::chrono::milliseconds kZoomSeldom{10000};

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  void on_connected(Time now) override;
  void send(const pelco::Frame& frame) { stream_.write(frame); }
  motion::PanTilt speeds_of(int pan, int tilt) const;
  void drive(int pan, int tilt, Time now);
  void read(Time now);
  bool zoom_turn(Time now);

  PelcoOptions options_;
  pelco::Answers answers_;
  int pan_ = 0, tilt_ = 0;  // steps in force
  int stops_owed_ = 0;
  Time sent_{}, asked_{};
  std::optional<Time> home_at_;  // when the head has reached its preset
  pelco::Axis next_query_ = pelco::Axis::pan;
  motion::PanTilt measured_;                         // radians, as reported last; NaN: never
  std::optional<Time> pan_at_, tilt_at_;             // when, on this connection
  bool pan_reports_ = false, tilt_reports_ = false;  // on any connection
  Time connected_at_{};
  bool new_pose_ = false;
  std::optional<double> zoom_, zoom_order_;  // read, and not taken yet; not sent yet
  Time zoom_asked_{};
  int zoom_unanswered_ = 0;
};

}  // namespace cerberus::drivers
