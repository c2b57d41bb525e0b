// SPDX-License-Identifier: LGPL-2.1-or-later
// Keys and switches as a user names them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/evdev/input_device.h"

namespace cerberus::drivers {

// "key:30", "switch:11", or one of the kernel's names that suit a sensor: BTN_0 to BTN_9, BTN_TRIGGER_HAPPY1 to 40,
// KEY_PROG1 to 4, KEY_WAKEUP, SW_LID, SW_DOCK, SW_FRONT_PROXIMITY, SW_MACHINE_COVER. Nothing for another text.
std::optional<InputCode> parse_input_code(std::string_view text);
// The name, or "key:30".
std::string input_code_name(const InputCode& code);
// For a message: "BTN_0, key:30", and "..." after the first 16.
std::string input_code_list(const std::vector<InputCode>& codes);

}  // namespace cerberus::drivers
