// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/tables/rivals.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "drivers/head/head_place.h"
#include "drivers/sensor/sensor_setup.h"
#include "drivers/servo/servo_options.h"
#include "drivers/stepper/stepper_options.h"
#include "text/numbers.h"

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

// One text for all spellings of a GPIO chip but its label.
std::string chip_of(std::string name) {
  if (name.empty()) name = drivers::SensorSetup{}.chip;
  if (drivers::number_of(name)) name.insert(0, "gpiochip");
  if (name.starts_with("gpiochip")) name.insert(0, "/dev/");
  return name.starts_with('/') ? real_path(name) : name;
}

std::string line_of_chip(const std::string& chip, const std::string& line) {
  const auto number = drivers::number_of(line);  // 017 is 17
  return chip_of(chip) + ' ' + (number ? text::significant(*number, 9).string() : line);
}

// Whether servers at these numeric addresses would want the same ports.
bool overlap(const std::string& a, const std::string& b) {
  const auto is_any = [](const std::string& address) { return address == "0.0.0.0" || address == "::"; };
  return a == b || is_any(a) || is_any(b);
}

// What is taken, and by which part of which camera.
class Owners {
 public:
  explicit Owners(Mistakes& mistakes) : mistakes_(mistakes) {}

  struct Use {
    const CameraSettings& camera;
    std::string
        part;  // "the head of "; one part that takes a thing twice is no mistake here: its element says so
    std::uint32_t line;
    std::string key, as;  // as the file has it
  };
  // The later of two uses of `what` is the mistake.
  void take(const std::string& what, const Use& use, std::string_view advice) {
    const auto [owner, is_new] = owners_.emplace(what, std::pair(use.camera.name, use.part));
    if (is_new || (owner->second == std::pair(use.camera.name, use.part) && !use.part.empty())) return;
    mistakes_.push_back({use.line, "\"" + use.key + "\" of camera \"" + use.camera.name + "\" is \"" +
                                       use.as + "\", which is in use by " + owner->second.second +
                                       "camera \"" + owner->second.first +
                                       "\" already: " + std::string(advice)});
  }

 private:
  Mistakes& mistakes_;
  std::map<std::string, std::pair<std::string, std::string>> owners_;
};

std::uint32_t line_of(const Lines& lines, std::string_view key, std::uint32_t otherwise) {
  const auto found = lines.find(key);
  return found == lines.end() ? otherwise : found->second;
}

void take_source(const CameraSettings& camera, Owners& owners) {
  const SourceSettings& source = camera.source;
  const std::uint32_t line = line_of(camera.lines, "device", camera.line);
  constexpr std::string_view kAdvice = "a device gives its pictures to one camera; name another";
  const Owners::Use use{camera, "", line, "device", source.device};
  if (source.kind == SourceKind::v4l2) owners.take("capture " + real_path(source.device), use, kAdvice);
  if (source.kind == SourceKind::libcamera) owners.take("libcamera " + source.device, use, kAdvice);
}

constexpr std::string_view kOneUser = "a GPIO line has one user; name another";

void take_line(const std::string& chip, const std::string& line, const Owners::Use& use, Owners& owners) {
  owners.take("line " + line_of_chip(chip, line), use, kOneUser);
}

// The lines of its motors, and the channels of its servos.
void take_motors(const CameraSettings& camera, const std::string& driver, const std::string& device,
                 const Property& options, Owners& owners) {
  for (const drivers::OptionWord& word : drivers::option_words(options.value)) {
    Owners::Use use{camera, "the head of ", options.line, options.name, ""};
    drivers::StepperAxisOptions stepper;
    drivers::ServoAxisOptions servo;
    const bool axis = word.key == "pan" || word.key == "tilt";
    if (const auto sign = word.value.rfind(':'); word.key == "emergency-stop" && sign != word.value.npos) {
      use.part = "the emergency stop of ";
      use.as = word.value.substr(sign + 1);
      take_line(word.value.substr(0, sign), use.as, use, owners);
    } else if (axis && driver == "stepper-gpio" && drivers::parse_stepper_axis(word.value, stepper).empty()) {
      if (!stepper.end_stop.empty()) stepper.lines.push_back(stepper.end_stop);
      for (const std::string& line : stepper.lines) {
        use.as = line;
        take_line(device, line, use, owners);
      }
    } else if (axis && driver == "servo-pwm" && drivers::parse_servo_axis(word.value, servo).empty()) {
      use.as = "channel=" + std::to_string(servo.channel);
      owners.take("pwm " + real_path(drivers::pwm_chip_folder(device)) + ' ' + std::to_string(servo.channel),
                  use, "a PWM channel drives one servo; name another");
    }
  }
}

void take_head(const CameraSettings& camera, Owners& owners) {
  const Property* device = find(camera.head, "device");
  if (device == nullptr) return;
  const Property* options = find(camera.head, "device-options");
  const std::string driver = value(camera.head, "driver");
  const std::string place = drivers::head_place(
      driver, device->value, drivers::option_words(options ? std::string_view(options->value) : ""));
  if (!place.empty())
    owners.take("head " + driver + ' ' + place, {camera, "", device->line, "device", device->value},
                "a head follows one camera; name another (or another address= in \"device-options\")");
  if (options) take_motors(camera, driver, device->value, *options, owners);
}

// One head at most asks the base to turn.
void take_base(const Settings& settings, const CameraSettings& camera, Owners& owners, Mistakes& mistakes) {
  const Property* turn = find(camera.head, "base-turn");
  if (turn == nullptr || turn->value.find_first_not_of("0.") == std::string::npos) return;
  if (!settings.base)
    mistakes.push_back({turn->line, "\"base-turn\" of camera \"" + camera.name +
                                        "\" asks a base to turn, and there is none: add a [base]"});
  owners.take("base", {camera, "the head of ", turn->line, "base-turn", turn->value},
              "one head asks the base to turn");
}

void take_sensors(const CameraSettings& camera, Owners& owners) {
  const std::string driver = value(camera.sensors, "driver");
  if (driver == "gpio") {
    const std::string chip = value(camera.sensors, "chip");
    for (const char* key : {"lines", "leds-red", "leds-blue"})
      if (const Property* lines = find(camera.sensors, key))
        for (const std::string& line : drivers::comma_list(lines->value))
          take_line(chip, line, {camera, "the sensors of ", lines->line, key, line}, owners);
  } else if (driver == "external") {
    const Property* device = find(camera.sensors, "device");
    if (device == nullptr) return;
    const bool serial = device->value.starts_with(kSerial);
    const std::string path = serial ? device->value.substr(kSerial.size()) : device->value;
    owners.take("lines of " + real_path(path), {camera, "", device->line, "device", device->value},
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
    take_base(settings, camera, owners, mistakes);
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
