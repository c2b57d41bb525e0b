// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/onvif_camera.h"

#include <glib.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace cerberus::tests {
namespace {

constexpr char kSoap[] = "http://www.w3.org/2003/05/soap-envelope";
constexpr char kTt[] = "http://www.onvif.org/ver10/schema";
constexpr char kDevice[] = "http://www.onvif.org/ver10/device/wsdl";
constexpr char kMedia[] = "http://www.onvif.org/ver10/media/wsdl";
constexpr char kMedia2[] = "http://www.onvif.org/ver20/media/wsdl";
constexpr char kPtz[] = "http://www.onvif.org/ver20/ptz/wsdl";
constexpr char kWsse[] = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-secext-1.0.xsd";
constexpr char kWsu[] = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-utility-1.0.xsd";
#define SPACES "http://www.onvif.org/ver10/tptz/PanTiltSpaces/"
#define ZOOM_SPACE "http://www.onvif.org/ver10/tptz/ZoomSpaces/PositionGenericSpace"

// The child of that namespace and name.
const xmlNode* child(const xmlNode* node, const char* space, const char* name) {
  for (const xmlNode* at = node ? node->children : nullptr; at; at = at->next)
    if (at->type == XML_ELEMENT_NODE && at->ns &&
        !std::strcmp(reinterpret_cast<const char*>(at->ns->href), space) &&
        !std::strcmp(reinterpret_cast<const char*>(at->name), name))
      return at;
  return nullptr;
}
std::string text(const xmlNode* node) {
  xmlChar* content = node ? xmlNodeGetContent(const_cast<xmlNode*>(node)) : nullptr;
  std::string out = content ? reinterpret_cast<const char*>(content) : "";
  xmlFree(content);
  return out;
}
std::string attribute(const xmlNode* node, const char* name) {
  xmlChar* content =
      node ? xmlGetNoNsProp(const_cast<xmlNode*>(node), reinterpret_cast<const xmlChar*>(name)) : nullptr;
  std::string out = content ? reinterpret_cast<const char*>(content) : "";
  xmlFree(content);
  return out;
}
const xmlNode* token_of(const xmlNode* envelope) {
  return child(child(child(envelope, kSoap, "Header"), kWsse, "Security"), kWsse, "UsernameToken");
}
double number(const std::string& digits) {
  return g_ascii_strtod(digits.c_str(), nullptr);
}
std::string print(double value) {
  char digits[G_ASCII_DTOSTR_BUF_SIZE];
  return g_ascii_formatd(digits, sizeof digits, "%.6f", value);
}

std::string md5(const std::string& of) {
  g_autofree char* sum = g_compute_checksum_for_string(G_CHECKSUM_MD5, of.c_str(), -1);
  return sum;
}

HttpReply envelope(const std::string& body, int status = 200) {
  return {
      .status = status,
      .body = std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?><SOAP-ENV:Envelope xmlns:SOAP-ENV=\"") +
              kSoap + "\" xmlns:tt=\"" + kTt + "\" xmlns:tds=\"" + kDevice + "\" xmlns:trt=\"" + kMedia +
              "\" xmlns:tr2=\"" + kMedia2 + "\" xmlns:tptz=\"" + kPtz +
              "\" xmlns:ter=\"http://www.onvif.org/ver10/error\"><SOAP-ENV:Body>" + body +
              "</SOAP-ENV:Body></SOAP-ENV:Envelope>",
      .headers = {}};
}
HttpReply fault(const std::string& subcode, const std::string& second, const std::string& reason) {
  const std::string more = second.empty() ? ""
                                          : "<SOAP-ENV:Subcode><SOAP-ENV:Value>ter:" + second +
                                                "</SOAP-ENV:Value></SOAP-ENV:Subcode>";
  return envelope(
      "<SOAP-ENV:Fault><SOAP-ENV:Code><SOAP-ENV:Value>SOAP-ENV:Sender</SOAP-ENV:Value><SOAP-ENV:Subcode>"
      "<SOAP-ENV:Value>ter:" +
          subcode + "</SOAP-ENV:Value>" + more +
          "</SOAP-ENV:Subcode></SOAP-ENV:Code><SOAP-ENV:Reason><SOAP-ENV:Text xml:lang=\"en\">" + reason +
          "</SOAP-ENV:Text></SOAP-ENV:Reason></SOAP-ENV:Fault>",
      400);
}

