// SPDX-License-Identifier: LGPL-2.1-or-later
// ONVIF's messages: what is sent is compared with published examples, what is read was written by hand from the WSDL files
// with the prefixes, orders and mistakes that cameras show.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "drivers/onvif/address.h"
#include "drivers/onvif/answers.h"
#include "drivers/onvif/discovery.h"
#include "drivers/onvif/messages.h"
#include "drivers/onvif/spaces.h"
#include "heads/soup_client.h"

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers::onvif;
using namespace std::chrono_literals;
using cerberus::tests::assert_text;

namespace {

// An envelope around a Body's content, with prefixes as gSOAP has them.
XmlDocument soap(const std::string& content) {
  auto document = XmlDocument::parse(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<SOAP-ENV:Envelope "
      "xmlns:SOAP-ENV=\"http://www.w3.org/2003/05/soap-envelope\" "
      "xmlns:tt=\"http://www.onvif.org/ver10/schema\" "
      "xmlns:tds=\"http://www.onvif.org/ver10/device/wsdl\" "
      "xmlns:trt=\"http://www.onvif.org/ver10/media/wsdl\" "
      "xmlns:tptz=\"http://www.onvif.org/ver20/ptz/wsdl\" xmlns:ter=\"http://www.onvif.org/ver10/error\">"
      "<SOAP-ENV:Header/><SOAP-ENV:Body>" +
      content + "</SOAP-ENV:Body></SOAP-ENV:Envelope>");
  ck_assert(document.has_value());
  return std::move(*document);
}

constexpr char kGenericPosition[] = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/PositionGenericSpace";
constexpr char kDegreePosition[] =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalPositionSpaceDegrees";
constexpr char kGenericVelocity[] = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/VelocityGenericSpace";

}  // namespace

// ONVIF Application Programmer's Guide 1.0, 6.1.1.3.
START_TEST(the_password_digest_is_that_of_the_programmers_guide) {
  const std::string nonce = "\x2c\xaa\x88\xe8\x6f\xc0\x8a\x42\x82\x42\xb3\x74\xce\xa6\x45\x96";
  assert_text(base64(nonce), "LKqI6G/AikKCQrN0zqZFlg==");
  assert_text(cerberus::heads::password_digest(nonce, "2010-09-16T07:50:45Z", "userpassword"),
              "tuOSpGlFlIXsozq4HFNeeGeFLEI=");
}
END_TEST

// RFC 4648, 10.
START_TEST(base64_is_that_of_its_rfc) {
  for (const auto& [bytes, text] : {std::pair("", ""),
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}})
    assert_text(base64(bytes), text);
}
END_TEST

START_TEST(times_and_durations_are_those_of_xml_schema) {
  assert_text(utc_text(0ms), "1970-01-01T00:00:00.000Z");
  assert_text(utc_text(951827696789ms), "2000-02-29T12:34:56.789Z");  // date -u -d 2000-02-29T12:34:56 +%s
  assert_text(duration_text(1000ms), "PT1S");
  assert_text(duration_text(1500ms), "PT1.5S");
  ck_assert(read_duration("PT1S") == 1000ms);
  ck_assert(read_duration("PT0.5S") == 500ms);
  ck_assert(read_duration("P0Y0M0DT0H1M30.000S") == 90000ms);
  ck_assert(read_duration("P10675199DT2H48M5.4775807S") == 24h);  // more is not waited for
  for (const char* wrong : {"", "1", "P", "PT", "PT-1S", "PT1", "-PT1S", "P1Y", "PTnanS", "PT1e9999S"})
    ck_assert_msg(!read_duration(wrong), "%s", wrong);
}
END_TEST

