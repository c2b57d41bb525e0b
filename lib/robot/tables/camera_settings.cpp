// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/tables/camera_settings.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "publish/streams/encoders.h"

namespace cerberus::robot {

namespace {

using text::TomlValue;
using K = Option::Kind;

constexpr double kDay = 86400;  // seconds
// Where systemd puts the credentials of the service (CREDENTIALS_DIRECTORY).
constexpr std::string_view kCredentials = "/run/credentials/cerberusd.service";

constexpr Option kDetection[] = {
    {"preset", K::choice, 0, 0, "default paper traffic"},
    {"analysis-width", K::whole, 0, 3840},
    {"mounting-height", K::number, 0, 100},
    {"tilt", K::number, -90, 90},
    {"zones", K::text},
    {"burnt-in", K::truth},
    {"people", K::truth},
    {"minimum-area", K::number, 0, 1e6},
    {"confirm-time", K::seconds, 0, 60},
    {"hold-stopped", K::seconds, 0, kDay},
};

constexpr Option kPersons[] = {
    {"detector", K::choice, 0, 0, "hog daimler"},
    {"model", K::text},
    {"config", K::text},
    {"labels", K::text},
    {"mean", K::text},
    {"scale", K::text},
    {"threshold", K::number, 0, 10},
    {"rate", K::number, 0.1, 10},
    {"cpu", K::number, 0.01, 1},
    {"require", K::choice, 0, 0, "none person"},
};

constexpr Option kFusion[] = {
    {"rules", K::choice, 0, 0, "complete paper"},
    {"rules-file", K::text},
    {"return-delay", K::seconds, 0, kDay},
    {"target", K::choice, 0, 0, "nearest largest newest"},
};

constexpr Option kSensors[] = {
    {"driver", K::choice, 0, 0, "gpio iio evdev external replay scripted"},
    {"preset", K::choice, 0, 0, "none hc-sr501 am312 sk-11"},
    {"bearings", K::text},
    {"field-of-view", K::number, 0.1, 360},
    {"range", K::number, 0, 100},
    {"chip", K::text},
    {"lines", K::text},
    {"bias", K::choice, 0, 0, "as-is none pull-up pull-down"},
    {"active-low", K::truth},
    {"leds-red", K::text},
    {"leds-blue", K::text},
    {"warm-up", K::seconds, 0, 3600},
    {"hold", K::seconds, 0, 3600},
    {"device", K::text},
    {"device-options", K::text},
    {"codes", K::text},
    {"command", K::text},
    {"iio-device", K::text},
    {"channels", K::text},
    {"threshold", K::number, -1000, 1000},
    {"hysteresis", K::number, 0, 1000},
    {"location", K::text},
    {"script", K::text},
};

// A simulated robot's own.
constexpr Option kPatrolSensors[] = {
    {"preset", K::choice, 0, 0, "none hc-sr501 am312 sk-11"},
    {"bearings", K::text},
    {"field-of-view", K::number, 0.1, 180},
    {"range", K::number, 0, 50},
};

constexpr Option kPatrol[] = {
    {"plan", K::text},
    {"path", K::text},
    {"walks", K::text},
    {"people", K::whole, 0, 16},
    {"seed", K::whole, 0, 2147483647},
    {"speed", K::number, 0.05, 1.5},
    {"yaw-rate", K::number, 1, 60},
    {"shake", K::number, 0, 5},
    {"shake-kind", K::choice, 0, 0, "robot hand"},
    {"camera-height", K::number, 0.1, 3},
    {"noise", K::number, 0, 30},
    {"inset", K::truth},
};

constexpr Option kHead[] = {
    {"driver", K::choice, 0, 0, "simulated external visca pelco-d onvif stepper-gpio servo-pwm v4l2"},
    {"device", K::text},
    {"device-options", K::text},
    {"command", K::text},
    {"calibration", K::text},
    {"pan-min", K::number, -3600, 0},
    {"pan-max", K::number, 0, 3600},
    {"tilt-min", K::number, -3600, 0},
    {"tilt-max", K::number, 0, 3600},
    {"max-speed", K::number, 0.001, 3600},
    {"max-acceleration", K::number, 0.001, 1e6},
    {"turn-speed", K::number, 0, 3600},
    {"response", K::choice, 0, 0, "calm normal fast"},
    {"latency", K::seconds, 0, 5},
    {"zoom-table", K::text},
    {"lock-zoom", K::number, -1, 2},
    {"keep-size", K::truth},
    {"base-gyro", K::text},
    {"base-turn", K::number, 0, 360},
    {"watchdog-timeout", K::seconds, 0.05, 60},
    {"manual-timeout", K::seconds, 0, kDay},
};

constexpr Option kRecorder[] = {
    {"pre-roll", K::seconds, 0, 600},
    {"post-roll", K::seconds, 0, 600},
    {"join", K::seconds, 0, 600},
    {"longest-file", K::seconds, 0, kDay},
    {"retention-size", K::whole, 0, 1 << 30},
    {"retention-free", K::whole, 0, 1 << 30},
    {"file-name", K::text},
    {"trigger-track", K::truth},
    {"trigger-fusion", K::truth},
    {"trigger-pir", K::truth},
    {"trigger-zones", K::text},
};

constexpr std::array<std::string_view, 7> kKinds{"test", "world",     "file",  "v4l2",
                                                 "rtsp", "libcamera", "patrol"};
constexpr std::array<std::string_view, 3> kCodecs{"h264", "h265", "jpeg"};

std::string* value_of(Properties& properties, std::string_view name) {
  for (Property& property : properties)
    if (property.name == name) return &property.value;
  return nullptr;
}

class CameraReader {
 public:
  CameraReader(const TomlValue& table, Folders folders, Mistakes& mistakes, std::vector<NamedFile>& files)
      : reader_(table, "[[camera]]", mistakes),
        folders_(folders),
        folder_(folders.configuration),
        mistakes_(mistakes),
        files_(files) {
    camera_.line = table.line;
  }