std::string space2d(const char* element, const char* uri, double x, double y) {
  const auto range = [](const char* name, double to) {
    return std::string("<tt:") + name + "><tt:Min>" + print(-to) + "</tt:Min><tt:Max>" + print(to) +
           "</tt:Max></tt:" + name + ">";
  };
  return std::string("<tt:") + element + "><tt:URI>" + uri + "</tt:URI>" + range("XRange", x) +
         range("YRange", y) + "</tt:" + element + ">";
}

}  // namespace

OnvifCamera::OnvifCamera(OnvifFaults faults, const SteppedTime* time)
    : faults_(std::move(faults)),
      time_(time),
      server_([this](const HttpMessage& message) { return answer(message); }) {}

void OnvifCamera::set_clock(std::chrono::seconds off) {
  const std::lock_guard guard(lock_);
  faults_.clock = off;
}

void OnvifCamera::set_garbage(int answers) {
  const std::lock_guard guard(lock_);
  faults_.garbage = answers;
}

void OnvifCamera::lose_stops(int requests) {
  const std::lock_guard guard(lock_);
  faults_.loses_stops = requests;
}

std::chrono::system_clock::time_point OnvifCamera::clock() const {
  return std::chrono::system_clock::now() + faults_.clock;
}

// Carries out what is due until `now`, in order.
void OnvifCamera::advance(Clock::time_point now) {
  const auto run = [this](Clock::time_point to) {
    const auto end = std::min(to, until_);
    const double seconds = std::max(0.0, std::chrono::duration<double>(end - last_).count());
    if (to_angle_) {
      const auto step = [&](double& at, double target, double speed) {
        at += std::clamp(target - at, -speed * seconds, speed * seconds);
      };
      step(pan_, to_pan_, kPanSpeed);
      step(tilt_, to_tilt_, kTiltSpeed);
    } else {
      pan_ += pan_speed_ * seconds;
      tilt_ += tilt_speed_ * seconds;
    }
    last_ = to;
    if (to >= until_) halt(until_);
  };
  while (!late_.empty() && late_.front().due <= now) {
    run(late_.front().due);
    pan_speed_ = late_.front().pan;
    tilt_speed_ = late_.front().tilt;
    until_ = late_.front().until;
    to_angle_ = false;
    late_.erase(late_.begin());
  }
  run(now);
}

void OnvifCamera::halt(Clock::time_point now) {
  if (pan_speed_ != 0 || tilt_speed_ != 0 || to_angle_) stopped_ = now;
  pan_speed_ = tilt_speed_ = 0;
  to_angle_ = false;
  until_ = Clock::time_point::max();
}

double OnvifCamera::pan() {
  const std::lock_guard guard(lock_);
  advance(now_of(time_));
  return pan_;
}
void OnvifCamera::look(double pan, double tilt) {
  const std::lock_guard guard(lock_);
  pan_ = pan;
  tilt_ = tilt;
}
void OnvifCamera::allow_moves() {
  const std::lock_guard guard(lock_);
  faults_.refuses_moves = false;
}
void OnvifCamera::release_status() {
  const std::lock_guard guard(lock_);
  faults_.status_at_zero = false;
}
double OnvifCamera::zoom() {
  const std::lock_guard guard(lock_);
  return zoom_;
}
void OnvifCamera::refuse_zoom() {
  const std::lock_guard guard(lock_);
  faults_.refuses_zoom = true;
}
void OnvifCamera::refuse_options() {
  const std::lock_guard guard(lock_);
  faults_.refuses_options = true;
}
void OnvifCamera::set_zoom(double position) {
  const std::lock_guard guard(lock_);
  zoom_ = position;
}
double OnvifCamera::tilt() {
  const std::lock_guard guard(lock_);
  advance(now_of(time_));
  return tilt_;
}
double OnvifCamera::speed() {
  const std::lock_guard guard(lock_);
  advance(now_of(time_));
  return pan_speed_;
}
OnvifCamera::Clock::time_point OnvifCamera::stopped() {
  const std::lock_guard guard(lock_);
  advance(now_of(time_));
  return stopped_;
}
int OnvifCamera::count(const std::string& operation) {
  const std::lock_guard guard(lock_);
  return counts_[operation];
}
std::vector<std::string> OnvifCamera::requests() {
  const std::lock_guard guard(lock_);
  return requests_;
}
std::string OnvifCamera::timeout() {
  const std::lock_guard guard(lock_);
  return timeout_;
}

