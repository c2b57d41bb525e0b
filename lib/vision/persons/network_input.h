// SPDX-License-Identifier: LGPL-2.1-or-later
// How levels of colours become the numbers that a network takes.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace cerberus::vision {

// (level - mean) * scale, for each of the network's planes in its order.
struct NetworkInput {
  std::array<double, 3> mean{};
  std::array<double, 3> scale{1 / 255.0, 1 / 255.0, 1 / 255.0};
  bool blue_first = false;  // its planes are blue, green, red, else red, green, blue
};

// "0.5" or "103.5,116.3,123.7": one number for all planes, or one for each, with a point in every locale. nullopt: the
// text is neither.
std::optional<std::array<double, 3>> plane_numbers(std::string_view text);

}  // namespace cerberus::vision