  CameraSettings read() {
    if (!reader_.has("name")) reader_.complain("name", "a [[camera]] needs a \"name\"");
    if (reader_.text("name", camera_.name)) check_name();
    read_source();
    reader_.number("horizontal-fov", camera_.horizontal_fov, 1, 179);
    check_window();
    if (const TomlValue* table = reader_.table("detection"))
      read_part(*table, "[camera.detection]", kDetection, camera_.detection);
    if (const TomlValue* table = reader_.table("persons")) read_persons(*table);
    if (const TomlValue* table = reader_.table("fusion"))
      read_part(*table, "[camera.fusion]", kFusion, camera_.fusion);
    const bool patrols = camera_.source.kind == SourceKind::patrol;
    if (const TomlValue* table = reader_.table("patrol")) {
      read_part(*table, "[camera.patrol]", kPatrol, camera_.source.patrol);
      if (!patrols) mistakes_.push_back({table->line, "[camera.patrol] is for kind = \"patrol\" only"});
    }
    if (const TomlValue* table = reader_.table("sensors")) {
      read_part(*table, "[camera.sensors]",
                patrols ? std::span<const Option>(kPatrolSensors) : std::span<const Option>(kSensors),
                camera_.sensors.emplace());
      if (!patrols && table->find("driver") == nullptr)
        mistakes_.push_back(
            {table->line,
             "[camera.sensors] needs a \"driver\": gpio, iio, evdev, external, replay or scripted"});
    }
    if (const TomlValue* table = reader_.table("head")) {
      read_part(*table, "[camera.head]", kHead, camera_.head.emplace());
      check_head(*table);
    }
    if (const TomlValue* table = reader_.table("recorder")) read_recorder(*table);
    if (camera_.source.kind == SourceKind::world && !camera_.head)
      reader_.complain("kind", "kind = \"world\" is a simulated head's world: it needs a [camera.head]");
    reader_.lines("", camera_.lines);
    reader_.finish();
    return std::move(camera_);
  }