// ONVIF Core Specification, 5.9.4: Base64(SHA-1(nonce + created + password)).
bool OnvifCamera::token_is_good(const xmlNode* header) const {
  const xmlNode* token = child(child(header, kWsse, "Security"), kWsse, "UsernameToken");
  const xmlNode* password = child(token, kWsse, "Password");
  if (!token || text(child(token, kWsse, "Username")) != faults_.user) return false;
  const std::string type = attribute(password, "Type"), created = text(child(token, kWsu, "Created"));
  if (type.ends_with("#PasswordText")) return text(password) == faults_.password;
  if (!type.ends_with("#PasswordDigest") || faults_.clear_only) return false;
  g_autoptr(GDateTime) made = g_date_time_new_from_iso8601(created.c_str(), nullptr);
  if (!made) return false;
  const double age = std::chrono::duration<double>(clock().time_since_epoch()).count() -
                     static_cast<double>(g_date_time_to_unix(made));
  if (std::abs(age) > 5) return false;
  gsize size = 0;
  g_autofree guchar* nonce = g_base64_decode(text(child(token, kWsse, "Nonce")).c_str(), &size);
  std::string all(reinterpret_cast<const char*>(nonce), size);
  all += created + faults_.password;
  guint8 digest[20];
  gsize length = sizeof digest;
  GChecksum* sum = g_checksum_new(G_CHECKSUM_SHA1);
  g_checksum_update(sum, reinterpret_cast<const guchar*>(all.data()), static_cast<gssize>(all.size()));
  g_checksum_get_digest(sum, digest, &length);
  g_checksum_free(sum);
  g_autofree char* expected = g_base64_encode(digest, length);
  return text(password) == expected;
}

// RFC 7616 with MD5 and qop=auth.
bool OnvifCamera::digest_is_good(const HttpMessage& message) const {
  const std::string header = message.header("Authorization");
  if (!header.starts_with("Digest ")) return false;
  const auto part = [&](const std::string& name) -> std::string {
    auto at = header.find(" " + name + "=");
    if (at == std::string::npos) at = header.find("," + name + "=");
    if (at == std::string::npos) return {};
    at += name.size() + 2;
    const bool quoted = header[at] == '"';
    const auto begin = at + quoted;
    return header.substr(begin, header.find_first_of(quoted ? "\"" : ", ", begin) - begin);
  };
  const std::string user = md5(faults_.user + ":onvif:" + faults_.password),
                    what = md5("POST:" + message.path);
  return part("username") == faults_.user && part("uri") == message.path && part("nonce") == "0123" &&
         part("response") ==
             md5(user + ":0123:" + part("nc") + ":" + part("cnonce") + ":" + part("qop") + ":" + what);
}

bool OnvifCamera::logged_in(const HttpMessage& message, const xmlNode* header) const {
  if (faults_.user.empty()) return true;
  return faults_.http_digest ? digest_is_good(message) : token_is_good(header);
}

