// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/servo/pwm_channel.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <thread>

#include "drivers/transport/exclusive.h"

namespace cerberus::drivers {
namespace {

// A number and a line feed, in one write as sysfs wants it.
int write_number(int fd, long long number) noexcept {
  std::array<char, 24> text;
  char* end = std::to_chars(text.data(), text.data() + text.size() - 1, number).ptr;
  *end++ = '\n';
  const ssize_t length = end - text.data();
  return ::pwrite(fd, text.data(), static_cast<std::size_t>(length), 0) == length ? 0 : errno ? errno : EIO;
}

int write_file(const std::string& path, long long number) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return errno;
  const int error = write_number(fd, number);
  ::close(fd);
  return error;
}

}  // namespace

int PwmChannel::open(const std::string& chip, int channel, Time period, std::chrono::milliseconds patience,
                     std::string& step) {
  close();
  const std::string folder = chip + "/pwm" + std::to_string(channel);
  if (::access(folder.c_str(), F_OK) != 0) {
    step = chip + "/export";
    if (const int error = write_file(step, channel)) return error;
  }
  step = folder + "/duty_cycle";
  constexpr std::chrono::milliseconds kPause{20};
  duty_ = ::open(step.c_str(), O_WRONLY | O_CLOEXEC);
  for (auto waited = kPause; waited <= patience && duty_ < 0; waited += kPause) {
    std::this_thread::sleep_for(kPause);
    duty_ = ::open(step.c_str(), O_WRONLY | O_CLOEXEC);
  }
  if (duty_ < 0) return errno;
  if (lock_device(duty_) != 0) {
    close();
    return EALREADY;
  }
  int error = write_number(duty_, 0);  // a pulse longer than the new period would be refused
  if (error == 0) {
    step = folder + "/period";
    error = write_file(step, period.count());
  }
  if (error == 0) {
    step = folder + "/enable";
    enable_ = ::open(step.c_str(), O_WRONLY | O_CLOEXEC);
    if (enable_ < 0) error = errno;
  }
  if (error != 0) close();
  duty_path_ = folder + "/duty_cycle";
  return error;
}

void PwmChannel::close() noexcept {
  if (duty_ >= 0) ::close(duty_);
  if (enable_ >= 0) ::close(enable_);
  duty_ = enable_ = -1;
}

int PwmChannel::set_width(Time width) noexcept {
  return duty_ < 0 ? ENODEV : write_number(duty_, width.count());
}

int PwmChannel::enable(bool on) noexcept {
  return enable_ < 0 ? ENODEV : write_number(enable_, on ? 1 : 0);
}

int PwmChannel::probe() const noexcept {
  struct stat opened{}, named{};
  if (duty_ < 0 || ::fstat(duty_, &opened) != 0 || ::stat(duty_path_.c_str(), &named) != 0) return ENODEV;
  // A chip that was unplugged and is back has other files than those that are open.
  return opened.st_ino == named.st_ino && opened.st_dev == named.st_dev ? 0 : ENODEV;
}

}  // namespace cerberus::drivers
