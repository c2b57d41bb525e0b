// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_place.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

std::string real_path(const std::string& path) {
  std::error_code wrong;
  const std::filesystem::path real = std::filesystem::canonical(path, wrong);
  return wrong ? path : real.string();
}

// The last value of that word; else `usual`.
std::string word_of(std::span<const OptionWord> options, std::string_view key, std::string usual) {
  for (const OptionWord& word : options)
    if (word.key == key) usual = word.value;
  return usual;
}

// HOST:PORT of an ONVIF camera.
std::string host_of(std::string device) {
  const bool encrypted = device.starts_with("https://");
  if (const auto slashes = device.find("//"); slashes != device.npos) device.erase(0, slashes + 2);
  device = device.substr(0, device.find('/'));
  std::ranges::transform(device, device.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  const auto colon = device.rfind(':'), bracket = device.rfind(']');
  const bool has_port = colon != device.npos && (bracket == device.npos || colon > bracket);
  return has_port ? device : device + (encrypted ? ":443" : ":80");
}

}  // namespace

std::string head_place(const std::string& driver, const std::string& device,
                       std::span<const OptionWord> options) {
  constexpr std::string_view kSerial = "serial:";
  if (device.empty()) return {};
  if (driver == "v4l2") return real_path(device);
  if (driver == "onvif" && device != "discover")
    return host_of(device) + " profile " + word_of(options, "profile", "");
  if (driver != "visca" && driver != "pelco-d") return {};
  const bool serial = device.starts_with(kSerial);
  const std::string line = serial ? std::string(kSerial) + real_path(device.substr(kSerial.size())) : device;
  const std::string address = word_of(options, "address", "1");
  const auto number = number_of(address);  // 01 is 1
  return line + " address " + (number ? text::significant(*number, 3).string() : address);
}

}  // namespace cerberus::drivers
