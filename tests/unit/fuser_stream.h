// SPDX-License-Identifier: LGPL-2.1-or-later
// A fuser in a stream of frames, and a head that executes its decisions.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "fusion/fuser.h"
#include "sensing/angles.h"
#include "sensing/own_motion.h"
#include "support/suite.h"

namespace stream {

using namespace cerberus::fusion;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::PulseDoubt;
using cerberus::sensing::radians;

constexpr Time kFrame = 40ms;

inline Track person(std::uint32_t id, TrackState state = TrackState::seen) {
  return {.id = id, .x = 100, .y = 50, .width = 40, .height = 100, .age = 1s, .state = state};
}

// A stream of frames: feeds a fuser and keeps the time.
struct Stream {
  Fuser fuser;
  Time now{};
  double pan = 0;              // degrees
  double yaw_rate = kUnknown;  // degrees a second
  double speed = kUnknown;     // metres a second
  double lens = 0;             // degrees, as a zoom reports it
  std::vector<Track> tracks;
  std::vector<std::uint8_t> sensors{0, 0, 0};

  explicit Stream(const FuserOptions& options = {}) { fuser.set_options(options); }

  const Decision& frame(Time step = kFrame) {
    now += step;
    return fuser.update({.time = now,
                         .tracks = tracks,
                         .sensors = sensors,
                         .pan = radians(pan),
                         .base_yaw_rate = radians(yaw_rate),
                         .base_speed = speed,
                         .lens = radians(lens)});
  }
  const Decision& frames(Time duration) {
    const Time end = now + duration;
    while (now + kFrame < end) frame();
    return frame(end - now);
  }
  // What the sensors say for one frame and no longer.
  const Decision& glimpse(const std::vector<std::uint8_t>& seen) {
    sensors = seen;
    const Decision& decision = frame();
    sensors.assign(seen.size(), 0);
    return decision;
  }
  // A head that executes its commands at 40 degrees a second.
  void obey(const Decision& decision) {
    const double step = 40 * 0.04;
    double target = pan;
    if (decision.action == Action::turn_left) target = -170;
    if (decision.action == Action::turn_right) target = 170;
    if (decision.action == Action::zero) target = 0;
    if (decision.action == Action::search) {
      const double from = degrees(decision.sector.from), to = degrees(decision.sector.to);
      if (pan <= from + 0.5) sweeping_right = true;
      if (pan >= to - 0.5) sweeping_right = false;
      target = sweeping_right ? to : from;
    }
    pan += std::clamp(target - pan, -step, step);
    ck_assert(pan >= -170 && pan <= 170);
  }
  bool sweeping_right = true;
};

inline void assert_sector(const Decision& decision, double from, double to) {
  ck_assert_double_eq_tol(degrees(decision.sector.from), from, 1e-6);
  ck_assert_double_eq_tol(degrees(decision.sector.to), to, 1e-6);
}

inline void assert_says(const Decision& decision, Action action, int rule, const char* rule_name) {
  ck_assert_str_eq(name(decision.action).data(), name(action).data());
  ck_assert_int_eq(decision.rule, rule);
  const std::string said(decision.rule_name);
  ck_assert_str_eq(said.c_str(), rule_name);
}

}  // namespace stream
