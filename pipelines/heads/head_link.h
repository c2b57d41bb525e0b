// SPDX-License-Identifier: LGPL-2.1-or-later
// A helper process as cerberus-heads drives it: lines as they are, without a model of the head between.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "drivers/helper/head_lines.h"
#include "drivers/helper/helper_process.h"
#include "drivers/helper/helper_watch.h"

namespace cerberus::heads {

// Seconds of CLOCK_MONOTONIC.
double now_seconds();

class HeadLink {
 public:
  // Starts the helper and waits for its `ready`, as long as HelperWatch does. Returns what is wrong.
  std::string start(const std::string& driver, const drivers::HeadSetup& setup);
  // Speeds in radians a second; sent when they change.
  void turn(double pan, double tilt);
  void send(const std::string& line);
  // Keeps the helper awake, reads its lines for up to `milliseconds`. Returns a fault; empty: none. A helper that hangs is
  // killed, and another one stops the head.
  std::string serve(int milliseconds);
  void stop() { turn(0, 0); }
  // Kills the helper: does the head stop without it?
  void kill();
  // After kill(): starts the helper again and again until it answers, since only a helper can stop the head. pressed: a
  // key, which ends that. Returns what is wrong.
  std::string start_again(const std::function<bool()>& pressed = [] { return false; });
  // Stops the head and waits for the helper's end. Returns a fault; empty: none.
  std::string finish();

  const drivers::HeadAbilities& abilities() const { return abilities_; }
  // Once: where the head reported to be; NaN: its line has no numbers.
  std::optional<drivers::PoseLine> pose;

 private:
  // As serve(), of a helper that may hang.
  std::string read(int milliseconds);

  std::string driver_;
  drivers::HeadSetup setup_;
  drivers::HelperProcess process_;
  drivers::HelperWatch watch_;
  drivers::LineBuffer lines_;
  drivers::HeadAbilities abilities_;
  bool ready_ = false;
  std::string fault_, sent_;
  bool lost_ = false;  // it was ready, and hangs or is gone: its head may still turn
  double alive_ = 0;
};

}  // namespace cerberus::heads
