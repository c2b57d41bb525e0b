// SPDX-License-Identifier: LGPL-2.1-or-later
#include "translation.hpp"

#include <algorithm>

#include "sensing/angles.h"
#include "shared/choices.hpp"
#include "shared/clock_times.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {

namespace {

// Rounded to a millionth of a degree: -30, not -29.999999999999986.
double rounded_degrees(double radians) {
  return text::round_to(sensing::degrees(radians), 6);
}

}  // namespace

CerberusFusion as_fusion(const fusion::Decisions::Outcome& outcome) {
  const fusion::Decision& decision = outcome.decision;
  const fusion::SensorSnapshot& moment = outcome.snapshot;
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  if (!decision.rule_name.empty()) fusion.rule_name = g_intern_string(decision.rule_name.data());
  fusion.rule = decision.rule;
  fusion.action = to_c(decision.action);
  fusion.target = decision.target;
  fusion.pan = moment.pan_degrees;
  fusion.sector_from = rounded_degrees(decision.sector.from);
  fusion.sector_to = rounded_degrees(decision.sector.to);
  fusion.limited = decision.limited;
  fusion.camera_found = decision.camera_found;
  fusion.n_sensors = static_cast<guint>(moment.count);
  std::copy_n(moment.sensors.begin(), moment.count, std::begin(fusion.sensors));
  std::transform(moment.bearings.begin(), moment.bearings.begin() + static_cast<std::ptrdiff_t>(moment.count),
                 std::begin(fusion.bearings), rounded_degrees);
  fusion.doubtful = decision.doubtful;
  fusion.immediate = decision.immediate;
  fusion.decided = clock_time(outcome.decided);
  return fusion;
}

}  // namespace cerberus::plugin