HttpReply OnvifCamera::answer(const HttpMessage& message) {
  const std::lock_guard guard(lock_);
  advance(now_of(time_));
  requests_.push_back(message.body);
  const std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)> document(
      xmlReadMemory(message.body.data(), static_cast<int>(message.body.size()), nullptr, nullptr,
                    XML_PARSE_NONET),
      xmlFreeDoc);
  const xmlNode* root = document ? xmlDocGetRootElement(document.get()) : nullptr;
  const xmlNode* body = nullptr;
  for (const xmlNode* at = root ? root->children : nullptr; at; at = at->next)
    if (!std::strcmp(reinterpret_cast<const char*>(at->name), "Body")) body = at;
  const xmlNode* request = body ? body->children : nullptr;
  while (request && request->type != XML_ELEMENT_NODE) request = request->next;
  if (!request || !request->ns || !root->ns ||
      std::strcmp(reinterpret_cast<const char*>(root->ns->href), kSoap) != 0)
    return fault("WellFormed", "", "no SOAP 1.2");
  const std::string name = reinterpret_cast<const char*>(request->name);
  const bool open = name == "GetSystemDateAndTime" || name == "GetServices" || name == "GetCapabilities";
  if (!open && !logged_in(message, child(root, kSoap, "Header"))) {
    ++counts_["refused"];
    HttpReply refusal =
        fault("NotAuthorized", "",
              faults_.repeats_password ? "I was sent " + text(child(token_of(root), kWsse, "Password"))
                                       : "Sender not Authorized");
    if (faults_.http_digest) {
      refusal.status = 401;
      refusal.headers =
          "WWW-Authenticate: Digest realm=\"onvif\", nonce=\"0123\", qop=\"auth\", algorithm=MD5\r\n";
    }
    return refusal;
  }
  HttpReply reply = obey(reinterpret_cast<const char*>(request->ns->href), request);
  if (reply.status == 200 && !reply.lost) ++counts_[name];
  reply.delay += faults_.delay;
  return reply;
}

HttpReply OnvifCamera::obey(const std::string& space, const xmlNode* request) {
  const std::string name = reinterpret_cast<const char*>(request->name);
  if (space == kDevice && name == "GetSystemDateAndTime") {
    const std::time_t now = std::chrono::system_clock::to_time_t(clock());
    std::tm utc{};
    gmtime_r(&now, &utc);
    const auto part = [](const char* element, int value) {
      return std::string("<tt:") + element + ">" + std::to_string(value) + "</tt:" + element + ">";
    };
    return envelope(
        "<tds:GetSystemDateAndTimeResponse><tds:SystemDateAndTime><tt:DateTimeType>NTP</tt:DateTimeType>"
        "<tt:DaylightSavings>false</tt:DaylightSavings><tt:UTCDateTime><tt:Time>" +
        part("Hour", utc.tm_hour) + part("Minute", utc.tm_min) + part("Second", utc.tm_sec) +
        "</tt:Time><tt:Date>" + part("Year", utc.tm_year + 1900) + part("Month", utc.tm_mon + 1) +
        part("Day", utc.tm_mday) +
        "</tt:Date></tt:UTCDateTime></tds:SystemDateAndTime></tds:GetSystemDateAndTimeResponse>");
  }
  if (space == kDevice && name == "GetServices" && !faults_.no_get_services) return services(false);
  if (space == kDevice && name == "GetCapabilities") return services(true);
  if (space == kMedia && name == "GetProfiles" && !faults_.media2_only) return profiles(false);
  if (space == kMedia2 && name == "GetProfiles" && faults_.media2_only) return profiles(true);
  if (space == kPtz) return ptz(name, request);
  return fault("ActionNotSupported", "", "Optional Action Not Implemented");
}

HttpReply OnvifCamera::services(bool capabilities) {
  const std::string host =
      faults_.claims_host.empty() ? "127.0.0.1:" + std::to_string(server_.port()) : faults_.claims_host;
  const std::string query = faults_.bare_ampersand ? "?a=1&b=2" : "";
  const auto address = [&](const char* service) { return "http://" + host + "/onvif/" + service + query; };
  if (capabilities)
    return envelope("<tds:GetCapabilitiesResponse><tds:Capabilities><tt:Media><tt:XAddr>" + address("media") +
                    "</tt:XAddr></tt:Media><tt:PTZ><tt:XAddr>" + address("ptz") +
                    "</tt:XAddr></tt:PTZ></tds:Capabilities></tds:GetCapabilitiesResponse>");
  const auto service = [&](const char* space, const char* path) {
    return std::string("<tds:Service><tds:Namespace>") + space + "</tds:Namespace><tds:XAddr>" +
           address(path) +
           "</tds:XAddr><tds:Version><tt:Major>2</tt:Major><tt:Minor>60</tt:Minor></tds:Version></"
           "tds:Service>";
  };
  return envelope("<tds:GetServicesResponse>" + service(kDevice, "device_service") +
                  (faults_.media2_only ? service(kMedia2, "media2") : service(kMedia, "media")) +
                  service(kPtz, "ptz") + "</tds:GetServicesResponse>");
}