START_TEST(numbers_keep_their_point_and_texts_cannot_break_out) {
  const Request move = continuous_move("a\"<b>&", {0.125, -1e-9, kGenericVelocity}, 1s);
  assert_text(move.action, "http://www.onvif.org/ver20/ptz/wsdl/ContinuousMove");
  assert_text(move.body,
              "<ContinuousMove xmlns=\"http://www.onvif.org/ver20/ptz/wsdl\" "
              "xmlns:tt=\"http://www.onvif.org/ver10/schema\">"
              "<ProfileToken>a&quot;&lt;b&gt;&amp;</ProfileToken><Velocity><tt:PanTilt x=\"0.125\" y=\"0\" "
              "space=\"http://www.onvif.org/ver10/tptz/PanTiltSpaces/VelocityGenericSpace\"/></Velocity>"
              "<Timeout>PT1S</Timeout></ContinuousMove>");
  const std::string text = envelope(stop("p"), UsernameToken{"<user>", "a&b", false, "AA==", "now"});
  const auto document = XmlDocument::parse(text);
  ck_assert(document.has_value());
  const XmlElement token = document->root().child("Header").child("Security").child("UsernameToken");
  assert_text(token.child("Username").text(), "<user>");
  assert_text(token.child("Password").text(), "a&b");
  ck_assert(token.child("Password").attribute("Type").ends_with("#PasswordText"));
}
END_TEST

START_TEST(xml_with_a_document_type_or_too_much_of_it_is_refused) {
  ck_assert(!XmlDocument::parse(""));
  ck_assert(!XmlDocument::parse("no XML"));
  ck_assert(!XmlDocument::parse("<a><b></a>"));
  ck_assert(!XmlDocument::parse("<!DOCTYPE a [<!ENTITY x \"y\">]><a>&x;</a>"));
  ck_assert(!XmlDocument::parse("<!DOCTYPE a SYSTEM \"http://192.0.2.1/a.dtd\"><a/>"));
  std::string wide = "<!DOCTYPE a><a/>", utf16 = "\xff\xfe";
  for (const char c : wide) utf16 += std::string{c, '\0'};
  ck_assert(!XmlDocument::parse(utf16));
  ck_assert(!XmlDocument::parse("<a>" + std::string(kMostXml, 'x') + "</a>"));
  std::string deep;
  for (int k = 0; k < 100000; ++k) deep += "<a>";
  ck_assert(!XmlDocument::parse(deep));
}
END_TEST

START_TEST(a_bare_ampersand_is_taken_for_itself) {
  const auto document = XmlDocument::parse("\r\n<a><u>http://h/p?x=1&y=2&amp;z=&#51;&&copy;</u></a>");
  ck_assert(document.has_value());
  assert_text(document->root().child("u").text(), "http://h/p?x=1&y=2&z=3&&copy;");
}
END_TEST

START_TEST(the_cameras_time_is_read) {
  const auto time = [](const std::string& y, const std::string& month, const std::string& hour) {
    return read_system_date_and_time(body_of(soap(
        "<tds:GetSystemDateAndTimeResponse><tds:SystemDateAndTime><tt:UTCDateTime><tt:Time><tt:Hour>" + hour +
        "</tt:Hour><tt:Minute>34</tt:Minute><tt:Second>56</tt:Second></tt:Time><tt:Date><tt:Year>" + y +
        "</tt:Year><tt:Month>" + month +
        "</tt:Month><tt:Day>29</tt:Day></tt:Date></tt:UTCDateTime>"
        "</tds:SystemDateAndTime></tds:GetSystemDateAndTimeResponse>")));
  };
  ck_assert(time("2000", "2", "12") == 951827696000ms);
  for (const auto& wrong : {time("2001", "2", "12"), time("2000", "13", "12"), time("2000", "2", "24"),
                            time("1e300", "2", "12"), time("2000", "2.5", "12"), time("", "2", "12")})
    ck_assert(!wrong);
}
END_TEST

