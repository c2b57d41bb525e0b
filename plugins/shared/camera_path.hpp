// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's motion since the last frame that reached this element, whatever number of frames was dropped in between:
// `cameramotion` accumulates its measurements (CameraPath), and the other elements compute the motion between two
// points of one path (CameraFollower). A path needs no time stamps, which an element that drops frames may have
// rewritten.
#pragma once

#include <cerberus/cerberus.h>

#include <optional>

#include "frame.hpp"

namespace cerberus::plugin {

// The path as written by the measuring element.
class CameraPath {
 public:
  // Writes path and path_id; the other fields of `motion` are set already.
  void extend(CerberusCameraMotion& motion, vision::Size frame);

 private:
  vision::Transform path_;
  guint id_ = 0;
};

// The path as read by the other elements.
class CameraFollower {
 public:
  enum class Link {
    unmeasured,  // no element upstream measures the camera: it is assumed to stand
    follows,     // the motion since the last frame is known
    cut,         // cameramotion itself began a scene
    lost         // the motion since the last frame is unknown
  };
  struct Step {
    Link link = Link::unmeasured;
    Motion motion;
    bool connected = false;  // by its path, whatever times and DISCONT marks indicate
  };

  void forget() { last_.reset(); }
  // motion: of the frame, nullptr = none. previous: running time of the last frame seen here.
  Step next(const CerberusCameraMotion* motion, GstClockTime previous, vision::Size frame);

 private:
  std::optional<CerberusCameraMotion> last_;  // of the last frame; none: it had none
};

}  // namespace cerberus::plugin