HttpReply OnvifCamera::profiles(bool media2) {
  if (media2)
    return envelope(
        "<tr2:GetProfilesResponse><tr2:Profiles token=\"still\"><tr2:Name>still</tr2:Name>"
        "</tr2:Profiles><tr2:Profiles token=\"moving\"><tr2:Name>main</tr2:Name><tr2:Configurations>"
        "<tr2:PTZ token=\"ptz0\"><tt:Name>ptz</tt:Name><tt:NodeToken>node0</tt:NodeToken></tr2:PTZ>"
        "</tr2:Configurations></tr2:Profiles></tr2:GetProfilesResponse>");
  return envelope(
      std::string("<trt:GetProfilesResponse><trt:Profiles token=\"still\"><tt:Name>still</tt:Name>"
                  "</trt:Profiles><trt:Profiles token=\"moving\" fixed=\"true\"><tt:Name>main</tt:Name>") +
      (faults_.no_ptz_profile ? ""
                              : "<tt:PTZConfiguration token=\"ptz0\"><tt:Name>ptz</tt:Name>"
                                "<tt:NodeToken>node0</tt:NodeToken></tt:PTZConfiguration>") +
      "</trt:Profiles></trt:GetProfilesResponse>");
}

std::string OnvifCamera::spaces() const {
  std::string spaces = space2d("AbsolutePanTiltPositionSpace", SPACES "PositionGenericSpace", 1, 1);
  if (faults_.degrees)
    spaces +=
        space2d("AbsolutePanTiltPositionSpace", SPACES "SphericalPositionSpaceDegrees", kPanEnd, kTiltEnd);
  spaces += space2d("ContinuousPanTiltVelocitySpace", SPACES "VelocityGenericSpace", 1, 1);
  if (faults_.zooms)
    spaces += "<tt:AbsoluteZoomPositionSpace><tt:URI>" ZOOM_SPACE "</tt:URI><tt:XRange><tt:Min>" +
              print(faults_.widest) + "</tt:Min><tt:Max>" + print(faults_.longest) +
              "</tt:Max></tt:XRange></tt:AbsoluteZoomPositionSpace>";
  if (faults_.claims_degree_velocity)
    spaces += space2d("ContinuousPanTiltVelocitySpace", SPACES "VelocitySpaceDegrees", kPanSpeed, kTiltSpeed);
  return spaces + "<tt:PanTiltSpeedSpace><tt:URI>" SPACES
                  "GenericSpeedSpace</tt:URI><tt:XRange><tt:Min>0</tt:Min><tt:Max>1</tt:Max>"
                  "</tt:XRange></tt:PanTiltSpeedSpace>";
}

HttpReply OnvifCamera::options() {
  return envelope("<tptz:GetConfigurationOptionsResponse><tptz:PTZConfigurationOptions><tt:Spaces>" +
                  spaces() +
                  "</tt:Spaces><tt:PTZTimeout><tt:Min>PT0.1S</"
                  "tt:Min><tt:Max>PT1M</tt:Max>"
                  "</tt:PTZTimeout></tptz:PTZConfigurationOptions></tptz:GetConfigurationOptionsResponse>");
}

