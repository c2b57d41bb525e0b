// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/repeated_start.h"

namespace cerberus::drivers {

std::string RepeatedStart::run(const RepeatedStartParameters& parameters) const {
  for (const double end = now() + parameters.patience;;) {
    const double next = now() + parameters.period;
    const std::string wrong = start();
    if (wrong.empty()) return {};
    report(wrong);
    while (now() < next && !pressed()) pause();
    if (now() >= end || pressed())
      return wrong + ". THE HEAD MAY STILL BE TURNING, and nothing stops it: cut its power";
  }
}

}  // namespace cerberus::drivers