 private:
  // The name is part of file names, MQTT topics and addresses.
  void check_name() {
    const auto plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
             c == '_';
    };
    if (camera_.name.empty() || camera_.name.size() > 64 || !std::ranges::all_of(camera_.name, plain))
      reader_.complain("name", "\"name\" of [[camera]] is 1 to 64 letters (a to z), digits, - and _");
  }

  // The window of a world shows a part of it.
  void check_window() {
    if (camera_.source.kind != SourceKind::world) return;
    if (!reader_.has("horizontal-fov"))
      camera_.horizontal_fov = camera_.source.wide_fov / 2;
    else if (camera_.horizontal_fov >= camera_.source.wide_fov)
      reader_.complain(
          "horizontal-fov",
          "\"horizontal-fov\", what the window shows, is less than \"wide-fov\", what the video shows");
  }

  // Keys of one kind of source are mistakes with another.
  void only_with(std::initializer_list<const char*> keys, std::initializer_list<SourceKind> kinds) {
    for (const char* key : keys) {
      if (reader_.has(key) && std::ranges::find(kinds, camera_.source.kind) == kinds.end())
        reader_.complain(key, std::string("\"") + key + "\" is not for kind = \"" +
                                  std::string(kKinds[static_cast<std::size_t>(camera_.source.kind)]) + "\"");
    }
  }
  void needs(const char* key, const std::string& value) {
    if (reader_.has(key) && value.empty())
      reader_.complain(key, std::string("\"") + key + "\" of [[camera]] is empty");
    if (!reader_.has(key))
      reader_.complain("kind", "kind = \"" +
                                   std::string(kKinds[static_cast<std::size_t>(camera_.source.kind)]) +
                                   "\" needs \"" + key + "\"");
  }

  void read_source() {
    SourceSettings& source = camera_.source;
    std::size_t kind = 0, codec = 0;
    const bool known = reader_.choice("kind", kind, kKinds);
    if (!reader_.has("kind"))
      reader_.complain("kind",
                       "a [[camera]] needs a \"kind\": test, world, file, v4l2, rtsp, libcamera or patrol");
    source.kind = static_cast<SourceKind>(kind);
    reader_.text("device", source.device);
    reader_.text("uri", source.uri);
    reader_.text("record-uri", source.record_uri);
    reader_.text("user", source.user);
    source.password_file = read_password_path(reader_, "user", folders_, files_);
    if (reader_.choice("codec", codec, kCodecs)) source.codec = static_cast<Codec>(codec);
    if (reader_.text("file", source.file)) {
      source.file = below(folder_, source.file);
      files_.push_back({reader_.line("file"), "file", source.file, false});
    }
    reader_.truth("loop", source.loop);
    reader_.truth("motion-jpeg", source.motion_jpeg);
    reader_.whole("width", source.width, 32, 8192);
    reader_.whole("height", source.height, 32, 8192);
    reader_.whole("framerate", source.framerate, 1, 240);
    reader_.number("wide-fov", source.wide_fov, 1, 170);
    reader_.number("start-pan", source.start_pan, -90, 90);
    reader_.number("start-tilt", source.start_tilt, -90, 90);
    if (!known) return;
    using enum SourceKind;
    only_with({"device"}, {v4l2, libcamera});
    only_with({"motion-jpeg"}, {v4l2});
    only_with({"uri", "record-uri", "user", "password-file", "password-credential", "codec"}, {rtsp});
    only_with({"file", "loop"}, {SourceKind::file, world});
    only_with({"wide-fov", "start-pan", "start-tilt"}, {world});
    only_with({"width", "height"}, {test, world, v4l2, libcamera, patrol});
    only_with({"framerate"}, {test, v4l2, libcamera, patrol});
    if (source.kind == v4l2) needs("device", source.device);
    if (source.kind == rtsp) needs("uri", source.uri);
    if (source.kind == SourceKind::file || source.kind == world) needs("file", source.file);
    if (reader_.has("width") != reader_.has("height"))
      reader_.complain(reader_.has("width") ? "width" : "height", "\"width\" and \"height\" belong together");
    for (const char* key : {"uri", "record-uri"}) check_uri(key);
  }