START_TEST(faults_have_their_innermost_code_and_a_printable_reason) {
  const XmlDocument twelve = soap(
      "<SOAP-ENV:Fault><SOAP-ENV:Code><SOAP-ENV:Value>SOAP-ENV:Sender</"
      "SOAP-ENV:Value><SOAP-ENV:Subcode><SOAP-ENV:Value>"
      "ter:InvalidArgVal</SOAP-ENV:Value><SOAP-ENV:Subcode><SOAP-ENV:Value>ter:NoProfile</SOAP-ENV:Value>"
      "</SOAP-ENV:Subcode></SOAP-ENV:Subcode></SOAP-ENV:Code><SOAP-ENV:Reason><SOAP-ENV:Text "
      "xml:lang=\"en\">no\n"
      "profile</SOAP-ENV:Text></SOAP-ENV:Reason></SOAP-ENV:Fault>");
  const auto fault = read_fault(body_of(twelve));
  ck_assert(fault && fault->has("InvalidArgVal") && !fault->not_authorized());
  assert_text(fault->text(), "NoProfile: no profile");
  const XmlDocument eleven = soap("<SOAP-ENV:Fault><faultcode>ter:NotAuthorized</faultcode><faultstring>" +
                                  std::string(1000, 'x') + "</faultstring></SOAP-ENV:Fault>");
  const auto old = read_fault(body_of(eleven));
  ck_assert(old && old->not_authorized());
  ck_assert_uint_eq(old->reason.size(), 200);
  ck_assert(!read_fault(body_of(soap("<tptz:StopResponse/>"))));
}
END_TEST

START_TEST(services_are_read_from_both_answers) {
  const Services a = read_services(
      body_of(soap("<tds:GetServicesResponse><tds:Service><tds:Namespace>http://www.onvif.org/ver20/ptz/"
                   "wsdl</tds:Namespace>"
                   "<tds:XAddr>http://10.0.0.1/ptz</tds:XAddr></tds:Service><tds:Service><tds:Namespace>"
                   "http://www.onvif.org/ver10/media/wsdl</tds:Namespace><tds:XAddr>http://10.0.0.1/media</"
                   "tds:XAddr></tds:Service>"
                   "<tds:Service><tds:Namespace>http://www.onvif.org/ver10/events/wsdl</"
                   "tds:Namespace><tds:XAddr>e</tds:XAddr>"
                   "</tds:Service></tds:GetServicesResponse>")));
  assert_text(a.ptz, "http://10.0.0.1/ptz");
  assert_text(a.media, "http://10.0.0.1/media");
  const Services b = read_services(body_of(
      soap("<tds:GetCapabilitiesResponse><tds:Capabilities><tt:Media><tt:XAddr>http://m/m</tt:XAddr></"
           "tt:Media><tt:PTZ>"
           "<tt:XAddr>http://p/p</tt:XAddr></tt:PTZ></tds:Capabilities></tds:GetCapabilitiesResponse>")));
  assert_text(b.ptz, "http://p/p");
  assert_text(b.media, "http://m/m");
}
END_TEST

START_TEST(a_status_may_lack_everything_or_hold_what_is_no_number) {
  const auto status = [](const std::string& content) {
    return read_status(body_of(soap("<tptz:GetStatusResponse><tptz:PTZStatus>" + content +
                                    "</tptz:PTZStatus></tptz:GetStatusResponse>")));
  };
  const auto whole = status(
      "<tt:Position><tt:PanTilt x=\"-0.5\" y=\"+2.5E-1\" space=\"s\"/><tt:Zoom "
      "x=\"0.75\"/></tt:Position><tt:MoveStatus>"
      "<tt:PanTilt>MOVING</tt:PanTilt></tt:MoveStatus>");
  ck_assert(whole && whole->position && whole->moving == true);
  ck_assert_double_eq(whole->zoom.value_or(-1), 0.75);
  const auto zoom = [&](const char* attributes, const PtzOptions& options = {}) {
    return zoom_share(*status("<tt:Position><tt:Zoom " + std::string(attributes) + "/></tt:Position>"),
                      options);
  };
  ck_assert_double_eq(zoom("x=\"0.75\"").value_or(-1), 0.75);
  ck_assert(!zoom("x=\"1.5\""));
  // In the range of the space that the camera offers.
  PtzOptions times;
  times.zoom = Space{"times", {1, 21}, {}};
  ck_assert_double_eq(zoom("x=\"6\"", times).value_or(-1), 0.25);
  ck_assert_double_eq(zoom("x=\"21\" space=\"times\"", times).value_or(-1), 1);
  ck_assert(!zoom("x=\"0.5\"", times) && !zoom("x=\"6\" space=\"else\"", times));
  ck_assert_double_eq(
      zoom("x=\"0.5\" space=\"http://www.onvif.org/ver10/tptz/ZoomSpaces/PositionGenericSpace\"", times)
          .value_or(-1),
      0.5);
  ck_assert_double_eq(whole->position->x.from, -0.5);
  ck_assert_double_eq(whole->position->y.from, 0.25);
  for (const char* wrong :
       {"", "<tt:Position/>", "<tt:Position><tt:PanTilt x=\"NaN\" y=\"0\"/></tt:Position>",
        "<tt:Position><tt:PanTilt x=\"0,5\" y=\"0\"/></tt:Position>",
        "<tt:Position><tt:PanTilt x=\"1e999\" y=\"0\"/></tt:Position>",
        "<tt:MoveStatus><tt:PanTilt>UNKNOWN</tt:PanTilt></tt:MoveStatus>"}) {
    const auto poor = status(wrong);
    ck_assert(poor && !poor->position && !poor->moving);
  }
  ck_assert(!read_status(body_of(soap("<tptz:StopResponse/>"))));
}
END_TEST

