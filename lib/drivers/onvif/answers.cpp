// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/answers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace cerberus::drivers::onvif {
namespace {

constexpr std::size_t kMostReason = 200;  // bytes of a camera's own words in a message
constexpr std::string_view kNotAuthorized[] = {"NotAuthorized", "FailedAuthentication", "InvalidSecurity",
                                               "InvalidSecurityToken", "SenderNotAuthorized"};

std::string without_prefix(const std::string& name) {
  const auto colon = name.rfind(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

// A camera's words become one printable line. UTF-8 is kept whole.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (text.size() > kMostReason) {
    std::size_t end = kMostReason;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    text.resize(end);
  }
  return text;
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> out;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t\r\n", at)) != text.npos) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end;
  }
  return out;
}

Range read_range(XmlElement element) {
  const auto from = element.child("Min").number(), to = element.child("Max").number();
  return from && to && *from < *to ? Range{*from, *to} : Range{};
}

std::vector<Space> read_spaces(XmlElement spaces, std::string_view name) {
  std::vector<Space> out;
  for (const XmlElement& space : spaces.children(name))
    if (std::string uri = space.child("URI").text(); !uri.empty())
      out.push_back({std::move(uri), read_range(space.child("XRange")), read_range(space.child("YRange"))});
  return out;
}

}  // namespace

bool Fault::has(std::string_view name) const {
  return std::find(codes.begin(), codes.end(), name) != codes.end();
}

bool Fault::not_authorized() const {
  return std::any_of(std::begin(kNotAuthorized), std::end(kNotAuthorized),
                     [this](std::string_view name) { return has(name); });
}

std::string Fault::text() const {
  if (reason.empty()) return code;
  return code + ": " + reason;
}

XmlElement body_of(const XmlDocument& document) {
  return document.root().name() == "Envelope" ? document.root().child("Body") : XmlElement();
}

std::optional<Fault> read_fault(XmlElement body) {
  const XmlElement element = body.child("Fault");
  if (!element) return std::nullopt;
  Fault fault;
  // SOAP 1.2: nested Subcodes; a fault of SOAP 1.1 has plain text.
  for (XmlElement code = element.child("Code"); code; code = code.child("Subcode"))
    fault.codes.push_back(printable(without_prefix(code.child("Value").text())));
  if (const XmlElement code = element.child("faultcode"))
    fault.codes.push_back(printable(without_prefix(code.text())));
  if (!fault.codes.empty()) fault.code = fault.codes.back();
  fault.reason = printable(element.child("Reason").child("Text").text());
  if (fault.reason.empty()) fault.reason = printable(element.child("faultstring").text());
  return fault;
}

std::optional<std::chrono::milliseconds> read_system_date_and_time(XmlElement body) {
  using namespace std::chrono;
  const XmlElement utc =
      body.child("GetSystemDateAndTimeResponse").child("SystemDateAndTime").child("UTCDateTime");
  const XmlElement date = utc.child("Date"), time = utc.child("Time");
  const auto part = [](XmlElement of, std::string_view name, double from, double to) -> std::optional<int> {
    const auto value = of.child(name).number();
    if (!value || *value < from || *value > to || *value != std::floor(*value)) return std::nullopt;
    return static_cast<int>(*value);
  };
  const auto y = part(date, "Year", 1970, 9999), m = part(date, "Month", 1, 12), d = part(date, "Day", 1, 31),
             hour = part(time, "Hour", 0, 23), minute = part(time, "Minute", 0, 59),
             second = part(time, "Second", 0, 61);
  if (!y || !m || !d || !hour || !minute || !second) return std::nullopt;
  const year_month_day day{year(*y), month(static_cast<unsigned>(*m)),
                           std::chrono::day(static_cast<unsigned>(*d))};
  if (!day.ok()) return std::nullopt;
  return duration_cast<milliseconds>(sys_days(day).time_since_epoch()) + hours(*hour) + minutes(*minute) +
         seconds(*second);
}

Services read_services(XmlElement body) {
  Services services;
  for (const XmlElement& service : body.child("GetServicesResponse").children("Service")) {
    const std::string space = service.child("Namespace").text(), address = service.child("XAddr").text();
    if (space == "http://www.onvif.org/ver10/media/wsdl") services.media = address;
    if (space == "http://www.onvif.org/ver20/media/wsdl") services.media2 = address;
    if (space == "http://www.onvif.org/ver20/ptz/wsdl") services.ptz = address;
  }
  const XmlElement capabilities = body.child("GetCapabilitiesResponse").child("Capabilities");
  if (capabilities) {
    services.media = capabilities.child("Media").child("XAddr").text();
    services.ptz = capabilities.child("PTZ").child("XAddr").text();
  }
  return services;
}

std::vector<Profile> read_profiles(XmlElement body) {
  std::vector<Profile> profiles;
  for (const XmlElement& element : body.child("GetProfilesResponse").children("Profiles")) {
    Profile profile{element.attribute("token"), element.child("Name").text(),
                    element.child("PTZConfiguration").attribute("token")};
    if (profile.configuration.empty())
      profile.configuration = element.child("Configurations").child("PTZ").attribute("token");
    if (!profile.token.empty()) profiles.push_back(std::move(profile));
  }
  return profiles;
}

