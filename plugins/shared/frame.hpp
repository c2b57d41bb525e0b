// SPDX-License-Identifier: LGPL-2.1-or-later
// What a stage knows of the frame it works on, besides its metas.
#pragma once

#include <gst/video/video.h>

#include <optional>

#include "control/base_rate.h"
#include "vision/geometry/transform.h"

namespace cerberus::plugin {

// The camera's own motion from the previous frame to this one, in frame pixels. Without `cameramotion` upstream
// the camera stands still.
struct Motion {
  vision::Transform transform;
  bool still = true;

  // The same in analysis pixels. Standing still stays exactly the identity, whatever the rounding.
  vision::Transform in(vision::Size analysis, vision::Size frame) const {
    return still ? vision::Transform{} : transform.rescaled(frame, analysis);
  }
};

struct Frame {
  GstBuffer* buffer = nullptr;  // writable: metas may be added; its memory may be shared and is only read
  const GstVideoInfo* info = nullptr;
  GstClockTime running_time = GST_CLOCK_TIME_NONE;
  double seconds = 0;                           // since the previous frame; 0: none, or not known
  GstClockTime previous = GST_CLOCK_TIME_NONE;  // running time of the previous frame
  guint64 number = 0;                           // counts analysed frames without holes
  bool fresh = true;                            // first frame of a scene
  Motion motion;
  std::optional<motion::PanTilt> look;  // of the head when the frame was taken, where a pose tells
  bool planes_wanted = false;           // somebody downstream reads the stages' planes
  bool previous_wanted = false;         // or makes something of the differences for which D(k-1) is needed
  bool sight_wanted = false;            // motiontrack does: picture and mask, and takes them off the frame

  vision::Size size() const { return {GST_VIDEO_INFO_WIDTH(info), GST_VIDEO_INFO_HEIGHT(info)}; }
};

// Notices whether a stage sees every frame: one that was idle (its product came from upstream) has an old past.
class Sequence {
 public:
  // True when `frame` does not follow the last one seen.
  bool broken_by(const Frame& frame) {
    const bool broken = frame.fresh || frame.number != next_;
    next_ = frame.number + 1;
    return broken;
  }

 private:
  guint64 next_ = 0;
};

}  // namespace cerberus::plugin