HttpReply OnvifCamera::status() {
  using MoveStatus = OnvifFaults::MoveStatus;
  const bool turns = pan_speed_ != 0 || tilt_speed_ != 0 || to_angle_;
  const bool moving =
      faults_.move_status == MoveStatus::always_moving || (faults_.move_status == MoveStatus::alive && turns);
  std::string content;
  const std::string zoom =
      faults_.zooms ? "<tt:Zoom x=\"" + print(faults_.widest + zoom_ * (faults_.longest - faults_.widest)) +
                          "\" space=\"" ZOOM_SPACE "\"/>"
                    : "";
  if (!faults_.positions && faults_.zooms) content = "<tt:Position>" + zoom + "</tt:Position>";
  if (faults_.positions) {
    const double pan = faults_.status_at_zero ? 0 : pan_, tilt = faults_.status_at_zero ? 0 : tilt_;
    const double x = faults_.degrees ? pan : pan / kPanEnd, y = faults_.degrees ? tilt : tilt / kTiltEnd;
    const std::string right =
        std::string(SPACES) + (faults_.degrees ? "SphericalPositionSpaceDegrees" : "PositionGenericSpace");
    const std::string space = faults_.position_space.empty() ? right : faults_.position_space;
    content = "<tt:Position><tt:PanTilt x=\"" + print(x) + "\" y=\"" + print(y) + "\"" +
              (space == "none" ? "" : " space=\"" + space + "\"") + "/>" + zoom + "</tt:Position>";
  }
  if (faults_.move_status != MoveStatus::absent)
    content += std::string("<tt:MoveStatus><tt:PanTilt>") + (moving ? "MOVING" : "IDLE") +
               "</tt:PanTilt></tt:MoveStatus>";
  return envelope("<tptz:GetStatusResponse><tptz:PTZStatus>" + content +
                  "<tt:UtcTime>2026-01-01T00:00:00Z</tt:UtcTime></tptz:PTZStatus></tptz:GetStatusResponse>");
}

HttpReply OnvifCamera::continuous_move(const xmlNode* request) {
  const xmlNode* vector = child(child(request, kPtz, "Velocity"), kTt, "PanTilt");
  const std::string space = attribute(vector, "space"), timeout = text(child(request, kPtz, "Timeout"));
  if (!vector) return fault("InvalidArgVal", "", "no velocity");
  if (faults_.refuses_moves) return fault("Action", "PTZNotSupported", "the motors are locked");
  if (!space.empty() && space != SPACES "VelocityGenericSpace")
    return fault("InvalidArgVal", "SpaceNotSupported", "space");
  const double x = number(attribute(vector, "x")), y = number(attribute(vector, "y"));
  if (std::abs(x) > 1 || std::abs(y) > 1) return fault("InvalidArgVal", "InvalidVelocity", "velocity");
  if (!timeout.empty() && faults_.refuses_timeout == "HTTP")
    return {.status = 400, .body = "Bad Request", .headers = {}};
  if (!timeout.empty() && !faults_.refuses_timeout.empty())
    return fault("InvalidArgVal", faults_.refuses_timeout, "timeout");
  timeout_ = timeout;
  // The durations that this test sends have seconds only.
  const double seconds = timeout.starts_with("PT") ? number(timeout.substr(2)) : 0;
  const auto due = now_of(time_) + faults_.move_delay + faults_.dead_time;
  const auto until =
      timeout.empty() || faults_.ignores_timeout
          ? Clock::time_point::max()
          : due + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  late_.push_back({due, x * kPanSpeed, y * kTiltSpeed, until});
  if (x == 0 && y == 0 && faults_.dead_time.count() == 0) halt(now_of(time_));
  advance(now_of(time_));
  HttpReply reply = envelope("<tptz:ContinuousMoveResponse/>");
  reply.delay = faults_.move_delay;
  return reply;
}

