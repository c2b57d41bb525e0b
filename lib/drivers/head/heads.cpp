// SPDX-License-Identifier: LGPL-2.1-or-later
// The table of head drivers.
#include <array>
#include <utility>

#include "drivers/helper/helper_head.h"
#include "drivers/simulated/scripted_head.h"
#include "drivers/simulated/simulated_head.h"

namespace cerberus::drivers {

namespace {

template <typename T>
std::unique_ptr<Head> make() {
  return std::make_unique<T>();
}

constexpr std::array<std::pair<std::string_view, std::unique_ptr<Head> (*)()>, 3> kDrivers{{
    {"simulated", make<SimulatedHead>},
    {"scripted", make<ScriptedHead>},
    {"external", make<HelperHead>},
}};

}  // namespace

std::unique_ptr<Head> make_head(std::string_view driver) {
  for (const auto& [name, maker] : kDrivers)
    if (name == driver) return maker();
  return nullptr;
}

std::string head_drivers() {
  std::string names;
  for (const auto& entry : kDrivers) names.append(names.empty() ? "" : ", ").append(entry.first);
  return names;
}

}  // namespace cerberus::drivers
