// SPDX-License-Identifier: LGPL-2.1-or-later
// Preloaded into cerberus-head: /dev/video-slow is a camera that turns at speeds and reports no position. Each speed that
// it is given is a line of the file CERBERUS_SLOW_CAMERA; while that file's name with ".wait" at its end exists, it keeps the
// caller waiting, as UVC cameras do.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

constexpr char kCamera[] = "/dev/video-slow";
int camera = -1;  // its descriptor

int open_camera() {
  camera = ::memfd_create(kCamera, MFD_CLOEXEC);
  return camera;
}

int refused(int error) {
  errno = error;
  return -1;
}

bool is_speed(std::uint32_t control) {
  return control == V4L2_CID_PAN_SPEED || control == V4L2_CID_TILT_SPEED;
}

int set(const v4l2_control& control) {
  if (!is_speed(control.id)) return refused(EINVAL);
  const std::string file = std::getenv("CERBERUS_SLOW_CAMERA");
  if (control.id == V4L2_CID_PAN_SPEED) {
    std::FILE* out = std::fopen(file.c_str(), "ae");
    std::fprintf(out, "%d\n", control.value);
    std::fclose(out);
  }
  while (::access((file + ".wait").c_str(), F_OK) == 0) ::usleep(10'000);
  return 0;
}

}  // namespace

// Of programs with 64 bits for the sizes of files, as all of Cerberus.
extern "C" int open(const char* path, int flags, ...) {
  if (std::strcmp(path, kCamera) == 0) return open_camera();
  va_list more;
  va_start(more, flags);
  const int mode = va_arg(more, int);
  va_end(more);
  return ::openat(AT_FDCWD, path, flags, mode);
}

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* argument = va_arg(more, void*);
  va_end(more);
  if (fd != camera || fd < 0) {
    using Ioctl = int (*)(int, unsigned long, ...);
    static const auto next = reinterpret_cast<Ioctl>(::dlsym(RTLD_NEXT, "ioctl"));
    return next(fd, request, argument);
  }
  if (request == VIDIOC_QUERYCAP) return 0;
  if (request == VIDIOC_S_CTRL) return set(*static_cast<v4l2_control*>(argument));
  if (request != VIDIOC_QUERYCTRL) return refused(ENOTTY);
  auto& range = *static_cast<v4l2_queryctrl*>(argument);
  if (!is_speed(range.id)) return refused(EINVAL);
  range.minimum = -60;
  range.maximum = 60;
  range.step = 1;
  range.flags = 0;
  return 0;
}
