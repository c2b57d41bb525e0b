// SPDX-License-Identifier: LGPL-2.1-or-later
// Which head a driver's settings mean.
#pragma once

#include <span>
#include <string>

#include "drivers/helper/option_words.h"

namespace cerberus::drivers {

// One text for all spellings of the same head: "serial:/dev/ttyUSB0 address 1", for a HeadLease. Links to devices are
// followed, host names are not resolved. Empty: a head without a device, one that is still to be discovered, or one whose
// parts the kernel gives to one user only (GPIO lines, PWM channels).
std::string head_place(const std::string& driver, const std::string& device,
                       std::span<const OptionWord> options);

}  // namespace cerberus::drivers