namespace {

PtzOptions read_options(XmlElement spaces, XmlElement timeout) {
  std::optional<Space> zoom;
  if (const auto found = read_spaces(spaces, "AbsoluteZoomPositionSpace"); !found.empty()) {
    zoom = found.front();
    // The range of the generic space; a wider one is taken only where the camera names it.
    const XmlElement range = spaces.child("AbsoluteZoomPositionSpace").child("XRange");
    if (const auto from = range.child("Min").number(), to = range.child("Max").number();
        !from || !to || !(*from < *to))
      zoom->x = {0, 1};
  }
  return PtzOptions{.positions = read_spaces(spaces, "AbsolutePanTiltPositionSpace"),
                    .velocities = read_spaces(spaces, "ContinuousPanTiltVelocitySpace"),
                    .speeds = read_spaces(spaces, "PanTiltSpeedSpace"),
                    .zoom = std::move(zoom),
                    .least_timeout = read_duration(timeout.child("Min").text()),
                    .most_timeout = read_duration(timeout.child("Max").text())};
}

}  // namespace

std::optional<PtzOptions> read_configuration_options(XmlElement body) {
  const XmlElement options = body.child("GetConfigurationOptionsResponse").child("PTZConfigurationOptions");
  if (!options) return std::nullopt;
  return read_options(options.child("Spaces"), options.child("PTZTimeout"));
}

std::vector<PtzNode> read_nodes(XmlElement body) {
  std::vector<PtzNode> nodes;
  for (const XmlElement& node : body.child("GetNodesResponse").children("PTZNode"))
    nodes.push_back({node.attribute("token"), node.child("Name").text(),
                     read_options(node.child("SupportedPTZSpaces"), {})});
  return nodes;
}

std::optional<PtzStatus> read_status(XmlElement body) {
  const XmlElement element = body.child("GetStatusResponse").child("PTZStatus");
  if (!element) return std::nullopt;
  PtzStatus status;
  const XmlElement pan_tilt = element.child("Position").child("PanTilt");
  const auto x = pan_tilt.number("x"), y = pan_tilt.number("y");
  if (x && y) status.position = Space{pan_tilt.attribute("space"), {*x, *x}, {*y, *y}};
  const XmlElement zoom = element.child("Position").child("Zoom");
  status.zoom = zoom.number("x");
  status.zoom_space = zoom.attribute("space");
  const std::string moving = element.child("MoveStatus").child("PanTilt").text();
  if (moving == "MOVING" || moving == "IDLE") status.moving = moving == "MOVING";
  return status;
}

std::optional<double> zoom_share(const PtzStatus& status, const PtzOptions& options) {
  constexpr std::string_view kGeneric = "http://www.onvif.org/ver10/tptz/ZoomSpaces/PositionGenericSpace";
  constexpr double kSlack = 0.01;  // of the range: cameras round
  if (!status.zoom) return std::nullopt;
  const bool of_options =
      options.zoom && (status.zoom_space.empty() || status.zoom_space == options.zoom->uri);
  if (options.zoom && !of_options && status.zoom_space != kGeneric) return std::nullopt;
  const Range range = of_options ? options.zoom->x : Range{0, 1};
  const double share = (*status.zoom - range.from) / (range.to - range.from);
  if (share < -kSlack || share > 1 + kSlack) return std::nullopt;
  return std::clamp(share, 0.0, 1.0);
}

std::vector<Preset> read_presets(XmlElement body) {
  std::vector<Preset> presets;
  for (const XmlElement& preset : body.child("GetPresetsResponse").children("Preset"))
    if (std::string token = preset.attribute("token"); !token.empty())
      presets.push_back({std::move(token), preset.child("Name").text()});
  return presets;
}

std::vector<ProbeMatch> read_probe_matches(const XmlDocument& document, std::string& relates_to) {
  relates_to = document.root().child("Header").child("RelatesTo").text();
  std::vector<ProbeMatch> matches;
  for (const XmlElement& match : body_of(document).child("ProbeMatches").children("ProbeMatch"))
    matches.push_back({match.child("EndpointReference").child("Address").text(),
                       words(match.child("XAddrs").text()), words(match.child("Scopes").text())});
  return matches;
}

std::optional<std::chrono::milliseconds> read_duration(std::string_view text) {
  if (!text.starts_with('P')) return std::nullopt;
  text.remove_prefix(1);
  double seconds = 0;
  bool time = false, any = false;
  while (!text.empty()) {
    if (text.front() == 'T' && !time) {
      time = true;
      text.remove_prefix(1);
      continue;
    }
    double value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
    if (error != std::errc() || end == text.data() + text.size() || !(value >= 0)) return std::nullopt;
    const char unit = *end;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
    const double each = !time         ? (unit == 'D' ? 86400 : 0)
                        : unit == 'H' ? 3600
                        : unit == 'M' ? 60
                        : unit == 'S' ? 1
                                      : 0;
    if (each == 0) {
      if (value != 0) return std::nullopt;  // zero years and months are fine
      continue;
    }
    seconds += value * each;
    any = true;
  }
  if (!any) return std::nullopt;
  return std::chrono::milliseconds(static_cast<long>(std::min(seconds, 86400.0) * 1000));
}

}  // namespace cerberus::drivers::onvif