START_TEST(nodes_are_read_with_what_they_offer) {
  const auto nodes = read_nodes(body_of(soap(
      "<tptz:GetNodesResponse><tptz:PTZNode token=\"n1\" FixedHomePosition=\"true\"><tt:Name>dome</tt:Name>"
      "<tt:SupportedPTZSpaces><tt:ContinuousPanTiltVelocitySpace><tt:URI>urn:v</tt:URI>"
      "<tt:XRange><tt:Min>-2</tt:Min><tt:Max>2</tt:Max></tt:XRange></tt:ContinuousPanTiltVelocitySpace>"
      "</tt:SupportedPTZSpaces></tptz:PTZNode><tptz:PTZNode token=\"n2\"/></tptz:GetNodesResponse>")));
  ck_assert_uint_eq(nodes.size(), 2);
  assert_text(nodes[0].token, "n1");
  assert_text(nodes[0].name, "dome");
  ck_assert_uint_eq(nodes[0].options.velocities.size(), 1);
  ck_assert(nodes[0].options.velocities[0].x.to == 2 && nodes[0].options.positions.empty());
  assert_text(nodes[1].token, "n2");
  ck_assert(nodes[1].options.velocities.empty());
}
END_TEST

START_TEST(presets_and_probe_matches_are_read) {
  const auto presets = read_presets(body_of(soap(
      "<tptz:GetPresetsResponse><tptz:Preset token=\"1\"><tt:Name>door</tt:Name></tptz:Preset><tptz:Preset/>"
      "</tptz:GetPresetsResponse>")));
  ck_assert_uint_eq(presets.size(), 1);
  assert_text(presets[0].name, "door");
  const auto document = XmlDocument::parse(
      "<e:Envelope xmlns:e=\"http://www.w3.org/2003/05/soap-envelope\" "
      "xmlns:w=\"http://schemas.xmlsoap.org/ws/2004/08/addressing\" "
      "xmlns:d=\"http://schemas.xmlsoap.org/ws/2005/04/discovery\"><e:Header><w:RelatesTo>uuid:1</"
      "w:RelatesTo></e:Header>"
      "<e:Body><d:ProbeMatches><d:ProbeMatch><w:EndpointReference><w:Address>urn:uuid:2</w:Address>"
      "</w:EndpointReference><d:Scopes>onvif://www.onvif.org/name/x onvif://www.onvif.org/type/ptz</d:Scopes>"
      "<d:XAddrs>http://192.0.2.1/onvif/device_service\n http://[fe80::1]/onvif/device_service</d:XAddrs>"
      "</d:ProbeMatch></d:ProbeMatches></e:Body></e:Envelope>");
  std::string relates_to;
  const auto matches = read_probe_matches(*document, relates_to);
  assert_text(relates_to, "uuid:1");
  ck_assert_uint_eq(matches.size(), 1);
  assert_text(matches[0].endpoint, "urn:uuid:2");
  ck_assert_uint_eq(matches[0].addresses.size(), 2);
  assert_text(matches[0].addresses[1], "http://[fe80::1]/onvif/device_service");
  ck_assert_uint_eq(matches[0].scopes.size(), 2);
}
END_TEST

