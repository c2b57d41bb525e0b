// SPDX-License-Identifier: LGPL-2.1-or-later
// Models of common heads, and the dead time that a driver is configured with for each.
//
//   A  goes to angles, 90 degrees a second, 60 ms, reports nothing       F  as A, reports positions (steppers, servos)
//   B  turns at 24 speeds of an unknown table, 10 commands a second,     K  as B, calibrated
//      80 to 250 ms, configured as 150 (cameras: VISCA, Pelco)
//   C  goes to angles in steps of .44 degrees with 1 degree of play      (cheap servos)
//   D  as B, slower, 400 to 1200 ms, configured as 300 (ONVIF)           L  as D, calibrated
#pragma once

#include "sim/pan_head.h"

namespace cerberus::sim {

inline constexpr char kHeadKinds[] = "AFBKCDL";

struct HeadKind {
  HeadTraits traits;
  double told_dead_time = .06;  // seconds
  bool calibrated = false;      // its speed table and its play are known
  bool reports = false;         // its positions, kReports a second, kReportAge old
  static constexpr double kReports = 20, kReportAge = .05;
};

// The head of a letter of kHeadKinds. What is unknown of it differs by the seed.
HeadKind head_kind(char letter, unsigned seed);

}  // namespace cerberus::sim
