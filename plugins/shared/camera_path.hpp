// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the camera went since the last frame seen here, however many frames were dropped on the way: `cameramotion`
// adds up what it measures (CameraPath), and two points of one path tell the rest of the corridor the way from one to
// the other (CameraFollower). Where there is a path no time stamps are needed: whoever drops frames may have written them
// anew.
#pragma once

#include <cerberus/cerberus.h>

#include <optional>

#include "frame.hpp"

namespace cerberus::plugin {

// Of the one who measures.
class CameraPath {
 public:
  // Writes path and path_id; the rest of `motion` is known.
  void extend(CerberusCameraMotion& motion, vision::Size frame);

 private:
  vision::Transform path_;
  guint id_ = 0;
};

// Of the others.
class CameraFollower {
 public:
  enum class Link {
    unmeasured,  // nobody upstream measures the camera: it stands still
    follows,     // the way from the last frame is known
    cut,         // cameramotion itself began a scene
    lost         // it is not
  };
  struct Step {
    Link link = Link::unmeasured;
    Motion motion;
    bool connected = false;  // by its path, whatever times and marks of a break say
  };

  void forget() { last_.reset(); }
  // motion: of the frame, nullptr = none. previous: running time of the last frame seen here.
  Step next(const CerberusCameraMotion* motion, GstClockTime previous, vision::Size frame);

 private:
  std::optional<CerberusCameraMotion> last_;  // of the last frame; none: it had none
};

}  // namespace cerberus::plugin
