// SPDX-License-Identifier: LGPL-2.1-or-later
// Sleeps until a device is readable or a time has passed; unlocking the source ends the sleep.
#pragma once

#include <gst/gst.h>

#include <cerrno>

namespace cerberus::plugin {

class DeviceWait {
 public:
  DeviceWait() : poll_(gst_poll_new(TRUE)) { gst_poll_fd_init(&device_); }
  ~DeviceWait() { gst_poll_free(poll_); }
  DeviceWait(const DeviceWait&) = delete;
  DeviceWait& operator=(const DeviceWait&) = delete;

  // Sets the device's descriptor, which may change; -1: none. Must not be called during sleep().
  void watch(int fd) {
    if (fd == device_.fd) return;
    if (device_.fd >= 0) gst_poll_remove_fd(poll_, &device_);
    gst_poll_fd_init(&device_);
    device_.fd = fd;
    if (fd < 0) return;
    gst_poll_add_fd(poll_, &device_);
    gst_poll_fd_ctl_read(poll_, &device_, TRUE);
  }
  // GST_CLOCK_TIME_NONE: for ever. False: flushing.
  bool sleep(GstClockTime most) { return gst_poll_wait(poll_, most) >= 0 || errno != EBUSY; }
  // From any thread.
  void set_flushing(bool flushing) { gst_poll_set_flushing(poll_, flushing); }
  void wake() { gst_poll_restart(poll_); }

 private:
  GstPoll* poll_;
  GstPollFD device_;
};

}  // namespace cerberus::plugin