  void check_uri(const char* key) {
    if (!reader_.has(key)) return;
    const std::string& uri = key[0] == 'u' ? camera_.source.uri : camera_.source.record_uri;
    if (!uri.starts_with("rtsp://") && !uri.starts_with("rtsps://")) {
      reader_.complain(key, std::string("\"") + key + "\" begins with rtsp:// or rtsps://");
      return;
    }
    const std::size_t host = uri.find("://") + 3;
    const std::string authority = uri.substr(host, uri.find('/', host) - host);
    if (authority.find('@') != authority.npos)
      reader_.complain(
          key, std::string("\"") + key + "\" holds a user or a password: use \"user\" and \"password-file\"");
  }

  void read_part(const TomlValue& table, const char* where, std::span<const Option> options,
                 Properties& into) {
    TableReader reader(table, where, mistakes_);
    reader.properties(options, into);
    for (const char* key : {"rules-file", "calibration", "location", "plan"}) {
      std::string* path = value_of(into, key);
      if (path == nullptr) continue;
      *path = below(folder_, *path);
      files_.push_back({reader.line(key), key, *path, false});
    }
    // Passwords of heads come from files (user=..., password-file=...).
    if (const std::string* words = value_of(into, "device-options");
        words != nullptr && words->find("password=") != words->npos)
      reader.complain("device-options",
                      "\"device-options\" holds a password: write password-file=... with the path of a file");
    reader.finish();
  }

  // With the table a missing element is an error, so that `require` and others are not ignored.
  void read_persons(const TomlValue& table) {
    TableReader reader(table, "[camera.persons]", mistakes_);
    PersonsSettings& persons = camera_.persons;
    bool enabled = true;
    reader.truth("enabled", enabled);
    persons.use = enabled ? PersonsUse::always : PersonsUse::never;
    reader.properties(kPersons, persons.properties);
    for (const char* key : {"model", "config", "labels"}) {
      std::string* path = value_of(persons.properties, key);
      // personverify itself looks for a model without a folder.
      if (path == nullptr || (std::string_view(key) == "model" && path->find('/') == path->npos)) continue;
      *path = below(folder_, *path);
      files_.push_back({reader.line(key), key, *path, false});
    }
    if (reader.has("model") && reader.has("detector"))
      reader.complain("detector", "\"detector\" and \"model\" are two ways to find people: give one of them");
    for (const char* key : {"config", "labels", "mean", "scale"})
      if (reader.has(key) && !reader.has("model"))
        reader.complain(key, std::string("\"") + key + "\" is of a \"model\", and none is named");
    reader.finish();
  }

  void check_head(const TomlValue& table) {
    TableReader reader(table, "[camera.head]", mistakes_);
    const std::string* driver = value_of(*camera_.head, "driver");
    const std::string kind = driver != nullptr ? *driver : "simulated";
    if (camera_.source.kind == SourceKind::world && kind != "simulated")
      reader.complain("driver",
                      "kind = \"world\" has a simulated head: its window cannot be turned by another");
    if (camera_.source.kind == SourceKind::patrol && kind != "simulated")
      reader.complain("driver",
                      "kind = \"patrol\" has a simulated head: its camera cannot be turned by another");
    if (kind == "external" && !reader.has("command"))
      reader.complain("driver", "driver = \"external\" needs \"command\"");
    if (kind != "external" && kind != "simulated" && !reader.has("device"))
      reader.complain("driver", "driver = \"" + kind + "\" needs \"device\"");
  }

