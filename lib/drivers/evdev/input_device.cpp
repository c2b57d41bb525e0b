// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/evdev/input_device.h"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <filesystem>

namespace cerberus::drivers {

namespace {

using Bits = std::array<unsigned char, KEY_CNT / 8 + 1>;

bool is_set(const Bits& bits, unsigned bit) {
  return bits[bit / 8] >> bit % 8 & 1;
}

}  // namespace

int InputDevice::open(const std::string& path) {
  close();
  fd_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return errno;
  int clock = CLOCK_MONOTONIC, version = 0;
  if (::ioctl(fd_, EVIOCGVERSION, &version) == 0 && ::ioctl(fd_, EVIOCSCLOCKID, &clock) == 0) return 0;
  const int error = errno;
  close();
  return error;
}

void InputDevice::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

std::string InputDevice::name() const {
  std::array<char, 256> name{};
  return ::ioctl(fd_, EVIOCGNAME(name.size() - 1), name.data()) < 0 ? std::string() : name.data();
}

std::vector<InputCode> InputDevice::codes() const {
  std::vector<InputCode> codes;
  for (const auto& [type, count] : {std::pair{EV_KEY, KEY_CNT}, std::pair{EV_SW, SW_CNT}}) {
    Bits bits{};
    if (::ioctl(fd_, EVIOCGBIT(type, bits.size()), bits.data()) < 0) continue;
    for (int code = 0; code < count; ++code)
      if (is_set(bits, static_cast<unsigned>(code)))
        codes.push_back({static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(code)});
  }
  return codes;
}

int InputDevice::levels(const std::vector<InputCode>& codes, std::vector<bool>& levels) const {
  Bits keys{}, switches{};
  if (::ioctl(fd_, EVIOCGKEY(keys.size()), keys.data()) < 0) return errno;
  if (::ioctl(fd_, EVIOCGSW(switches.size()), switches.data()) < 0) return errno;
  levels.clear();
  for (const InputCode& code : codes)
    levels.push_back(is_set(code.type == EV_SW ? switches : keys, code.code));
  return 0;
}

int InputDevice::read(std::vector<InputEvent>& events) {
  std::array<input_event, 64> piece;
  const ssize_t got = ::read(fd_, piece.data(), sizeof piece);
  if (got < 0) return errno == EAGAIN || errno == EINTR ? 0 : errno;
  for (std::size_t i = 0; i < static_cast<std::size_t>(got) / sizeof(input_event); ++i) {
    const input_event& event = piece[i];
    const Time time =
        std::chrono::seconds(event.input_event_sec) + std::chrono::microseconds(event.input_event_usec);
    events.push_back({time, {event.type, event.code}, event.value});
  }
  return 0;
}

std::vector<std::string> input_devices() {
  constexpr std::string_view kPrefix = "event";
  std::vector<std::string> paths;
  std::error_code ignored;
  for (std::filesystem::directory_iterator it("/dev/input", ignored), end; !ignored && it != end;
       it.increment(ignored))
    if (it->path().filename().string().starts_with(kPrefix)) paths.push_back(it->path().string());
  // event2 before event10
  std::ranges::sort(paths, [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

}  // namespace cerberus::drivers
