// SPDX-License-Identifier: LGPL-2.1-or-later
// Decisions and choices of lib/fusion, to and from the C API and properties.
#pragma once

#include <cerberus/fusion.h>

#include "fusion/fuser.h"

namespace cerberus::plugin {

// The C API's actions are lib's, number by number.
constexpr CerberusFusionAction to_c(fusion::Action action) {
  return static_cast<CerberusFusionAction>(action);
}
static_assert(to_c(fusion::Action::track) == CERBERUS_FUSION_TRACK &&
              to_c(fusion::Action::turn_left) == CERBERUS_FUSION_TURN_LEFT &&
              to_c(fusion::Action::turn_right) == CERBERUS_FUSION_TURN_RIGHT &&
              to_c(fusion::Action::search) == CERBERUS_FUSION_SEARCH &&
              to_c(fusion::Action::zero) == CERBERUS_FUSION_ZERO &&
              to_c(fusion::Action::hold) == CERBERUS_FUSION_HOLD);

// The choice of a target. Each module registers the enumeration under a name of its own.
inline GType register_target_choice(const char* name) {
  using fusion::TargetChoice;
  static const GEnumValue values[] = {
      {static_cast<int>(TargetChoice::nearest), "The nearest (without distances: feet lowest in the picture)",
       "nearest"},
      {static_cast<int>(TargetChoice::largest), "The largest in the picture", "largest"},
      {static_cast<int>(TargetChoice::newest), "The one that came last", "newest"},
      {0, nullptr, nullptr}};
  return g_enum_register_static(name, values);
}

}  // namespace cerberus::plugin
