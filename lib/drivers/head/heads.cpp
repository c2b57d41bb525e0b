// SPDX-License-Identifier: LGPL-2.1-or-later
// The table of head drivers.
#include <algorithm>
#include <array>
#include <string_view>

#include "drivers/helper/helper_head.h"
#include "drivers/simulated/scripted_head.h"
#include "drivers/simulated/simulated_head.h"

namespace cerberus::drivers {

namespace {

constexpr std::array<std::string_view, 9> kDrivers{
    "simulated", "scripted", "external", "visca", "pelco-d", "onvif", "stepper-gpio", "servo-pwm", "v4l2"};

}  // namespace

std::unique_ptr<Head> make_head(std::string_view driver) {
  if (driver == "simulated") return std::make_unique<SimulatedHead>();
  if (driver == "scripted") return std::make_unique<ScriptedHead>();
  if (std::find(kDrivers.begin(), kDrivers.end(), driver) == kDrivers.end()) return nullptr;
  return std::make_unique<HelperHead>(std::string(driver));
}

std::string head_drivers() {
  std::string names;
  for (const std::string_view name : kDrivers) names.append(names.empty() ? "" : ", ").append(name);
  return names;
}

}  // namespace cerberus::drivers
