// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/color.h"

#include <array>

namespace cerberus::overlay {

namespace {

constexpr std::array<Color, 8> kPalette = {{{1, 1, 1},
                                            {0.902, 0.624, 0.000},    // orange
                                            {0.337, 0.706, 0.914},    // sky blue
                                            {0.000, 0.690, 0.510},    // bluish green, a little lighter
                                            {0.941, 0.894, 0.259},    // yellow
                                            {0.150, 0.520, 0.850},    // blue, lighter: on dark pictures
                                            {0.900, 0.420, 0.100},    // vermilion
                                            {0.860, 0.520, 0.700}}};  // reddish purple

}  // namespace

Color identity_color(std::uint32_t id) {
  return id == 0 ? kPalette[0] : kPalette[1 + (id - 1) % 7];
}

}  // namespace cerberus::overlay
