// SPDX-License-Identifier: LGPL-2.1-or-later
// A helper process as cerberus-heads drives it: lines as they are, without a model of the head between.
#pragma once

#include <optional>
#include <string>

#include "drivers/helper/head_lines.h"
#include "drivers/helper/helper_process.h"

namespace cerberus::heads {

// Seconds of CLOCK_MONOTONIC.
double now_seconds();

class HeadLink {
 public:
  static constexpr double kStartPatience =
      5;  // seconds; as pantiltsink waits for a helper, its login included
  // Starts the helper and waits for its `ready` for kStartPatience at most. Returns what is wrong.
  std::string start(const std::string& driver, const drivers::HeadSetup& setup);
  // Speeds in radians a second; sent when they change.
  void turn(double pan, double tilt);
  void send(const std::string& line);
  // Keeps the helper awake, reads its lines for up to `milliseconds`. Returns a fault; empty: none.
  std::string serve(int milliseconds);
  void stop() { turn(0, 0); }
  // Kills the helper: does the head stop without it?
  void kill();
  // Stops the head and waits for the helper's end.
  void finish() { process_.finish(); }

  const drivers::HeadAbilities& abilities() const { return abilities_; }
  // Once: where the head reported to be.
  std::optional<drivers::PoseLine> pose;

 private:
  drivers::HelperProcess process_;
  drivers::LineBuffer lines_;
  drivers::HeadAbilities abilities_;
  bool ready_ = false;
  std::string fault_, sent_;
  double alive_ = 0;
};

}  // namespace cerberus::heads
