// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/messages.h"

#include <cstdio>

#include "drivers/onvif/soap/xml.h"
#include "text/numbers.h"

namespace cerberus::drivers::onvif {
namespace {

constexpr std::string_view kDevice = "http://www.onvif.org/ver10/device/wsdl";
constexpr std::string_view kMedia = "http://www.onvif.org/ver10/media/wsdl";
constexpr std::string_view kMedia2 = "http://www.onvif.org/ver20/media/wsdl";
constexpr std::string_view kPtz = "http://www.onvif.org/ver20/ptz/wsdl";
constexpr std::string_view kSchema = "http://www.onvif.org/ver10/schema";
constexpr std::string_view kSecurity =
    "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-secext-1.0.xsd";
constexpr std::string_view kUtility =
    "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-utility-1.0.xsd";
constexpr std::string_view kTokenProfile =
    "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-username-token-profile-1.0";
constexpr std::string_view kBase64Binary =
    "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-soap-message-security-1.0#Base64Binary";

std::string join(std::initializer_list<std::string_view> pieces) {
  std::string text;
  for (const std::string_view piece : pieces) text += piece;
  return text;
}

// A request `name` of the service `space`; `content` may use the prefix tt.
Request request(std::string_view space, std::string_view name, std::string_view content = {}) {
  return {join({space, "/", name}),
          join({"<", name, " xmlns=\"", space, "\" xmlns:tt=\"", kSchema, "\">", content, "</", name, ">"})};
}

std::string element(std::string_view name, std::string_view text) {
  return join({"<", name, ">", xml_escaped(text), "</", name, ">"});
}

// xs:float in every locale.
std::string pan_tilt(std::string_view name, const PanTilt& value) {
  const std::string space = value.space.empty() ? "" : join({" space=\"", xml_escaped(value.space), "\""});
  return join({"<", name, "><tt:PanTilt x=\"", text::rounded(value.x, 5), "\" y=\"",
               text::rounded(value.y, 5), "\"", space, "/></", name, ">"});
}

}  // namespace

Request get_system_date_and_time() {
  return request(kDevice, "GetSystemDateAndTime");
}
Request get_services() {
  return request(kDevice, "GetServices", "<IncludeCapability>false</IncludeCapability>");
}
Request get_capabilities() {
  return request(kDevice, "GetCapabilities", "<Category>All</Category>");
}
Request get_profiles() {
  return request(kMedia, "GetProfiles");
}
Request get_profiles_media2() {
  return request(kMedia2, "GetProfiles", "<Type>PTZ</Type>");
}
Request get_configuration_options(std::string_view configuration) {
  return request(kPtz, "GetConfigurationOptions", element("ConfigurationToken", configuration));
}
Request get_nodes() {
  return request(kPtz, "GetNodes");
}
Request get_status(std::string_view profile) {
  return request(kPtz, "GetStatus", element("ProfileToken", profile));
}
Request get_presets(std::string_view profile) {
  return request(kPtz, "GetPresets", element("ProfileToken", profile));
}
Request continuous_move(std::string_view profile, const PanTilt& velocity,
                        std::optional<std::chrono::milliseconds> timeout) {
  return request(kPtz, "ContinuousMove",
                 element("ProfileToken", profile) + pan_tilt("Velocity", velocity) +
                     (timeout ? element("Timeout", duration_text(*timeout)) : ""));
}
Request absolute_move(std::string_view profile, const PanTilt& position,
                      const std::optional<PanTilt>& speed) {
  return request(kPtz, "AbsoluteMove",
                 element("ProfileToken", profile) + pan_tilt("Position", position) +
                     (speed ? pan_tilt("Speed", *speed) : ""));
}
Request absolute_zoom(std::string_view profile, double position, std::string_view space) {
  return request(
      kPtz, "AbsoluteMove",
      element("ProfileToken", profile) + join({"<Position><tt:Zoom x=\"", text::rounded(position, 5),
                                               "\" space=\"", xml_escaped(space), "\"/></Position>"}));
}
Request stop(std::string_view profile) {
  return request(kPtz, "Stop",
                 element("ProfileToken", profile) + "<PanTilt>true</PanTilt><Zoom>false</Zoom>");
}
Request goto_preset(std::string_view profile, std::string_view preset) {
  return request(kPtz, "GotoPreset", element("ProfileToken", profile) + element("PresetToken", preset));
}
Request goto_home_position(std::string_view profile) {
  return request(kPtz, "GotoHomePosition", element("ProfileToken", profile));
}

std::string envelope(const Request& request, const std::optional<UsernameToken>& token) {
  std::string header;
  if (token)
    header =
        join({"<s:Header><Security s:mustUnderstand=\"true\" xmlns=\"", kSecurity,
              "\"><UsernameToken><Username>", xml_escaped(token->username), "</Username><Password Type=\"",
              kTokenProfile, "#", token->digest ? "PasswordDigest" : "PasswordText", "\">",
              xml_escaped(token->password), "</Password><Nonce EncodingType=\"", kBase64Binary, "\">",
              xml_escaped(token->nonce), "</Nonce><Created xmlns=\"", kUtility, "\">",
              xml_escaped(token->created), "</Created></UsernameToken></Security></s:Header>"});
  return join(
      {"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
       "<s:Envelope xmlns:s=\"http://www.w3.org/2003/05/soap-envelope\">",
       header, "<s:Body>", request.body, "</s:Body></s:Envelope>"});
}

std::string probe(std::string_view id) {
  return join(
      {"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
       "<s:Envelope xmlns:s=\"http://www.w3.org/2003/05/soap-envelope\" "
       "xmlns:a=\"http://schemas.xmlsoap.org/ws/2004/08/addressing\" "
       "xmlns:d=\"http://schemas.xmlsoap.org/ws/2005/04/discovery\" "
       "xmlns:dn=\"http://www.onvif.org/ver10/network/wsdl\"><s:Header>"
       "<a:Action s:mustUnderstand=\"true\">http://schemas.xmlsoap.org/ws/2005/04/discovery/Probe</a:Action>"
       "<a:MessageID>uuid:",
       xml_escaped(id),
       "</a:MessageID><a:ReplyTo>"
       "<a:Address>http://schemas.xmlsoap.org/ws/2004/08/addressing/role/anonymous</a:Address></a:ReplyTo>"
       "<a:To "
       "s:mustUnderstand=\"true\">urn:schemas-xmlsoap-org:ws:2005:04:discovery</a:To></s:Header><s:Body>"
       "<d:Probe><d:Types>dn:NetworkVideoTransmitter</d:Types></d:Probe></s:Body></s:Envelope>"});
}

std::string utc_text(std::chrono::milliseconds since_1970) {
  using namespace std::chrono;
  const sys_days day = floor<days>(sys_time<milliseconds>(since_1970));
  const year_month_day date(day);
  const hh_mm_ss clock(sys_time<milliseconds>(since_1970) - day);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return text;
}

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) -> unsigned {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0;
    };
    const unsigned group = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (unsigned k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return out;
}

std::string duration_text(std::chrono::milliseconds duration) {
  return join({"PT", text::rounded(static_cast<double>(duration.count()) / 1000, 3), "S"});
}

}  // namespace cerberus::drivers::onvif
