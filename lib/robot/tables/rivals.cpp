// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/tables/rivals.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "drivers/head/head_place.h"

namespace cerberus::robot {

namespace {

constexpr std::string_view kSerial = "serial:";

const Property* find(const std::optional<Properties>& properties, std::string_view name) {
  if (!properties) return nullptr;
  const auto found = std::ranges::find(*properties, name, &Property::name);
  return found == properties->end() ? nullptr : &*found;
}

std::string value(const std::optional<Properties>& properties, std::string_view name) {
  const Property* found = find(properties, name);
  return found ? found->value : "";
}

// One text for all spellings of a path, of links too.
std::string real_path(const std::string& path) {
  std::error_code wrong;
  const std::filesystem::path real = std::filesystem::weakly_canonical(path, wrong);
  return wrong ? path : real.string();
}

std::vector<std::string> comma_list(std::string_view text) {
  std::vector<std::string> all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    all.emplace_back(word);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

// Whether servers at these numeric addresses would want the same ports.
bool overlap(const std::string& a, const std::string& b) {
  const auto is_any = [](const std::string& address) { return address == "0.0.0.0" || address == "::"; };
  return a == b || is_any(a) || is_any(b);
}

// What is taken, and by which camera.
class Owners {
 public:
  explicit Owners(Mistakes& mistakes) : mistakes_(mistakes) {}

  // `what` is used by a camera's key, whose text is `as`; the later of two is the mistake.
  void take(const std::string& what, const CameraSettings& camera, std::uint32_t line, const std::string& key,
            const std::string& as, std::string_view advice) {
    const auto [owner, is_new] = owners_.emplace(what, camera.name);
    if (is_new) return;
    mistakes_.push_back({line, "\"" + key + "\" of camera \"" + camera.name + "\" is \"" + as +
                                   "\", which camera \"" + owner->second +
                                   "\" uses already: " + std::string(advice)});
  }

 private:
  Mistakes& mistakes_;
  std::map<std::string, std::string> owners_;
};

std::uint32_t line_of(const Lines& lines, std::string_view key, std::uint32_t otherwise) {
  const auto found = lines.find(key);
  return found == lines.end() ? otherwise : found->second;
}

void take_source(const CameraSettings& camera, Owners& owners) {
  const SourceSettings& source = camera.source;
  const std::uint32_t line = line_of(camera.lines, "device", camera.line);
  constexpr std::string_view kAdvice = "a device gives its pictures to one camera; name another";
  if (source.kind == SourceKind::v4l2)
    owners.take("capture " + real_path(source.device), camera, line, "device", source.device, kAdvice);
  if (source.kind == SourceKind::libcamera)
    owners.take("libcamera " + source.device, camera, line, "device", source.device, kAdvice);
}

void take_head(const CameraSettings& camera, Owners& owners) {
  const Property* device = find(camera.head, "device");
  if (device == nullptr) return;
  const std::string driver = value(camera.head, "driver"), options = value(camera.head, "device-options");
  std::string place = drivers::head_place(driver, device->value, drivers::option_words(options));
  // Its lines or channels are parts of the options.
  if (place.empty() && (driver == "stepper-gpio" || driver == "servo-pwm"))
    place = device->value + ' ' + options;
  if (place.empty()) return;
  owners.take("head " + driver + ' ' + place, camera, device->line, "device", device->value,
              "a head follows one camera; name another (or another address= in \"device-options\")");
}

void take_sensors(const CameraSettings& camera, Owners& owners) {
  const std::string driver = value(camera.sensors, "driver");
  if (driver == "gpio") {
    const std::string chip = value(camera.sensors, "chip");
    for (const char* key : {"lines", "leds-red", "leds-blue"}) {
      const Property* lines = find(camera.sensors, key);
      if (lines == nullptr) continue;
      std::vector<std::string> words = comma_list(lines->value);
      std::ranges::sort(words);  // pirsrc itself names one that a camera has twice
      words.erase(std::unique(words.begin(), words.end()), words.end());
      for (const std::string& word : words)
        owners.take("line " + chip + ' ' + word + (std::string_view(key) == "lines" ? "" : " of an LED"),
                    camera, lines->line, key, word, "a GPIO line belongs to one sensor; name another");
    }
  } else if (driver == "external") {
    const Property* device = find(camera.sensors, "device");
    if (device == nullptr) return;
    const bool serial = device->value.starts_with(kSerial);
    const std::string path = serial ? device->value.substr(kSerial.size()) : device->value;
    owners.take("lines of " + real_path(path), camera, device->line, "device", device->value,
                "its lines are read by one; name another");
  }
}

// A serial port has one reader: sensors, or the heads on its bus.
void compare_ports(const Settings& settings, Mistakes& mistakes) {
  const auto port_of = [](const Property* device) {
    return device != nullptr && device->value.starts_with(kSerial)
               ? real_path(device->value.substr(kSerial.size()))
               : std::string();
  };
  for (const CameraSettings& one : settings.cameras) {
    const Property* head = find(one.head, "device");
    const std::string port = port_of(head);
    if (port.empty()) continue;
    for (const CameraSettings& other : settings.cameras) {
      const Property* sensors = find(other.sensors, "device");
      if (port_of(sensors) != port) continue;
      mistakes.push_back({std::max(head->line, sensors->line),
                          "\"device\" is \"" + head->value + "\" of the head of camera \"" + one.name +
                              "\" and of the sensors of camera \"" + other.name +
                              "\": a serial port has one reader; name another"});
    }
  }
}

}  // namespace

void find_rivals(const Settings& settings, Mistakes& mistakes) {
  const PageSettings& page = settings.page;
  if (page.enabled && settings.rtsp && settings.rtsp->port == page.port &&
      overlap(page.listen, settings.rtsp->listen)) {
    const std::uint32_t of_page = line_of(settings.lines, "page.port", 0),
                        of_rtsp = line_of(settings.lines, "rtsp.port", 0);
    mistakes.push_back(
        {std::max(of_page, of_rtsp), "\"port\" is " + std::to_string(page.port) +
                                         " of both [page] and [rtsp]: give one of them another"});
  }
  Owners owners(mistakes);
  for (const CameraSettings& camera : settings.cameras) {
    take_source(camera, owners);
    take_head(camera, owners);
    take_sensors(camera, owners);
    const bool records = camera.recorder || (settings.rtsp && settings.rtsp->plain);
    if (!camera.source.record_uri.empty() && !records)
      mistakes.push_back(
          {line_of(camera.lines, "record-uri", camera.line),
           "nothing takes the stream of \"record-uri\": add a [camera.recorder] with a \"folder\", or leave "
           "the key out"});
  }
  compare_ports(settings, mistakes);
}

}  // namespace cerberus::robot
