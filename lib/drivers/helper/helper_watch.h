// SPDX-License-Identifier: LGPL-2.1-or-later
// Judges whether a helper process hangs, by what it promises in its `ready` (head_lines.h):
//
//   `alive`       each line `alive` is answered within `answer`
//   `feedback`    without `alive`: `pose` comes at least every `feedback` while the head is commanded to turn, and once
//                 within `feedback` after that
//   neither       nothing is known; only that it reads its input
//   before ready  `ready` or `fault` comes within `start`
//
// A helper shares the machine with its judge. Time counts only while the judge itself is called in time, kMostStep a call
// at most: what a busy machine or a suspended program keeps from both is not held against the helper. No clock: time is
// CLOCK_MONOTONIC as a parameter.
#pragma once

#include <string>

#include "drivers/helper/head_lines.h"

namespace cerberus::drivers {

class HelperWatch {
 public:
  struct Parameters {
    Time start = std::chrono::seconds(5);          // derived: a slow network camera logs in within it
    Time answer = std::chrono::milliseconds(500);  // asked: the protocol's promise
    // Twice the age at which a position counts as old (HelperClient): the protocol's promise is that one.
    Time feedback = std::chrono::milliseconds(1000);
  };
  // While something is awaited, judge() is called this often.
  static constexpr std::chrono::milliseconds kPeriod{50};
  static constexpr std::chrono::milliseconds kMostStep{100};

  HelperWatch() = default;
  explicit HelperWatch(const Parameters& parameters) : parameters_(parameters) {}

  // A helper was started.
  void begin(Time now);
  // The line `alive` was sent.
  void ask() { asked_ = true; }
  // A line of the helper.
  void take(const HelperLine& line);
  // Called after the lines that have come were taken. turning: the head is commanded to turn. Returns why the helper
  // counts as hung; empty: it does not.
  std::string judge(Time now, bool turning);
  // Whether something is awaited that may make it count as hung.
  bool waits() const { return !ready_ || (alive_ && asked_) || (feedback_ && owes_); }

 private:
  Parameters parameters_;
  bool ready_ = false, alive_ = false, feedback_ = false;
  bool asked_ = false;  // and not answered since
  bool owes_ = false;   // no `pose` has come since the head was commanded to turn
  Time last_{}, waited_{};
};

}  // namespace cerberus::drivers
