// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds ONVIF cameras on the local network by WS-Discovery: a Probe by multicast to UDP port 3702, and the answers to it.
// Any machine can answer: what is found is a proposal to a user, and is never sent a password before the user has named it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/onvif/answers.h"

namespace cerberus::drivers::onvif {

struct Found {
  std::string endpoint;  // permanent identity: urn:uuid:...
  std::string device;    // address of the device service, for device=
  std::string name;      // as the camera calls itself; may be empty
  bool operator==(const Found&) const = default;
};

// Where probes go.
struct ProbeTarget {
  std::string address = "239.255.255.250";  // IPv4
  std::uint16_t port = 3702;
};

// Blocks for `time`. wrong: why there could be no probe; empty: good.
std::vector<Found> discover(std::chrono::milliseconds time, std::string& wrong, const ProbeTarget& to = {});

// The device service of the only camera of `found`, for a head whose device is `discover`. Any machine can answer a probe:
// a found camera is sent no password, so that a login is refused. Returns what is wrong; empty: good.
std::string choose_found(const std::vector<Found>& found, bool has_login, std::string& device);

// The camera of one match that came from the host `sender`; an empty device: it has no address that could be used.
Found read_match(const ProbeMatch& match, std::string_view sender);

}  // namespace cerberus::drivers::onvif
