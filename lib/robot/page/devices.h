// SPDX-License-Identifier: LGPL-2.1-or-later
// Devices that the page lets in without a password, as a screen without a keyboard: each by a random token of its own, of
// which only a hash is kept. The hash is the caller's; a token has 256 random bits, so that a plain one will do.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robot/page/access.h"

namespace cerberus::robot {

struct Device {
  std::string name;
  Role role = Role::viewer;
  std::string hash;  // in hexadecimal digits
};

class Devices {
 public:
  static constexpr std::size_t kMost = 64;

  // Reads "ROLE NAME HASH" lines. False: the text has another content, and there are no devices.
  bool restore(std::string_view text);
  std::string state() const;

  // What is wrong with a new device; empty: nothing. A name is 1 to 64 letters, digits, - and _, and new; no device is an
  // owner, who does what needs a person.
  std::string fault_of(std::string_view name, Role role) const;
  void add(std::string name, Role role, std::string hash);
  // False: there is none of that name.
  bool revoke(std::string_view name);
  // The device of a hash, nullptr: there is none.
  const Device* find(std::string_view hash) const;
  const Device* named(std::string_view name) const;
  const std::vector<Device>& all() const { return devices_; }

 private:
  std::vector<Device> devices_;
};

}  // namespace cerberus::robot