  void read_recorder(const TomlValue& table) {
    TableReader reader(table, "[camera.recorder]", mistakes_);
    reader.lines("recorder.", camera_.lines);
    RecorderSettings& recorder = camera_.recorder.emplace();
    if (!reader.has("folder")) reader.complain("folder", "a [camera.recorder] needs a \"folder\"");
    if (reader.text("folder", recorder.folder) && recorder.folder.empty())
      reader.complain("folder", "\"folder\" of [camera.recorder] is empty: give the path of a folder");
    else
      recorder.folder = below(folder_, recorder.folder);
    read_encoder(reader, {"h264", "jpeg"}, recorder.encoder);
    for (const char* key : {"encoder", "bitrate"})
      if (reader.has(key) && camera_.source.kind == SourceKind::rtsp)
        reader.complain(key, "the stream of kind = \"rtsp\" is recorded as it comes, without an encoder");
    double days = 7;
    if (reader.number("retention-days", days, 0, 36500))
      recorder.properties.push_back({"retention-age",
                                     std::to_string(static_cast<std::int64_t>(days * kDay * 1e9)),
                                     reader.line("retention-days")});
    reader.properties(kRecorder, recorder.properties);
    reader.finish();
  }

  TableReader reader_;
  Folders folders_;
  std::string_view folder_;  // of the configuration
  Mistakes& mistakes_;
  std::vector<NamedFile>& files_;
  CameraSettings camera_;
};

}  // namespace

std::string below(std::string_view folder, std::string_view path) {
  if (folder.empty() || path.empty() || path.front() == '/') return std::string(path);
  std::string whole(folder);
  if (!whole.ends_with('/')) whole += '/';
  return whole.append(path);
}

std::string credential_path(TableReader& reader, const char* key, const std::string& name, Folders folders,
                            std::vector<NamedFile>& files) {
  if (name.empty() || name.front() == '.' || name.find('/') != name.npos)
    reader.complain(key,
                    std::string("\"") + key + "\" is the name of a credential of systemd, without a path");
  std::string path = below(folders.credentials.empty() ? kCredentials : folders.credentials, name);
  // Outside of the service, as for --check, credentials are not there.
  if (!folders.credentials.empty()) files.push_back({reader.line(key), key, path, true});
  return path;
}

void read_encoder(TableReader& reader, std::initializer_list<std::string_view> codecs,
                  EncoderSettings& encoder) {
  std::vector<std::string_view> words, elements;
  const auto accept = [&](std::string_view word, std::string_view element) {
    words.push_back(word);
    elements.push_back(element);
  };
  for (const publish::Encoder& one : publish::encoders())
    if (std::ranges::find(codecs, one.codec) != codecs.end()) accept(one.element, one.element);
  accept(kAnyH264, kAnyH264);
  for (const publish::Encoder& one : publish::encoders())
    if (std::ranges::find(codecs, one.codec) != codecs.end()) accept(one.name, one.element);
  std::size_t chosen = 0;
  if (reader.choice("encoder", chosen, words)) encoder.element = elements[chosen];
  reader.whole("bitrate", encoder.bitrate, 50, 100000);
  if (reader.has("bitrate") && encoder.element == "jpegenc")
    reader.complain("bitrate", "\"bitrate\" is not for encoder = \"jpegenc\"");
}

std::string read_password_path(TableReader& reader, const char* user_key, Folders folders,
                               std::vector<NamedFile>& files) {
  std::string file, credential;
  const bool has_file = reader.text("password-file", file);
  const bool has_credential = reader.text("password-credential", credential);
  if (reader.has("password-file") && reader.has("password-credential")) {
    reader.complain("password-credential",
                    "\"password-file\" and \"password-credential\" name one secret: give one of them");
  } else if ((reader.has("password-file") || reader.has("password-credential")) != reader.has(user_key)) {
    reader.complain(user_key, std::string("\"") + user_key +
                                  "\" and \"password-file\" belong together (or \"password-credential\")");
  }
  if (has_credential) {
    file = credential_path(reader, "password-credential", credential, folders, files);
  } else if (has_file) {
    file = below(folders.configuration, file);
    files.push_back({reader.line("password-file"), "password-file", file, true});
  }
  return file;
}

CameraSettings read_camera(const TomlValue& table, Folders folders, Mistakes& mistakes,
                           std::vector<NamedFile>& files) {
  return CameraReader(table, folders, mistakes, files).read();
}

}  // namespace cerberus::robot
