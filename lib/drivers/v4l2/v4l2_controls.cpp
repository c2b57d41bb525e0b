// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/v4l2/v4l2_controls.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

namespace cerberus::drivers {
namespace {

static_assert(camera_control::kPanRelative == V4L2_CID_PAN_RELATIVE &&
              camera_control::kTiltRelative == V4L2_CID_TILT_RELATIVE &&
              camera_control::kPanAbsolute == V4L2_CID_PAN_ABSOLUTE &&
              camera_control::kTiltAbsolute == V4L2_CID_TILT_ABSOLUTE &&
              camera_control::kPanSpeed == V4L2_CID_PAN_SPEED &&
              camera_control::kTiltSpeed == V4L2_CID_TILT_SPEED);

int call(int fd, unsigned long request, void* argument) noexcept {
  if (fd < 0) return ENODEV;
  int result;
  do result = ::ioctl(fd, request, argument);
  while (result < 0 && errno == EINTR);
  return result < 0 ? errno : 0;
}

}  // namespace

int V4l2Controls::open(const std::string& device) {
  close();
  fd_ = ::open(device.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd_ < 0) return errno;
  const int error = probe();
  if (error != 0) close();
  return error;
}

int V4l2Controls::probe() noexcept {
  v4l2_capability about{};
  return call(fd_, VIDIOC_QUERYCAP, &about);
}

void V4l2Controls::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

std::optional<ControlRange> V4l2Controls::query(std::uint32_t control) {
  v4l2_queryctrl found{};
  found.id = control;
  if (call(fd_, VIDIOC_QUERYCTRL, &found) != 0 || (found.flags & V4L2_CTRL_FLAG_DISABLED))
    return std::nullopt;
  return ControlRange{found.minimum, found.maximum, found.step};
}

int V4l2Controls::get(std::uint32_t control, std::int32_t& value) noexcept {
  v4l2_control asked{control, 0};
  const int error = call(fd_, VIDIOC_G_CTRL, &asked);
  if (error == 0) value = asked.value;
  return error;
}

int V4l2Controls::set(std::uint32_t control, std::int32_t value) noexcept {
  v4l2_control wanted{control, value};
  return call(fd_, VIDIOC_S_CTRL, &wanted);
}

}  // namespace cerberus::drivers
