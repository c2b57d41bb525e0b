// SPDX-License-Identifier: LGPL-2.1-or-later
// GPIO chips and lines as a user names them, and the errors that name them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/gpio/gpio_lines.h"

namespace cerberus::drivers {

// Opens the chip that `wanted` names: a path, a name (gpiochip0), a number or a label. chip: its path, for messages.
SensorError open_gpio_chip(GpioLines& lines, const std::string& wanted, std::string& chip);
// Appends the offsets of lines by name or number. taken: lines that are used already; naming one twice is an error.
SensorError line_offsets(const GpioLines& lines, const std::string& chip,
                         const std::vector<std::string>& names, std::span<const unsigned> taken,
                         std::vector<unsigned>& offsets);
// Returns the error for lines that the chip refuses. Releases all lines that it gave.
SensorError lines_refused(GpioLines& lines, const std::string& chip, int error,
                          std::span<const unsigned> offsets);
// Returns the error for a chip that was there and answers no more.
SensorError chip_gone(const std::string& chip, int error);

}  // namespace cerberus::drivers
