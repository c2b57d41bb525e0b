// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/iio/iio_gyro.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/helper/option_words.h"

namespace cerberus::drivers {

namespace {

constexpr std::string_view kDevice = "iio:device", kChannel = "in_anglvel_";

// The text of an attribute without its line feed; errno in `error`.
std::optional<std::string> read_attribute(int fd, int& error) {
  std::array<char, 64> text;
  const ssize_t got = ::pread(fd, text.data(), text.size(), 0);
  if (got < 0) {
    error = errno;
    return std::nullopt;
  }
  std::string_view line(text.data(), static_cast<std::size_t>(got));
  return std::string(line.substr(0, line.find_first_of("\n ")));
}

std::optional<std::string> read_file(const std::string& path, int& error) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    error = errno;
    return std::nullopt;
  }
  auto text = read_attribute(fd, error);
  ::close(fd);
  return text;
}

// The axis's own attribute, else that of all axes, else `otherwise`.
double attribute(const std::string& folder, char axis, const std::string& which, double otherwise) {
  int ignored = 0;
  for (const std::string& name : {std::string(kChannel) + axis + "_" + which, std::string(kChannel) + which})
    if (const auto text = read_file(folder + "/" + name, ignored))
      if (const auto number = number_of(*text)) return *number;
  return otherwise;
}

std::vector<std::string> folders_in(const std::string& all) {
  std::vector<std::string> folders;
  std::error_code ignored;
  for (std::filesystem::directory_iterator it(all, ignored), end; !ignored && it != end;
       it.increment(ignored))
    if (it->path().filename().string().starts_with(kDevice)) folders.push_back(it->path().string());
  std::ranges::sort(folders);
  return folders;
}

}  // namespace

std::string parse_gyro(const std::string& text, GyroSetup& setup) {
  setup.device.clear();
  for (const OptionWord& word : option_words(text)) {
    std::string_view axis = word.value;
    if (word.key != "axis" && !word.has_value && setup.device.empty()) {
      setup.device = word.key;
      continue;
    }
    setup.down = axis.starts_with('-');
    if (setup.down) axis.remove_prefix(1);
    if (word.key != "axis" || (axis != "x" && axis != "y" && axis != "z"))
      return "\"" + text +
             "\" names no gyro: write its name or id, and which of its axes points up, as 'mpu6050 axis=-y'";
    setup.axis = axis[0];
  }
  return setup.device.empty() ? "\"" + text + "\" names no gyro" : "";
}

SensorError IioGyro::find(const GyroSetup& setup, std::string& folder) {
  if (setup.device.starts_with('/')) {
    folder = setup.device;
    return {};
  }
  std::string list;
  for (const std::string& path : folders_in(setup.folder)) {
    int ignored = 0;
    const std::string id = std::filesystem::path(path).filename().string();
    const std::string name = read_file(path + "/name", ignored).value_or("");
    if (id == setup.device || name == setup.device) {
      folder = path;
      return {};
    }
    list.append(list.empty() ? "" : ", ").append(id).append(" (").append(name).append(")");
  }
  return {SensorFault::not_found,
          "There is no IIO device \"" + setup.device + "\" for the base's gyro. " +
              (list.empty() ? "This machine has no IIO device." : "There are: " + list + "."),
          ""};
}

SensorError IioGyro::open(const GyroSetup& setup) {
  close();
  std::string folder;
  if (SensorError error = find(setup, folder)) return error;
  name_ = setup.device;
  const std::string path = folder + "/" + std::string(kChannel) + setup.axis + "_raw";
  raw_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (raw_ < 0 && errno == ENOENT)
    return {SensorFault::not_found,
            "IIO device \"" + setup.device + "\" is no gyro with an axis " + setup.axis + ": it has no " +
                path + ".",
            errno_text(ENOENT)};
  if (raw_ < 0) return gone(errno);
  const double scale = attribute(folder, setup.axis, "scale", 1);
  scale_ = setup.down ? scale : -scale;
  offset_ = attribute(folder, setup.axis, "offset", 0);
  double ignored = 0;
  return read(ignored);
}

void IioGyro::close() noexcept {
  if (raw_ >= 0) ::close(std::exchange(raw_, -1));
}

SensorError IioGyro::gone(int error) {
  close();
  if (error == EACCES || error == EPERM)
    return {SensorFault::denied, "No permission to read the gyro " + name_ + ": let a udev rule allow it.",
            errno_text(error)};
  return {SensorFault::gone, "The gyro " + name_ + " cannot be read (" + std::strerror(error) + ").",
          errno_text(error)};
}

SensorError IioGyro::read(double& rate) {
  if (raw_ < 0) return {SensorFault::gone, "The gyro is not open.", ""};
  int error = ENODATA;
  const auto text = read_attribute(raw_, error);
  const auto raw = text ? number_of(*text) : std::nullopt;
  if (!raw) return gone(error);
  rate = (*raw + offset_) * scale_;
  return {};
}

}  // namespace cerberus::drivers
