// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/evdev/input_codes.h"

#include <linux/input-event-codes.h>

#include <charconv>

namespace cerberus::drivers {

namespace {

constexpr std::string_view kKey = "key:", kSwitch = "switch:";

// A run of codes whose names end in consecutive numbers, or a single one.
struct Named {
  std::string_view name;
  InputCode code;
  unsigned count = 0, first = 0;  // 0: a single name, without a number
};

constexpr Named kNames[] = {
    {"BTN_TRIGGER_HAPPY", {EV_KEY, BTN_TRIGGER_HAPPY1}, 40, 1},
    {"BTN_", {EV_KEY, BTN_0}, 10, 0},
    {"KEY_PROG", {EV_KEY, KEY_PROG1}, 2, 1},
    {"KEY_PROG", {EV_KEY, KEY_PROG3}, 2, 3},
    {"KEY_WAKEUP", {EV_KEY, KEY_WAKEUP}},
    {"SW_LID", {EV_SW, SW_LID}},
    {"SW_DOCK", {EV_SW, SW_DOCK}},
    {"SW_FRONT_PROXIMITY", {EV_SW, SW_FRONT_PROXIMITY}},
    {"SW_MACHINE_COVER", {EV_SW, SW_MACHINE_COVER}},
};

std::optional<unsigned> number_of(std::string_view text) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<InputCode> numbered(std::string_view text, std::uint16_t type, unsigned most) {
  const auto number = number_of(text);
  if (!number || *number > most) return std::nullopt;
  return InputCode{type, static_cast<std::uint16_t>(*number)};
}

}  // namespace

std::optional<InputCode> parse_input_code(std::string_view text) {
  if (text.starts_with(kKey)) return numbered(text.substr(kKey.size()), EV_KEY, KEY_MAX);
  if (text.starts_with(kSwitch)) return numbered(text.substr(kSwitch.size()), EV_SW, SW_MAX);
  for (const Named& named : kNames) {
    if (!text.starts_with(named.name)) continue;
    const std::string_view rest = text.substr(named.name.size());
    if (named.count == 0 && rest.empty()) return named.code;
    const auto number = number_of(rest);
    if (!number || *number < named.first || *number - named.first >= named.count) continue;
    return InputCode{named.code.type, static_cast<std::uint16_t>(named.code.code + *number - named.first)};
  }
  return std::nullopt;
}

std::string input_code_name(const InputCode& code) {
  for (const Named& named : kNames) {
    if (code == named.code && named.count == 0) return std::string(named.name);
    if (code.type != named.code.type || code.code < named.code.code) continue;
    const unsigned offset = code.code - named.code.code;
    if (offset < named.count) return std::string(named.name).append(std::to_string(named.first + offset));
  }
  return std::string(code.type == EV_SW ? kSwitch : kKey).append(std::to_string(code.code));
}

std::string input_code_list(const std::vector<InputCode>& codes) {
  constexpr std::size_t kMost = 16;  // a keyboard has hundreds
  std::string list;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (i == kMost) return list + ", ...";
    list.append(list.empty() ? "" : ", ").append(input_code_name(codes[i]));
  }
  return list;
}

}  // namespace cerberus::drivers
