// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/head_calibration.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::SpeedMap;
using motion::SpeedPoint;
using sensing::degrees;
using sensing::radians;

constexpr std::size_t kMostPoints = 64;
constexpr std::size_t kMostBytes = 65536;  // of a file; a calibration has less than a thousand
constexpr double kMostDeadTime = 5;        // seconds, as of HeadSetup::latency
constexpr double kMostBacklash = 90;       // degrees
constexpr double kMostSpeed = 3600;        // degrees a second

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

bool number(std::string_view text, double most, double& value) {
  double read = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), read);
  if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size()) return false;
  if (!(read >= 0 && read <= most)) return false;
  value = read;
  return true;
}

bool angle(std::string_view text, double& value) {
  if (!number(text, kMostBacklash, value)) return false;
  value = radians(value);
  return true;
}

bool speeds(std::string_view text, SpeedMap& map) {
  std::vector<SpeedPoint> points;
  while (!(text = trimmed(text)).empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(word.size());
    const std::size_t colon = word.find(':');
    SpeedPoint point;
    if (colon == word.npos || points.size() == kMostPoints ||
        !number(word.substr(0, colon), kMostSpeed, point.commanded) ||
        !number(word.substr(colon + 1), kMostSpeed, point.actual))
      return false;
    points.push_back({radians(point.commanded), radians(point.actual)});
  }
  if (!SpeedMap::is_valid(points)) return false;
  map = SpeedMap(std::move(points));
  return true;
}

// False: the value is none of this key.
bool take(std::string_view key, std::string_view value, HeadCalibration& c, bool& known) {
  known = true;
  double seconds = 0;
  if (key == "driver") return !(c.driver = value).empty();
  if (key == "device") return !(c.device = value).empty();
  if (key == "pan-backlash") return angle(value, c.pan_backlash);
  if (key == "tilt-backlash") return angle(value, c.tilt_backlash);
  if (key == "pan-speeds") return speeds(value, c.pan);
  if (key == "tilt-speeds") return speeds(value, c.tilt);
  if (key == "dead-time") {
    if (!number(value, kMostDeadTime, seconds)) return false;
    c.dead_time = motion::Time(static_cast<motion::Time::rep>(std::llround(seconds * 1e9)));
    return true;
  }
  if (key == "stops-alone") {
    if (value == "no") return true;
    if (!number(value, 3600, seconds)) return false;
    c.stops_alone = seconds;
    return true;
  }
  known = false;
  return true;
}

// How a value of this key is written.
const char* form_of(std::string_view key) {
  if (key.ends_with("-speeds"))
    return "write pairs COMMANDED:ACTUAL in degrees a second, both rising, parted by blanks: 1:0.9 10:9.5";
  if (key.ends_with("-backlash")) return "write degrees, 0 to 90";
  if (key == "dead-time") return "write seconds, 0 to 5";
  if (key == "stops-alone") return "write seconds, or no";
  return "name the one that was measured";
}

void append(std::string& text, const char* key, double value) {
  text.append(key).append(" = ") += text::rounded(value, 4).string_view();
  text += '\n';
}

void append(std::string& text, const char* key, const SpeedMap& map) {
  if (map.points().empty()) return;
  text.append(key).append(" =");
  for (const SpeedPoint& point : map.points()) {
    text.append(" ") += text::rounded(degrees(point.commanded), 4).string_view();
    text.append(":") += text::rounded(degrees(point.actual), 4).string_view();
  }
  text += '\n';
}

}  // namespace

std::string calibrated_device(std::string_view driver, std::string_view device, std::string_view command) {
  if (driver == "external") return std::string(command.substr(0, command.find(' ')));
  std::string name(device);
  const std::size_t host = name.find("//"), at = name.rfind('@');
  if (host != name.npos && at != name.npos && at > host) name.erase(host + 2, at - host - 1);
  return name;
}

std::string parse_calibration(std::string_view text, HeadCalibration& calibration) {
  HeadCalibration read;
  bool versioned = false;
  for (int n = 1; !text.empty(); ++n) {
    const std::string_view whole = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(whole.size() + 1, text.size()));
    const std::string_view line = trimmed(whole);
    if (line.empty() || line.front() == '#') continue;
    const std::string where = "line " + std::to_string(n) + ": ";
    const std::size_t sign = line.find('=');
    if (sign == line.npos) return where + "\"" + std::string(line.substr(0, 60)) + "\" is no `key = value`";
    const std::string_view key = trimmed(line.substr(0, sign)), value = trimmed(line.substr(sign + 1));
    if (key == "cerberus-calibration") {
      if (value != "1") return where + "this version of Cerberus reads calibrations of version 1";
      versioned = true;
      continue;
    }
    bool known = false;
    if (!take(key, value, read, known))
      return where + "\"" + std::string(value.substr(0, 60)) + "\" cannot be " + std::string(key) + ": " +
             form_of(key);
    if (!known) return where + "a calibration has no \"" + std::string(key.substr(0, 60)) + "\"";
  }
  if (!versioned) return "there is no line `cerberus-calibration = 1`: it is no calibration of a head";
  if (read.driver.empty() || read.device.empty()) return "it does not name its driver and device";
  calibration = std::move(read);
  return {};
}

std::string calibration_text(const HeadCalibration& c) {
  std::string text = "cerberus-calibration = 1\ndriver = " + c.driver + "\ndevice = " + c.device + "\n";
  append(text, "dead-time", motion::seconds(c.dead_time));
  append(text, "pan-backlash", degrees(c.pan_backlash));
  append(text, "tilt-backlash", degrees(c.tilt_backlash));
  append(text, "pan-speeds", c.pan);
  append(text, "tilt-speeds", c.tilt);
  if (c.stops_alone)
    append(text, "stops-alone", *c.stops_alone);
  else
    text += "stops-alone = no\n";
  return text;
}

std::string read_calibration(const std::string& path, const std::string& driver, const std::string& device,
                             HeadCalibration& calibration) {
  const std::string name = "the calibration " + path;
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(kMostBytes + 1, '\0');
  if (!file || !file.read(text.data(), static_cast<std::streamsize>(text.size())).eof())
    return name + " cannot be read: " + (errno != 0 ? std::strerror(errno) : "it is too long");
  text.resize(static_cast<std::size_t>(file.gcount()));
  HeadCalibration read;
  if (const std::string wrong = parse_calibration(text, read); !wrong.empty()) return name + ": " + wrong;
  if (read.driver != driver || read.device != device)
    return name + " was measured with the " + read.driver + " head at " + read.device + ", and this is the " +
           driver + " head at " + device + ": measure it (cerberus-heads calibrate), or take its own file";
  calibration = std::move(read);
  return {};
}

std::string use_calibration(const std::string& path, const std::string& driver, HeadSetup& setup) {
  HeadCalibration calibration;
  const std::string device = calibrated_device(driver, setup.device, setup.command);
  if (std::string wrong = read_calibration(path, driver, device, calibration); !wrong.empty()) return wrong;
  setup.latency = calibration.dead_time;
  setup.play = {calibration.pan_backlash, calibration.tilt_backlash};
  setup.pan_speeds = calibration.pan;
  setup.tilt_speeds = calibration.tilt;
  return {};
}

}  // namespace cerberus::drivers
