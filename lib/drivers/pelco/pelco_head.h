// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that speaks Pelco-D, over a serial line or a converter on TCP or UDP. The protocol acknowledges nothing: what
// is in force is sent again kRepeats times a second, so that a lost frame costs a fifth of a second, and a stop
// kStops times. Positions are queried only if the options declare that the head answers.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/helper/head_device.h"
#include "drivers/pelco/pelco_d.h"
#include "drivers/transport/byte_stream.h"

namespace cerberus::drivers {

struct PelcoOptions {
  std::string device;  // byte_stream.h
  int baud = 2400;
  int address = 1;        // 1 to 255
  double pan_speed = 40;  // degrees a second of the fastest step; the steps are taken as a straight line
  double tilt_speed = 20;
  bool feedback = false;  // ask for positions
};

class PelcoHead final : public HeadDevice {
 public:
  explicit PelcoHead(PelcoOptions options) : options_(std::move(options)) {}
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  bool stopping() const override { return stops_owed_ > 0; }
  void watch(std::vector<pollfd>& fds) const override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::string fault() const override { return fault_; }

  static constexpr std::chrono::milliseconds kRepeat{200};
  static constexpr std::chrono::milliseconds kStopAgain{50};  // a frame takes 29 ms at 2400 baud
  static constexpr int kStops = 5;
  static constexpr std::chrono::milliseconds kReconnect{1000};
  static constexpr std::chrono::milliseconds kSilence{
      1000};                           // without a position, of a head that reports them
  static constexpr double kRate = 10;  // commands a second

 private:
  void send(const pelco::Frame& frame) { stream_.write(frame); }
  void read(Time now);

  PelcoOptions options_;
  motion::Limits limits_;
  ByteStream stream_;
  pelco::Answers answers_;
  int pan_ = 0, tilt_ = 0;  // steps in force
  int stops_owed_ = 0;
  Time sent_{}, asked_{}, tried_{}, pan_time_{};
  pelco::Axis next_query_ = pelco::Axis::pan;
  std::optional<double> pan_degrees_, tilt_degrees_;
  bool new_pose_ = false, connected_ = false;
  std::string fault_;
};

}  // namespace cerberus::drivers
