// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/head_kinds.h"

namespace cerberus::sim {

using sensing::radians;

HeadKind head_kind(char letter, unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  // Drawn for every head, so that all of a seed have the same table.
  const double quick = between(.08, .25), slow = between(.4, 1.2);
  const double exponent = between(.8, 1.4), scale = between(.75, 1.25);
  HeadKind kind;
  HeadTraits& t = kind.traits;
  switch (letter) {
    case 'C':
      t.speed = radians(60);
      t.step = radians(.44);
      t.play = radians(1);
      kind.told_dead_time = t.dead_time = .04;
      break;
    case 'B':
    case 'K':
    case 'D':
    case 'L': {
      const bool is_slow = letter == 'D' || letter == 'L';
      t.turns_only = true;
      t.speeds = 24;
      t.table_exponent = exponent;
      t.table_scale = scale;
      t.speed = radians(is_slow ? 60 : 100);
      t.acceleration = radians(is_slow ? 200 : 300);
      t.rate = is_slow ? 5 : 10;
      t.dead_time = is_slow ? slow : quick;
      t.jitter = is_slow ? .05 : .02;
      kind.calibrated = letter == 'K' || letter == 'L';
      kind.told_dead_time = is_slow ? .3 : .15;
      // A calibration measures to the middle of the ramp.
      constexpr double kHalfRamp = .03;
      if (kind.calibrated) kind.told_dead_time = t.dead_time + kHalfRamp;
      break;
    }
    default:
      break;
  }
  kind.reports = letter == 'F';
  return kind;
}

}  // namespace cerberus::sim
