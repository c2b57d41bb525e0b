// SPDX-License-Identifier: LGPL-2.1-or-later
// What the page may change while a camera runs: properties that stop, lose and move nothing. They last until the camera's
// next start; docs/manual/robot.md lists them.
#pragma once

#include <array>
#include <string_view>

namespace cerberus::robot {

struct LiveSetting {
  std::string_view name, element, property, words;  // `words`: for a person
  double least, most, scale;                        // the property is `scale` times the value
  bool head;                                        // of cameras with a head
};

inline constexpr std::array<LiveSetting, 3> kLiveSettings{{
    {"quality", "jpeg", "quality", "Quality of the pictures, %", 10, 100, 1, false},
    {"return-delay", "fusion", "return-delay", "Return to zero after, s", 0, 600, 1e9, true},
    {"turn-speed", "head", "turn-speed", "Speed of a search, degrees/s", 1, 90, 1, true},
}};

inline const LiveSetting* find_live_setting(std::string_view name) {
  for (const LiveSetting& one : kLiveSettings)
    if (one.name == name) return &one;
  return nullptr;
}

}  // namespace cerberus::robot
