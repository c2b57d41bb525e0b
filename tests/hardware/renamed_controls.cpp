// SPDX-License-Identifier: LGPL-2.1-or-later
// Preloaded into cerberus-head: makes the kernel's test camera vivid, which has no controls for pan, tilt and zoom, a
// camera that has them. Only the numbers of controls are changed on their way, and the unit of tilt: ranges, errors and the
// end of the device are the kernel's. (A module with controls of its own would need the tree of the very kernel that runs,
// and the kernel of the tests has no CUSE.) CERBERUS_CAMERA=speeds: the camera has no angles, as one that reports no
// position.
#include <dlfcn.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#include "renamed_controls.h"

namespace {

using namespace simulated;

void rename(std::uint32_t& control) {
  static const char* const camera = std::getenv("CERBERUS_CAMERA");
  static const bool angles = !camera || std::strcmp(camera, "speeds") != 0;
  if (control == V4L2_CID_PAN_ABSOLUTE && angles) control = kPan;
  if (control == V4L2_CID_TILT_ABSOLUTE && angles) control = kTilt;
  if (control == V4L2_CID_PAN_SPEED) control = kPanSpeed;
  if (control == V4L2_CID_ZOOM_ABSOLUTE) control = kZoom;
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* argument = va_arg(more, void*);
  va_end(more);
  using Ioctl = int (*)(int, unsigned long, ...);
  static const auto next = reinterpret_cast<Ioctl>(::dlsym(RTLD_NEXT, "ioctl"));
  if (request == VIDIOC_QUERYCTRL) {
    auto& range = *static_cast<v4l2_queryctrl*>(argument);
    const bool tilt = range.id == V4L2_CID_TILT_ABSOLUTE;
    rename(range.id);
    const int result = next(fd, request, argument);
    if (!tilt || range.id != kTilt) return result;
    for (std::int32_t* angle : {&range.minimum, &range.maximum, &range.default_value})
      *angle = tilt_of(*angle);
    range.step = kDegree;
    return result;
  }
  if (request != VIDIOC_G_CTRL && request != VIDIOC_S_CTRL) return next(fd, request, argument);
  auto& control = *static_cast<v4l2_control*>(argument);
  const bool tilt = control.id == V4L2_CID_TILT_ABSOLUTE;
  rename(control.id);
  const bool in_degrees = tilt && control.id == kTilt;
  if (in_degrees && request == VIDIOC_S_CTRL) control.value = control.value / kDegree + kMiddle;
  const int result = next(fd, request, argument);
  if (in_degrees) control.value = tilt_of(control.value);
  return result;
}
