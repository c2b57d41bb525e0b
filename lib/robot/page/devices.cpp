// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/devices.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cerberus::robot {

namespace {

constexpr std::size_t kDigits = 64;  // of SHA-256

bool is_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, plain);
}

bool may_be(Role role) {
  return role == Role::viewer || role == Role::operator_;
}

}  // namespace

bool Devices::restore(std::string_view text) {
  devices_.clear();
  Devices read;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (end == text.npos) return false;
    std::array<std::string_view, 3> words{};
    std::string_view line = text.substr(0, end);
    for (std::string_view& word : words) {
      word = line.substr(0, line.find(' '));
      line.remove_prefix(std::min(word.size() + 1, line.size()));
    }
    const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    const Role role = role_of(words[0]).value_or(Role::none);
    if (!line.empty() || words[2].size() != kDigits || !std::ranges::all_of(words[2], is_digit) ||
        !read.fault_of(words[1], role).empty())
      return false;
    read.add(std::string(words[1]), role, std::string(words[2]));
    text.remove_prefix(end + 1);
  }
  devices_ = std::move(read.devices_);
  return true;
}

std::string Devices::state() const {
  std::string text;
  for (const Device& device : devices_)
    text.append(name(device.role)).append(" ").append(device.name).append(" ").append(device.hash) += '\n';
  return text;
}

std::string Devices::fault_of(std::string_view name, Role role) const {
  if (!is_name(name)) return "a device's name is 1 to 64 letters (a to z), digits, - and _";
  if (!may_be(role)) return "a device is a viewer or an operator";
  if (named(name) != nullptr)
    return "there is a device \"" + std::string(name) + "\": revoke it, or take another name";
  if (devices_.size() >= kMost) return "there are " + std::to_string(kMost) + " devices: revoke one";
  return {};
}

void Devices::add(std::string name, Role role, std::string hash) {
  devices_.push_back({std::move(name), role, std::move(hash)});
}

bool Devices::revoke(std::string_view name) {
  return std::erase_if(devices_, [&](const Device& device) { return device.name == name; }) > 0;
}

// The time of the search tells nothing: a hash of a guess is no nearer to another hash.
const Device* Devices::find(std::string_view hash) const {
  const auto found = std::ranges::find(devices_, hash, &Device::hash);
  return found == devices_.end() ? nullptr : &*found;
}

const Device* Devices::named(std::string_view name) const {
  const auto found = std::ranges::find(devices_, name, &Device::name);
  return found == devices_.end() ? nullptr : &*found;
}

}  // namespace cerberus::robot