HttpReply OnvifCamera::absolute_move(const xmlNode* request) {
  const xmlNode* vector = child(child(request, kPtz, "Position"), kTt, "PanTilt");
  const bool degrees = attribute(vector, "space") == SPACES "SphericalPositionSpaceDegrees";
  if (const xmlNode* zoom = child(child(request, kPtz, "Position"), kTt, "Zoom")) {
    if (!faults_.zooms || faults_.refuses_zoom || attribute(zoom, "space") != ZOOM_SPACE)
      return fault("InvalidArgVal", "SpaceNotSupported", "no zoom");
    zoom_ = (number(attribute(zoom, "x")) - faults_.widest) / (faults_.longest - faults_.widest);
    if (!vector) return envelope("<tptz:AbsoluteMoveResponse/>");
  }
  if (!vector) return fault("InvalidArgVal", "", "no position");
  if (faults_.refuses_absolute || (degrees && !faults_.degrees))
    return fault("InvalidArgVal", "SpaceNotSupported", "not that one");
  to_pan_ = number(attribute(vector, "x")) * (degrees ? 1 : kPanEnd);
  to_tilt_ = number(attribute(vector, "y")) * (degrees ? 1 : kTiltEnd);
  if (std::abs(to_pan_) > kPanEnd || std::abs(to_tilt_) > kTiltEnd)
    return fault("InvalidArgVal", "InvalidPosition", "out of range");
  to_angle_ = true;
  until_ = Clock::time_point::max();
  return envelope("<tptz:AbsoluteMoveResponse/>");
}

HttpReply OnvifCamera::stop(const xmlNode* request) {
  if (text(child(request, kPtz, "PanTilt")) == "false") return envelope("<tptz:StopResponse/>");
  if (faults_.refuses_stop) return fault("ActionNotSupported", "", "no Stop here");
  if (faults_.loses_stops > 0) {
    --faults_.loses_stops;
    return {.body = {}, .headers = {}, .lost = true};
  }
  if (faults_.swallows_stops > 0 && (pan_speed_ != 0 || tilt_speed_ != 0))
    --faults_.swallows_stops;
  else if (faults_.dead_time.count() > 0)
    late_.push_back({now_of(time_) + faults_.dead_time, 0, 0, Clock::time_point::max()});
  else
    halt(now_of(time_));
  return envelope("<tptz:StopResponse/>");
}

HttpReply OnvifCamera::ptz(const std::string& name, const xmlNode* request) {
  if (name == "GetConfigurationOptions")
    return faults_.refuses_options ? fault("Action", "NotNow", "no options") : options();
  if (name == "GetNodes" && !faults_.no_nodes)
    return envelope(
        "<tptz:GetNodesResponse><tptz:PTZNode "
        "token=\"node0\"><tt:Name>dome</tt:Name><tt:SupportedPTZSpaces>" +
        spaces() + "</tt:SupportedPTZSpaces></tptz:PTZNode></tptz:GetNodesResponse>");
  const std::string profile = text(child(request, kPtz, "ProfileToken"));
  if (profile != "moving" && !(faults_.moves_any_profile && profile == "still"))
    return fault("InvalidArgVal", "NoProfile", "no such profile");
  if (!faults_.redirects.empty())
    return {.status = 303, .body = {}, .headers = "Location: " + faults_.redirects + "\r\n"};
  if (faults_.errors > 0) {
    --faults_.errors;
    return {.status = 500, .body = "Internal Server Error", .headers = {}};
  }
  if (faults_.garbage > 0) {
    --faults_.garbage;
    return {.body = "<?xml version=\"1.0\"?><SOAP-ENV:Envelope><oops", .headers = {}};
  }
  if (name == "GetStatus") return status();
  if (name == "ContinuousMove") return continuous_move(request);
  if (name == "AbsoluteMove") return absolute_move(request);
  if (name == "Stop") return stop(request);
  if (name == "GotoHomePosition" ||
      (name == "GotoPreset" && text(child(request, kPtz, "PresetToken")) == "1")) {
    to_pan_ = to_tilt_ = 0;
    to_angle_ = true;
    return envelope("<tptz:" + name + "Response/>");
  }
  if (name == "GotoPreset") return fault("InvalidArgVal", "NoToken", "no such preset");
  if (name == "GetPresets")
    return envelope(
        "<tptz:GetPresetsResponse><tptz:Preset token=\"1\"><tt:Name>ahead</tt:Name></tptz:Preset>"
        "<tptz:Preset token=\"2\"><tt:Name>gone</tt:Name></tptz:Preset></tptz:GetPresetsResponse>");
  return fault("ActionNotSupported", "", "Optional Action Not Implemented");
}

}  // namespace cerberus::tests
