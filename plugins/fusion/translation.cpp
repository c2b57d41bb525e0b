// SPDX-License-Identifier: LGPL-2.1-or-later
#include "translation.hpp"

#include <algorithm>

#include "sensing/angles.h"
#include "settings.hpp"
#include "shared/choices.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {

namespace {

// As somebody would write it: -30, not -29.999999999999986.
double degrees_told(double radians) {
  return text::round_to(sensing::degrees(radians), 6);
}

}  // namespace

const gchar* RuleName::of(std::string_view name) {
  if (!interned_ || name_ != name) {
    name_ = name;
    interned_ = g_intern_string(name_.c_str());
  }
  return interned_;
}

CerberusFusion as_fusion(const fusion::Decision& decision, const SensorSnapshot& moment, RuleName& name) {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  if (!decision.rule_name.empty()) fusion.rule_name = name.of(decision.rule_name);
  fusion.rule = decision.rule;
  fusion.action = told(decision.action);
  fusion.target = decision.target;
  fusion.pan = moment.pan_degrees;
  fusion.sector_from = degrees_told(decision.sector.from);
  fusion.sector_to = degrees_told(decision.sector.to);
  fusion.limited = decision.limited;
  fusion.camera_found = decision.camera_found;
  fusion.n_sensors = static_cast<guint>(moment.count);
  std::copy_n(moment.sensors.begin(), moment.count, std::begin(fusion.sensors));
  std::transform(moment.bearings.begin(), moment.bearings.begin() + static_cast<std::ptrdiff_t>(moment.count),
                 std::begin(fusion.bearings), degrees_told);
  fusion.doubtful = decision.doubtful;
  return fusion;
}

}  // namespace cerberus::plugin
