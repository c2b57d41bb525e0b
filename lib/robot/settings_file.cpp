// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/settings_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <utility>

#include "publish/streams/users.h"
#include "robot/tables/camera_settings.h"
#include "robot/tables/network_tables.h"
#include "robot/tables/rivals.h"
#include "robot/tables/table_reader.h"
#include "text/file.h"

namespace cerberus::robot {

namespace {

using text::TomlValue;

// Largest configuration file, largest secret, in bytes. A larger file was named by mistake.
constexpr std::size_t kMostBytes = 1 << 20, kMostSecret = 4096;
constexpr std::size_t kMostUsers = 1 << 21;  // bytes: 1000 users with the longest passwords

// ns, 60 s: the longest way of a slow head takes less, and a person who steers looks more often.
constexpr std::string_view kManualTimeout = "60000000000";

constexpr std::array<std::string_view, 3> kModes{"armed", "disarmed", "privacy"};
constexpr std::array<std::string_view, 7> kDays{"mon", "tue", "wed", "thu", "fri", "sat", "sun"};

Mode mode_at(std::size_t index) {
  return *mode_of(kModes[index]);
}

// "22:30" as minutes of the day; -1: it is none.
int minute_of(std::string_view text) {
  const auto digit = [&](std::size_t at) {
    return text[at] >= '0' && text[at] <= '9' ? text[at] - '0' : 100000;
  };
  if (text.size() != 5 || text[2] != ':') return -1;
  const int hour = 10 * digit(0) + digit(1), minute = 10 * digit(3) + digit(4);
  return hour < 24 && minute < 60 ? 60 * hour + minute : -1;
}

ScheduleEntry read_entry(const TomlValue& table, Mistakes& mistakes) {
  TableReader reader(table, "an entry of \"schedule\"", mistakes);
  ScheduleEntry entry;
  std::string at;
  if (!reader.has("at")) reader.complain("at", "an entry of \"schedule\" needs \"at\": at = \"22:30\"");
  if (reader.text("at", at)) {
    entry.minute = minute_of(at);
    if (entry.minute < 0)
      reader.complain("at", "\"at\" is a time of the day in hours and minutes: \"22:30\"");
  }
  std::size_t mode = 0;
  if (!reader.has("mode")) reader.complain("mode", "an entry of \"schedule\" needs \"mode\"");
  if (reader.choice("mode", mode, kModes)) entry.mode = mode_at(mode);
  std::vector<std::string> days;
  if (reader.texts("days", days)) {
    entry.days = 0;
    for (const std::string& day : days) {
      const auto found = std::ranges::find(kDays, day);
      if (found == kDays.end())
        reader.complain("days", "\"" + day + "\" is no day: mon, tue, wed, thu, fri, sat, sun");
      else
        entry.days = static_cast<std::uint8_t>(entry.days | 1U << (found - kDays.begin()));
    }
    if (days.empty()) reader.complain("days", "\"days\" names no day; without it every day counts");
  }
  reader.finish();
  return entry;
}

ModeSettings read_mode(const TomlValue& table, Mistakes& mistakes) {
  TableReader reader(table, "[mode]", mistakes);
  ModeSettings settings;
  std::size_t start = 0;
  if (reader.choice("start", start, kModes)) settings.start = mode_at(start);
  for (const TomlValue* entry : reader.tables("schedule", "[ { at = \"22:30\", mode = \"armed\" } ]"))
    settings.schedule.push_back(read_entry(*entry, mistakes));
  reader.finish();
  return settings;
}

// An order to move that arrived by MQTT ends after a time, as a network may fail before the next one.
void limit_moves(Settings& settings) {
  const auto find = [](const Properties& properties, std::string_view name) {
    return std::ranges::find(properties, name, &Property::name);
  };
  const auto commands = find(*settings.mqtt, "commands");
  if (commands == settings.mqtt->end() || commands->value.find("move-") == std::string::npos) return;
  for (CameraSettings& camera : settings.cameras)
    if (camera.head && find(*camera.head, "manual-timeout") == camera.head->end())
      camera.head->push_back({"manual-timeout", std::string(kManualTimeout)});
}

struct Parsed {
  Settings settings;
  Mistakes mistakes;
  std::vector<NamedFile> files;
};

Parsed parse(std::string_view toml, Folders folders) {
  Parsed parsed;
  const text::TomlFile file = text::parse_toml(toml);
  if (!file.root) {
    parsed.mistakes.push_back(file.mistake);
    return parsed;
  }
  Mistakes& mistakes = parsed.mistakes;
  Settings& settings = parsed.settings;
  TableReader reader(*file.root, "the file", mistakes);
  reader.text("name", settings.name);
  if (reader.text("state-folder", settings.state_folder))
    settings.state_folder = below(folders.configuration, settings.state_folder);
  std::vector<NamedFile>& files = parsed.files;
  auto owned_by = [&files, owned = std::size_t{0}](const std::string& owner) mutable {
    for (; owned < files.size(); ++owned) files[owned].owner = owner;
  };
  if (const TomlValue* table = reader.table("mode")) settings.mode = read_mode(*table, mistakes);
  if (const TomlValue* table = reader.table("page"))
    settings.page = read_page(*table, folders, mistakes, files);
  owned_by("page");
  if (const TomlValue* table = reader.table("rtsp"))
    settings.rtsp = read_rtsp(*table, folders, mistakes, files);
  owned_by("rtsp");
  if (const TomlValue* table = reader.table("mqtt"))
    settings.mqtt = read_mqtt(*table, folders, settings.list_cameras, mistakes, files);
  owned_by("mqtt");
  if (const TomlValue* table = reader.table("base")) settings.base = read_base(*table, mistakes);
  if (const TomlValue* table = reader.table("webhook"))
    settings.webhook = read_webhook(*table, folders, mistakes, files);
  owned_by("webhook");
  for (const TomlValue* table : reader.tables("camera", "[[camera]]")) {
    settings.cameras.push_back(read_camera(*table, folders, mistakes, files));
    owned_by("camera " + settings.cameras.back().name);
  }
  if (settings.mqtt) limit_moves(settings);
  if (!reader.has("camera")) mistakes.push_back({0, "there is no camera: it needs a [[camera]]"});
  std::set<std::string> names;
  for (const CameraSettings& camera : settings.cameras)
    if (!camera.name.empty() && !names.insert(camera.name).second)
      mistakes.push_back({camera.line, "there are two cameras called \"" + camera.name + "\""});
  reader.lines("", settings.lines);
  for (const char* key : {"page", "rtsp", "mqtt", "base", "webhook"})
    if (const TomlValue* table = file.root->find(key); table && table->is(TomlValue::Kind::table))
      TableReader(*table, key, mistakes).lines(std::string(key) + '.', settings.lines);
  find_rivals(settings, mistakes);
  reader.finish();
  return parsed;
}

// What is wrong with a file that the configuration names; empty: nothing.
std::string fault_of(const NamedFile& file) {
  struct stat about{};
  if (::stat(file.path.c_str(), &about) != 0)
    return "\"" + file.key + "\" names " + file.path + ": " + std::strerror(errno);
  if (!S_ISREG(about.st_mode))
    return "\"" + file.key + "\" names " + file.path + ", which is no regular file";
  if (file.secret && (about.st_mode & 07) != 0)
    return file.path + " holds a secret that every user of this machine can read: chmod 600 " + file.path;
  if (!file.users) return {};
  const text::File list = text::read_file(file.path, kMostUsers);
  if (list.fault == text::File::Fault::failed)
    return "\"" + file.key + "\" names " + file.path + ": " + std::strerror(list.error);
  if (list.fault != text::File::Fault::none)
    return "\"" + file.key + "\" names " + file.path + ", which is no list of users";
  std::vector<publish::User> users;
  const std::string wrong = publish::parse_users(list.text, users);
  return wrong.empty() ? "" : file.path + ": " + wrong;
}

// Differs once the file was written anew.
std::string stamp_of(const NamedFile& file) {
  struct stat about{};
  if (::stat(file.path.c_str(), &about) != 0) return file.path + '\n';
  return file.path + ' ' + std::to_string(about.st_ino) + ' ' + std::to_string(about.st_size) + ' ' +
         std::to_string(about.st_mtim.tv_sec) + '.' + std::to_string(about.st_mtim.tv_nsec) + '\n';
}

}  // namespace

std::string describe(Mistakes mistakes, std::string_view source) {
  std::ranges::stable_sort(mistakes, {}, &text::TomlMistake::line);
  std::string all;
  for (const text::TomlMistake& mistake : mistakes) {
    if (!all.empty()) all += '\n';
    all += source;
    if (mistake.line > 0) all += ':' + std::to_string(mistake.line);
    all += ": " + mistake.text;
  }
  return all;
}

SettingsFile parse_settings(std::string_view toml, std::string_view source, std::string_view folder) {
  Parsed parsed = parse(toml, {folder, {}});
  if (!parsed.mistakes.empty()) return {std::nullopt, describe(std::move(parsed.mistakes), source)};
  return {std::move(parsed.settings), ""};
}

SettingsFile load_settings(const std::string& path, std::string_view credentials) {
  using Fault = text::File::Fault;
  const text::File file = text::read_file(path, kMostBytes);
  switch (file.fault) {
    case Fault::failed:
      return {std::nullopt, path + ": " + std::strerror(file.error)};
    case Fault::irregular:
      return {std::nullopt, path + ": a configuration file is a regular file"};
    case Fault::too_large:
      return {std::nullopt, path + ": too long for a configuration file"};
    case Fault::none:
      break;
  }
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == path.npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  Parsed parsed = parse(file.text, {folder, credentials});
  for (const NamedFile& named : parsed.files)
    if (std::string fault = fault_of(named); !fault.empty())
      parsed.mistakes.push_back({named.line, std::move(fault)});
  if (!parsed.mistakes.empty()) return {std::nullopt, describe(std::move(parsed.mistakes), path)};
  for (const NamedFile& named : parsed.files) parsed.settings.stamps[named.owner] += stamp_of(named);
  return {std::move(parsed.settings), ""};
}

std::optional<std::string> read_secret(const std::string& path, std::string& error) {
  const text::File file = text::read_file(path, kMostSecret);
  if (file.fault == text::File::Fault::failed)
    error = path + ": " + std::strerror(file.error);
  else if (file.fault != text::File::Fault::none)
    error = path + " is no file with one line that holds a secret";
  std::string secret = file.text.substr(0, file.text.find_first_of("\r\n"));
  if (error.empty() && secret.empty()) error = path + " is empty: its first line is the secret";
  if (!error.empty()) return std::nullopt;
  return secret;
}

}  // namespace cerberus::robot
