// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/gpio/gpio_chip.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

namespace cerberus::drivers {

namespace {

bool number_of(const std::string& text, unsigned& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return !text.empty() && error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string> chip_paths() {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (std::filesystem::directory_iterator it("/dev", ignored), end; !ignored && it != end;
       it.increment(ignored))
    if (it->path().filename().string().starts_with("gpiochip")) paths.push_back(it->path().string());
  std::ranges::sort(paths);
  return paths;
}

// Converts a path, a name or a number to a path; empty: none of them.
std::string path_of(const std::string& wanted) {
  unsigned number = 0;
  if (wanted.starts_with('/')) return wanted;
  if (number_of(wanted, number)) return "/dev/gpiochip" + wanted;
  return wanted.starts_with("gpiochip") ? "/dev/" + wanted : "";
}

std::string available(const std::vector<std::string>& chips) {
  if (chips.empty()) return "This machine has no GPIO chip at all.";
  std::string list;
  for (const std::string& chip : chips) list.append(list.empty() ? "" : ", ").append(chip);
  return "There are: " + list + ".";
}

}  // namespace

SensorError open_gpio_chip(GpioLines& lines, const std::string& wanted, std::string& chip_path) {
  const std::vector<std::string> chips = chip_paths();
  int error = ENOENT;
  if (const std::string path = path_of(wanted); !path.empty()) {
    chip_path = path;
    error = lines.open(path);
  } else {
    chip_path = wanted;
    for (const std::string& chip : chips) {
      const int opened = lines.open(chip);
      if (opened == 0 && lines.label() == wanted) {
        chip_path = chip;
        return {};
      }
      if (opened == EACCES) error = EACCES;
    }
    lines.close();
  }
  switch (error) {
    case 0:
      return {};
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {SensorFault::not_found, "There is no GPIO chip \"" + wanted + "\". " + available(chips),
              errno_text(error)};
    case EACCES:
    case EPERM:
      return {SensorFault::denied,
              "No permission to use GPIO chip " + chip_path +
                  ": on Debian add the user to the group gpio, or let a udev rule allow it.",
              errno_text(error)};
    default:
      return {
          SensorFault::not_found,
          chip_path + " cannot be used as a GPIO chip (" + std::strerror(error) + "). " + available(chips),
          errno_text(error)};
  }
}

SensorError line_offsets(const GpioLines& lines, const std::string& chip,
                         const std::vector<std::string>& names, std::span<const unsigned> taken,
                         std::vector<unsigned>& offsets) {
  for (const std::string& name : names) {
    unsigned offset = 0;
    // A name takes precedence, because it may consist of digits.
    if (const int found = lines.find(name); found >= 0) {
      offset = static_cast<unsigned>(found);
    } else if (!number_of(name, offset)) {
      return {SensorFault::not_found,
              "GPIO chip " + chip + " has no line named \"" + name + "\"; gpioinfo lists its lines.", ""};
    } else if (offset >= lines.count()) {
      return {SensorFault::not_found,
              "GPIO chip " + chip + " has no line " + name + ": its lines are 0 to " +
                  std::to_string(lines.count() - 1) + ".",
              ""};
    }
    if (std::ranges::count(taken, offset) + std::ranges::count(offsets, offset) > 0)
      return {SensorFault::settings, "Line " + name + " of GPIO chip " + chip + " is named twice.", ""};
    offsets.push_back(offset);
  }
  return {};
}

SensorError lines_refused(GpioLines& lines, const std::string& chip, int error,
                          std::span<const unsigned> offsets) {
  lines.open(chip);  // reopened: lines in use now have other consumers
  std::string list;
  for (const unsigned offset : offsets) {
    const std::string user = lines.user(offset);
    if (error == EBUSY && !user.empty()) {
      return {SensorFault::busy,
              "Line " + std::to_string(offset) + " of GPIO chip " + chip + " is in use by \"" + user +
                  "\": end that, or take another line.",
              errno_text(error)};
    }
    list.append(list.empty() ? "" : ", ").append(std::to_string(offset));
  }
  if (error == EBUSY)
    return {SensorFault::busy,
            "Lines " + list + " of GPIO chip " + chip + " are not free: gpioinfo says who has them.",
            errno_text(error)};
  if (error == EACCES || error == EPERM)
    return {SensorFault::denied,
            "No permission to use lines " + list + " of GPIO chip " + chip + ": let a udev rule allow it.",
            errno_text(error)};
  return {SensorFault::gone,
          "GPIO chip " + chip + " does not give lines " + list + " (" + std::strerror(error) +
              "): perhaps it has no interrupts, or no such bias.",
          errno_text(error)};
}

SensorError chip_gone(const std::string& chip, int error) {
  return {SensorFault::gone,
          "GPIO chip " + chip + " does not answer any more (" + std::strerror(error) + "): was it unplugged?",
          errno_text(error)};
}

}  // namespace cerberus::drivers
