// SPDX-License-Identifier: LGPL-2.1-or-later
// A simulated head with limited speed and acceleration, steps, play, latency and a noisy position sensor.
// Deterministic: the same commands with the same times give the same trajectory, and the noise is a function of seed
// and time alone.
//
//   command at t -> from t + latency on the motors follow motion::Plan -> the camera follows the motor with play:
//   while the motor turns to the right, camera = max(camera, motor - backlash / 2),
//   to the left min(camera, motor + backlash / 2)
//
// With a table of a zoom it has one: at the start the widest, and three seconds from end to end.
#pragma once

#include <array>

#include "drivers/head/head.h"

namespace cerberus::drivers {

class SimulatedHead final : public Head {
 public:
  std::string check(const HeadSetup& setup) const override;
  std::string open(const HeadSetup& setup) override;
  void close() noexcept override;
  void stop(Time now) noexcept override;
  std::string command(const HeadCommand& command) override;
  std::string limit(Time now, const motion::Limits& limits) override;
  std::string state(Time time, motion::Pose& pose) override;
  // The head was found `by` (radians) from where it was: its poses before and after `now` are shifted, and the last
  // command continues from there, within the limits; a hold stays where it is, also beyond them. holds: it is replaced by
  // a hold. No command: one that is given earlier than `now` is not stale.
  std::string place(Time now, const motion::PanTilt& by, bool holds = false);
  bool simulated() const override { return true; }
  bool blocks() const override { return false; }

 private:
  // One axis from a time on: the motor's plan, and the camera's position at that time.
  struct Leg {
    motion::Plan plan;
    double camera = 0;
  };
  // The zoom from a time on: towards `end`.
  struct Zoom {
    Time from{};
    double begin = 0, end = 0;
    double at(Time time) const;
  };
  struct Chapter {
    Time from{};
    Leg pan, tilt;
    HeadCommand command;
    Zoom zoom{};
  };
  // Largest number of commands that have not taken effect: 5 s of latency at 50 a second.
  static constexpr unsigned kKept = 256;

  Chapter& nth_last(unsigned n) { return chapters_[(next_ + kKept - 1 - n) % kKept]; }
  const Chapter& chapter_at(Time time, Time& end) const;
  std::string obey(const HeadCommand& command);
  std::string begin(const HeadCommand& command);
  Leg follow(const Leg& leg, Time from, const motion::AxisCommand& command,
             const motion::AxisLimits& limits) const;
  void look_through(const Zoom& zoom, Time time, motion::Pose& pose) const;
  motion::AxisState camera(const Leg& leg, Time time, Time& until) const;
  double noise(Time time, unsigned axis) const;

  HeadSetup setup_;
  std::array<Chapter, kKept> chapters_{};
  unsigned next_ = 0, count_ = 0;  // count 0: closed
  Time commanded_{};               // time of the last command
  Time placed_{};                  // time of the last place()
};

}  // namespace cerberus::drivers
