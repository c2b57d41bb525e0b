// SPDX-License-Identifier: LGPL-2.1-or-later
// What ONVIF cameras answer, taken from the content of SOAP's Body. A reader returns nothing (or an empty list) where the
// answer is not the expected one; what is missing in it is absent. Numbers of foreign origin are finite.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/onvif/soap/xml.h"

namespace cerberus::drivers::onvif {

// A SOAP fault: its innermost code without prefix (NotAuthorized, SpaceNotSupported, ...) and its reason.
struct Fault {
  std::string code;
  std::vector<std::string> codes;  // from the outermost to the innermost, without prefixes
  std::string reason;              // at most 200 bytes, printable

  bool has(std::string_view name) const;
  bool not_authorized() const;
  // For messages: "NotAuthorized: Sender not authorized".
  std::string text() const;
};

// SOAP's Body of an envelope; absent if it is none.
XmlElement body_of(const XmlDocument& document);
// The fault that a Body holds.
std::optional<Fault> read_fault(XmlElement body);

// The camera's UTC time since 1970.
std::optional<std::chrono::milliseconds> read_system_date_and_time(XmlElement body);

// The addresses (XAddr) of the services, as the camera claims them; empty where there is none.
struct Services {
  std::string media, media2, ptz;
};
// Of GetServices or GetCapabilities.
Services read_services(XmlElement body);

struct Profile {
  std::string token;
  std::string name;
  std::string configuration;  // token of its PTZ configuration; empty: it has none
};
// Of either media service.
std::vector<Profile> read_profiles(XmlElement body);

struct Range {
  double from = -1, to = 1;
};
struct Space {
  std::string uri;
  Range x, y;
};
// What a PTZ configuration offers.
struct PtzOptions {
  std::vector<Space> positions, velocities, speeds;
  std::optional<Space> zoom;  // of absolute positions; its y means nothing
  std::optional<std::chrono::milliseconds> least_timeout, most_timeout;  // of ContinuousMove
};
std::optional<PtzOptions> read_configuration_options(XmlElement body);

// What pans and tilts, with what it offers whatever its configuration is.
struct PtzNode {
  std::string token, name;
  PtzOptions options;  // without timeouts
};
std::vector<PtzNode> read_nodes(XmlElement body);

struct PtzStatus {
  std::optional<Space>
      position;                // x.from, y.from hold the position and uri its space, empty: the default one
  std::optional<double> zoom;  // in units of its space
  std::string zoom_space;      // empty: the default one
  std::optional<bool> moving;  // MoveStatus, if it is IDLE or MOVING
};
std::optional<PtzStatus> read_status(XmlElement body);
// The zoom of a status as a share of its range, 0 to 1. Nothing: it is not reported, not within its range, or of a
// space that is neither the one of the options nor the generic one.
std::optional<double> zoom_share(const PtzStatus& status, const PtzOptions& options);

struct Preset {
  std::string token, name;
};
std::vector<Preset> read_presets(XmlElement body);

// A device that answered a probe.
struct ProbeMatch {
  std::string endpoint;                // its permanent identity: urn:uuid:...
  std::vector<std::string> addresses;  // of its device service
  std::vector<std::string> scopes;
};
// relates_to: the identity of the probe, if the answer names one.
std::vector<ProbeMatch> read_probe_matches(const XmlDocument& document, std::string& relates_to);

// xs:duration without years and months: PT1S, P0DT0H1M0.5S. At most a day.
std::optional<std::chrono::milliseconds> read_duration(std::string_view text);

}  // namespace cerberus::drivers::onvif