// A responder on loopback: the answer of another probe, one that is no XML, then the right one, twice.
START_TEST(cameras_are_found_by_the_answers_to_the_own_probe) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  ck_assert(::bind(fd, reinterpret_cast<sockaddr*>(&at), size) == 0);
  ck_assert(::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size) == 0);
  std::thread responder([fd] {
    char bytes[4096];
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t got = ::recvfrom(fd, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &length);
    const std::string probe(bytes, static_cast<std::size_t>(got));
    const auto begin = probe.find("uuid:"), end = probe.find('<', begin);
    const std::string id = probe.substr(begin, end - begin);
    ck_assert(probe.find("<d:Types>dn:NetworkVideoTransmitter</d:Types>") != probe.npos);
    const auto answer = [&](const std::string& to, const char* uuid) {
      return "<e:Envelope xmlns:e=\"http://www.w3.org/2003/05/soap-envelope\" "
             "xmlns:w=\"http://schemas.xmlsoap.org/ws/2004/08/addressing\" "
             "xmlns:d=\"http://schemas.xmlsoap.org/ws/2005/04/discovery\"><e:Header><w:RelatesTo>" +
             to +
             "</w:RelatesTo></"
             "e:Header><e:Body><d:ProbeMatches><d:ProbeMatch><w:EndpointReference><w:Address>" +
             uuid +
             "</w:Address></w:EndpointReference><d:Scopes>onvif://www.onvif.org/name/Front%20door</d:Scopes>"
             "<d:XAddrs>http://192.0.2.9/onvif/device_service "
             "http://127.0.0.1:81/onvif/device_service</d:XAddrs>"
             "</d:ProbeMatch></d:ProbeMatches></e:Body></e:Envelope>";
    };
    for (const std::string& text : {answer("uuid:1-2-3", "urn:uuid:foreign"), std::string("<oops"),
                                    answer("urn:" + id, "urn:uuid:right"), answer(id, "urn:uuid:right")})
      ::sendto(fd, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&from), length);
  });
  std::string wrong;
  const auto found = discover(200ms, wrong, {"127.0.0.1", ntohs(at.sin_port)});
  responder.join();
  ::close(fd);
  assert_text(wrong, "");
  ck_assert_uint_eq(found.size(), 1);
  assert_text(found[0].endpoint, "urn:uuid:right");
  assert_text(found[0].name, "Front door");
  assert_text(found[0].device, "http://127.0.0.1:81/onvif/device_service");
}
END_TEST

START_TEST(a_camera_that_was_only_found_is_sent_no_login) {
  const Found door{"urn:uuid:1", "http://192.0.2.1/onvif/device_service", "door"};
  const Found gate{"urn:uuid:2", "http://192.0.2.2/onvif/device_service", ""};
  std::string device;
  assert_text(choose_found({door}, false, device), "");
  assert_text(device, door.device.c_str());
  device.clear();
  assert_text(choose_found({door}, true, device),
              "a camera that was only found is sent no password: name it (device=): "
              "http://192.0.2.1/onvif/device_service (door)");
  ck_assert(choose_found({door, gate}, false, device).find("name one (device=)") != std::string::npos);
  ck_assert(choose_found({}, false, device).find("no ONVIF camera was found") == 0);
  assert_text(device, "");
}
END_TEST

START_TEST(requests_go_to_the_named_host_whatever_the_camera_claims) {
  Address named;
  assert_text(parse_device("192.0.2.7:8080", named), "");
  assert_text(named.url(), "http://192.0.2.7:8080/onvif/device_service");
  const auto at = [&](const char* claimed) {
    const auto address = reachable(claimed, named);
    return address ? address->url() : std::string("none");
  };
  assert_text(at("http://192.0.2.7:9000/ptz"), "http://192.0.2.7:9000/ptz");
  assert_text(at("http://10.0.0.1:80/ptz?a=1&b=2"), "http://192.0.2.7:8080/ptz?a=1&b=2");
  assert_text(at("https://192.0.2.7/ptz"), "http://192.0.2.7:8080/ptz");
  assert_text(at("http://user:word@192.0.2.7/ptz"), "none");
  assert_text(at("http://192.0.2.7/a b"), "none");
  assert_text(at("rtsp://192.0.2.7/"), "none");
  assert_text(at(""), "none");
  assert_text(parse_device("https://[2001:db8::1]", named), "");
  assert_text(named.url(), "https://[2001:db8::1]:443/onvif/device_service");
  assert_text(named.name(), "[2001:db8::1]");
  for (const char* wrong : {"", "http://", "http://h:0", "http://h:65536", "http://h:x", "ftp://h",
                            "http://a b", "http://[::1", "http://u:p@h", "http://h\r\nX: y"})
    ck_assert_msg(!parse_device(wrong, named).empty(), "%s", wrong);
  ck_assert(parse_device("http://admin:hunter2@h", named).find("hunter2") == std::string::npos);
}
END_TEST

