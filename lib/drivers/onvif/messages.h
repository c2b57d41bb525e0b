// SPDX-License-Identifier: LGPL-2.1-or-later
// Requests of ONVIF's device, media and PTZ services as SOAP 1.2: the bodies, and the envelope around them. Sources: the
// published WSDL files (ver10/device, ver10/media, ver20/ptz), ONVIF Core Specification 5.9 (user name token), WS-Discovery.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace cerberus::drivers::onvif {

// What proves a user's identity in an envelope (WS-Security UsernameToken 1.0).
struct UsernameToken {
  std::string username;
  std::string password;  // the digest in Base64, or the password itself
  bool digest = true;    // which of both
  std::string nonce;     // in Base64
  std::string created;   // the camera's time: 2026-11-22T19:45:00Z
};

struct Request {
  std::string action;  // for the HTTP header
  std::string body;    // the content of SOAP's Body
};

// Pan and tilt in the units of a space; without a space the camera takes the default one of its configuration.
struct PanTilt {
  double x = 0, y = 0;
  std::string space;
};

// Device service.
Request get_system_date_and_time();
Request get_services();
Request get_capabilities();
// Media services; the second one asks for the PTZ configurations as well.
Request get_profiles();
Request get_profiles_media2();
// PTZ service. Tokens are those of the camera's answers.
Request get_configuration_options(std::string_view configuration);
Request get_nodes();
Request get_status(std::string_view profile);
Request get_presets(std::string_view profile);
// timeout: after which the camera shall stop by itself; nothing: the camera's default.
Request continuous_move(std::string_view profile, const PanTilt& velocity,
                        std::optional<std::chrono::milliseconds> timeout);
// speed: as the camera likes where nothing.
Request absolute_move(std::string_view profile, const PanTilt& position, const std::optional<PanTilt>& speed);
// The zoom alone: pan and tilt go on.
Request absolute_zoom(std::string_view profile, double position, std::string_view space);
// Pan and tilt; zoom goes on.
Request stop(std::string_view profile);
Request goto_preset(std::string_view profile, std::string_view preset);
Request goto_home_position(std::string_view profile);

// The whole document.
std::string envelope(const Request& request, const std::optional<UsernameToken>& token);
// WS-Discovery: asks every device with PTZ for its addresses. id: a UUID, new for each probe.
std::string probe(std::string_view id);

// Seconds since 1970 in UTC as 2026-11-22T19:45:00.123Z.
std::string utc_text(std::chrono::milliseconds since_1970);
std::string base64(std::string_view bytes);
// A duration of at least a millisecond as PT1.5S.
std::string duration_text(std::chrono::milliseconds duration);

}  // namespace cerberus::drivers::onvif
