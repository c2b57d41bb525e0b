// SPDX-License-Identifier: LGPL-2.1-or-later
// How far a head turns, where the options of its driver say so.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/helper/option_words.h"
#include "motion/head_limits.h"

namespace cerberus::drivers {

// The word range= of an ONVIF camera, "PAN-MIN,PAN-MAX,TILT-MIN,TILT-MAX" in degrees, each MIN below its MAX. Nothing: it is
// none. The speeds are those of any limits.
std::optional<motion::Limits> parse_range(std::string_view text);

// What of the limits the head does not reach, for a user; empty: nothing, or no option says so. Words that cannot be read
// are the driver's to refuse.
std::string beyond_reach(const std::string& driver, std::span<const OptionWord> options,
                         const motion::Limits& limits);

}  // namespace cerberus::drivers