// A generic space with the ends -1 and 1 at -100 and 300 degrees: its middle is 100.
START_TEST(degrees_become_the_units_of_the_cameras_spaces) {
  PtzOptions options;
  options.positions = {{kGenericPosition, {-1, 1}, {-1, 1}}};
  options.velocities = {{kGenericVelocity, {-1, 1}, {-1, 1}}};
  Mechanics mechanics;
  mechanics.full_speed = {200, 50};
  ck_assert(!position_space(options, mechanics));
  mechanics.least = Angles{-100, -30};
  mechanics.most = Angles{300, 90};
  const auto space = position_space(options, mechanics);
  ck_assert(space.has_value());
  PanTilt to = to_position({100, 90}, *space, mechanics);
  ck_assert_double_eq_tol(to.x, 0, 1e-12);
  ck_assert_double_eq_tol(to.y, 1, 1e-12);
  ck_assert_double_eq_tol(to_position({200, 500}, *space, mechanics).x, .5, 1e-12);
  ck_assert_double_eq_tol(to_position({200, 500}, *space, mechanics).y, 1, 1e-12);
  const auto back = to_degrees({kGenericPosition, {.5, .5}, {-1, -1}}, space, options, mechanics);
  ck_assert_double_eq_tol(back->pan, 200, 1e-9);
  ck_assert_double_eq_tol(back->tilt, -30, 1e-9);
  ck_assert(!to_degrees({"http://vendor/space", {0, 0}, {0, 0}}, space, options, mechanics));
  const auto spaces = velocity_spaces(options);
  ck_assert_uint_eq(spaces.size(), 2);  // and the camera's default
  const PanTilt v = to_velocity({-50, 60}, spaces[0], mechanics);
  ck_assert_double_eq_tol(v.x, -.25, 1e-12);
  ck_assert_double_eq(v.y, 1);
  options.positions.push_back({kDegreePosition, {-180, 180}, {0, 90}});
  to = to_position({-20, -5}, *position_space(options, mechanics), mechanics);
  ck_assert_double_eq(to.x, -20);
  ck_assert_double_eq(to.y, 0);
}
END_TEST

START_TEST(fingerprints_are_read_in_every_notation) {
  using cerberus::heads::normal_fingerprint;
  std::string colons, plain;
  for (int k = 0; k < 32; ++k) colons += k == 0 ? "AB" : ":AB", plain += "ab";
  assert_text(normal_fingerprint(colons), plain.c_str());
  assert_text(normal_fingerprint(plain), plain.c_str());
  assert_text(normal_fingerprint("ab"), "");
  assert_text(normal_fingerprint(plain + "zz"), "");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "onvif_messages",
      {the_password_digest_is_that_of_the_programmers_guide, base64_is_that_of_its_rfc,
       times_and_durations_are_those_of_xml_schema, numbers_keep_their_point_and_texts_cannot_break_out,
       xml_with_a_document_type_or_too_much_of_it_is_refused, a_bare_ampersand_is_taken_for_itself,
       the_cameras_time_is_read, faults_have_their_innermost_code_and_a_printable_reason,
       services_are_read_from_both_answers, a_status_may_lack_everything_or_hold_what_is_no_number,
       nodes_are_read_with_what_they_offer, presets_and_probe_matches_are_read,
       cameras_are_found_by_the_answers_to_the_own_probe, a_camera_that_was_only_found_is_sent_no_login,
       requests_go_to_the_named_host_whatever_the_camera_claims,
       degrees_become_the_units_of_the_cameras_spaces, fingerprints_are_read_in_every_notation});
}
