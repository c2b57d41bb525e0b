// SPDX-License-Identifier: LGPL-2.1-or-later
// Starts the helper of a head that may be turning without one, again and again until it answers: only a helper can stop
// that head. The caller starts, waits and prints; seconds of one clock.
#pragma once

#include <functional>
#include <string>

namespace cerberus::drivers {

struct RepeatedStartParameters {
  double period = 1;     // seconds from one start to the next; derived: at once, without a busy loop
  double patience = 60;  // seconds; derived: a camera that starts anew takes less
};

struct RepeatedStart {
  std::function<std::string()> start;                    // a helper; returns what is wrong
  std::function<double()> now;                           // seconds
  std::function<bool()> pressed;                         // a key, which ends it
  std::function<void()> pause;                           // for some milliseconds
  std::function<void(const std::string& wrong)> report;  // a start that failed

  // Returns an empty text once a helper answers, else why none does.
  std::string run(const RepeatedStartParameters& parameters = {}) const;
};

}  // namespace cerberus::drivers
