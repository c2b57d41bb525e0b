// SPDX-License-Identifier: LGPL-2.1-or-later
// Preloaded into cerberus-head: makes the kernel's test camera vivid, which has no controls for pan, tilt and zoom, a
// camera that has a pan and a zoom. Only the numbers of two controls are changed on their way: ranges, values, errors and
// the end of the device are the kernel's. (A module with controls of its own would need the tree of the very kernel that
// runs, and the kernel of the tests has no CUSE.)
#include <dlfcn.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <cstdarg>
#include <cstdint>

namespace {

// drivers/media/test-drivers/vivid/vivid-ctrls.c: "Integer 32 Bits", all 32-bit values in steps of 1.
constexpr std::uint32_t kInteger = (V4L2_CID_USER_BASE | 0xf000) + 2;

void rename(std::uint32_t& control) {
  if (control == V4L2_CID_PAN_ABSOLUTE)
    control = kInteger;
  else if (control == V4L2_CID_ZOOM_ABSOLUTE)
    control = V4L2_CID_BRIGHTNESS;  // 0 to 255
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* argument = va_arg(more, void*);
  va_end(more);
  using Ioctl = int (*)(int, unsigned long, ...);
  static const auto next = reinterpret_cast<Ioctl>(::dlsym(RTLD_NEXT, "ioctl"));
  if (request == VIDIOC_QUERYCTRL) rename(static_cast<v4l2_queryctrl*>(argument)->id);
  if (request == VIDIOC_G_CTRL || request == VIDIOC_S_CTRL) rename(static_cast<v4l2_control*>(argument)->id);
  return next(fd, request, argument);
}
