// SPDX-License-Identifier: LGPL-2.1-or-later
// The context of the frame that an analysing element works on, besides its metas.
#pragma once

#include <gst/video/video.h>

#include "shared/camera_mount.hpp"
#include "vision/detector.h"

namespace cerberus::plugin {

using Motion = vision::CameraStep;

struct Frame : vision::DetectorFrame {
  GstBuffer* buffer = nullptr;  // writable: metas may be added; its memory may be shared and is only read
  const GstVideoInfo* info = nullptr;
  GstClockTime running_time = GST_CLOCK_TIME_NONE;
  GstClockTime previous = GST_CLOCK_TIME_NONE;  // running time of the previous frame
  bool repeatable = false;                      // its picture may be the last one again
  bool live = false;                            // the source is: frames come by the clock
  guint wanted = 0;                             // of the record, by elements downstream: see record.hpp

  // Takes the look and the field of view from the pose on the buffer, if there is one.
  void read_pose() {
    const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
    if (!pose) return;
    if (const auto direction = look_of(*pose, running_time)) look = {direction->pan, direction->tilt};
    field_of_view = field_of_view_of(*pose);
  }
};

}  // namespace cerberus::plugin
