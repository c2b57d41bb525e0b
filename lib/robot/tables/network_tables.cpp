// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/tables/network_tables.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "publish/mqtt_report.h"
#include "publish/streams/encoders.h"
#include "robot/page/client_address.h"

namespace cerberus::robot {

namespace {

using text::TomlValue;

bool is_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(AF_INET, text.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1;
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1";
}

// The address and the port of a server.
void read_listen(TableReader& reader, std::string& listen, int& port) {
  if (reader.text("listen", listen) && !is_address(listen))
    reader.complain("listen", "\"listen\" is a numeric address: 127.0.0.1, or 0.0.0.0 for every network");
  reader.whole("port", port, 1, 65535);
}

// A key that names a file, and where it is.
void read_path(TableReader& reader, const char* key, std::string& path, bool secret, Folders folders,
               std::vector<NamedFile>& files) {
  if (!reader.text(key, path)) return;
  path = below(folders.configuration, path);
  files.push_back({reader.line(key), key, path, secret});
}

// The keys of TLS.
void read_tls(TableReader& reader, bool& tls, std::string& certificate, std::string& key, Folders folders,
              std::vector<NamedFile>& files) {
  reader.truth("tls", tls);
  read_path(reader, "certificate", certificate, false, folders, files);
  read_path(reader, "certificate-key", key, true, folders, files);
  if (reader.has("certificate") != reader.has("certificate-key"))
    reader.complain("certificate", "\"certificate\" and \"certificate-key\" belong together");
  if (reader.has("certificate") && !tls) reader.complain("certificate", "\"certificate\" needs tls = true");
}

// The file of the users of a server, or a credential of systemd that holds them.
void read_users(TableReader& reader, std::string& path, Folders folders, std::vector<NamedFile>& files) {
  std::string credential;
  if (reader.has("users-file") && reader.has("users-credential"))
    reader.complain("users-credential",
                    "\"users-file\" and \"users-credential\" name one list: give one of them");
  read_path(reader, "users-file", path, true, folders, files);
  if (reader.text("users-credential", credential))
    path = credential_path(reader, "users-credential", credential, folders, files);
  if (!files.empty() && files.back().key.starts_with("users-")) files.back().users = true;
}

constexpr Option kMqtt[] = {
    {"host", Option::Kind::text},
    {"port", Option::Kind::whole, 1, 65535},
    {"username", Option::Kind::text},
    {"topic-prefix", Option::Kind::text},
    {"discovery-prefix", Option::Kind::text},
};

constexpr std::array<std::string_view, 7> kTopics{"track", "state", "pir",  "pantilt",
                                                  "rule",  "mode",  "event"};

}  // namespace

PageSettings read_page(const TomlValue& table, Folders folders, Mistakes& mistakes,
                       std::vector<NamedFile>& files) {
  TableReader reader(table, "[page]", mistakes);
  PageSettings settings;
  reader.truth("enabled", settings.enabled);
  read_listen(reader, settings.listen, settings.port);
  reader.texts("origins", settings.origins);
  for (const std::string& origin : settings.origins) {
    const std::size_t scheme = origin.find("://");
    if (scheme == origin.npos || origin.find('/', scheme + 3) != origin.npos || origin.size() == scheme + 3)
      reader.complain("origins",
                      "\"" + origin + "\" is no origin: \"https://robot.example:8443\", without a path");
  }
  reader.text_or_texts("trusted-proxy", settings.trusted_proxies);
  for (const std::string& proxy : settings.trusted_proxies)
    if (!is_network(proxy))
      reader.complain("trusted-proxy", "\"" + proxy +
                                           "\" is no numeric address of a proxy, nor a network of them: "
                                           "\"127.0.0.1\", \"10.0.0.0/8\"");
  reader.whole("picture-width", settings.picture_width, 160, 3840);
  reader.whole("quality", settings.quality, 10, 100);
  read_tls(reader, settings.tls, settings.certificate, settings.key, folders, files);
  reader.finish();
  return settings;
}

BaseSettings read_base(const TomlValue& table, Mistakes& mistakes) {
  TableReader reader(table, "[base]", mistakes);
  BaseSettings base;
  if (!reader.has("command"))
    reader.complain("command", "[base] needs the \"command\" of the program that drives the base");
  reader.text("command", base.command);
  reader.number("max-speed", base.max_speed, 0.01, 5);
  reader.number("max-yaw-rate", base.max_yaw_rate, 1, 360);
  reader.finish();
  return base;
}

WebhookSettings read_webhook(const TomlValue& table, Folders folders, Mistakes& mistakes,
                             std::vector<NamedFile>& files) {
  TableReader reader(table, "[webhook]", mistakes);
  WebhookSettings settings;
  for (const char* key : {"url", "secret-file"})
    if (!reader.has(key)) reader.complain(key, std::string("[webhook] needs \"") + key + "\"");
  if (reader.text("url", settings.url)) {
    const bool http = settings.url.starts_with("http://");
    const std::string_view rest =
        std::string_view(settings.url).substr(std::min<std::size_t>(http ? 7 : 8, settings.url.size()));
    if (!http && !settings.url.starts_with("https://"))
      reader.complain("url", "\"url\" begins with https:// or http://");
    else if (rest.empty() || rest.substr(0, rest.find('/')).find('@') != rest.npos)
      reader.complain("url", "\"url\" has a host, and no user or password before it: requests are signed");
  }
  read_path(reader, "secret-file", settings.secret_file, true, folders, files);
  read_path(reader, "ca-file", settings.ca_file, false, folders, files);
  std::vector<std::string> topics;
  if (reader.texts("topics", topics)) {
    settings.topics.clear();
    for (const std::string& topic : topics) {
      if (std::ranges::find(kTopics, topic) == kTopics.end())
        reader.complain("topics",
                        "\"" + topic + "\" is no topic: track, state, pir, pantilt, rule, mode, event");
      if (!settings.topics.empty()) settings.topics += ' ';
      settings.topics += topic;
    }
    if (topics.empty()) reader.complain("topics", "\"topics\" names none: leave [webhook] out");
  }
  reader.finish();
  return settings;
}

Properties read_mqtt(const TomlValue& table, Folders folders, bool& list_cameras, Mistakes& mistakes,
                     std::vector<NamedFile>& files) {
  TableReader reader(table, "[mqtt]", mistakes);
  reader.truth("list-cameras", list_cameras);
  Properties properties;
  if (!reader.has("host")) reader.complain("host", "[mqtt] needs the \"host\" of the broker");
  reader.properties(kMqtt, properties);
  for (const Property& property : properties)
    if (property.name == "host" &&
        (property.value.empty() || property.value.find_first_of(" /") != std::string::npos))
      reader.complain("host", "\"host\" of [mqtt] is \"" + property.value +
                                  "\": give the broker's name or address alone, and a port as \"port\"");
  for (const Property& property : properties)
    if (property.name == "topic-prefix" && !publish::is_topic_level(property.value))
      reader.complain("topic-prefix", "\"topic-prefix\" is one level of a topic, without / + #");
  if (std::string path = read_password_path(reader, "username", folders, files); !path.empty())
    properties.push_back(
        {"password-file", std::move(path),
         reader.line(reader.has("password-file") ? "password-file" : "password-credential")});
  if (std::string path; reader.text("ca-file", path)) {
    properties.push_back({"ca-file", below(folders.configuration, path), reader.line("ca-file")});
    files.push_back({reader.line("ca-file"), "ca-file", properties.back().value, false});
  }
  std::vector<std::string> commands;
  reader.texts("commands", commands);
  std::string list;
  for (const std::string& command : commands) {
    if (!publish::arguments_of(command))
      reader.complain(
          "commands",
          "\"" + command +
              "\" is no command: move-to, move-by, stop, home, auto, follow, arm, disarm, privacy, "
              "picture");
    if (!list.empty()) list += ' ';
    list += command;
  }
  if (!list.empty()) properties.push_back({"commands", list, reader.line("commands")});
  reader.finish();
  return properties;
}

RtspSettings read_rtsp(const TomlValue& table, Folders folders, Mistakes& mistakes,
                       std::vector<NamedFile>& files) {
  TableReader reader(table, "[rtsp]", mistakes);
  RtspSettings settings;
  read_listen(reader, settings.listen, settings.port);
  read_users(reader, settings.users_file, folders, files);
  bool anyone = false;
  reader.truth("anyone", anyone);
  if (anyone && !settings.users_file.empty())
    reader.complain("anyone", "\"anyone\" is for a server without users, and \"users-file\" names some");
  if (is_address(settings.listen) && !is_loopback(settings.listen) && settings.users_file.empty() && !anyone)
    reader.complain("listen", "at " + settings.listen +
                                  " the whole network could watch: name a \"users-file\", or anyone = true");
  read_tls(reader, settings.tls, settings.certificate, settings.key, folders, files);
  std::vector<std::string> mounts;
  if (reader.texts("mounts", mounts)) {
    settings.plain = settings.annotated = false;
    for (const std::string& mount : mounts) {
      if (mount == "plain")
        settings.plain = true;
      else if (mount == "annotated")
        settings.annotated = true;
      else
        reader.complain("mounts", "\"" + mount + "\" is no mount: plain, annotated");
    }
    if (mounts.empty()) reader.complain("mounts", "\"mounts\" names none: leave [rtsp] out");
  }
  read_encoder(reader, {"h264", "vp8", "jpeg"}, settings.encoder);
  reader.finish();
  return settings;
}

}  // namespace cerberus::robot
