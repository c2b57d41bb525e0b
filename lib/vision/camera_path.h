// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the camera went since the last frame seen at a place, however many frames were dropped in between: the element
// that measures the camera sums up its measurements (CameraPath), and two points of one path give the motion from one to
// the other (CameraFollower). Where there is a path no timestamps are needed: an element that drops frames may have
// written them anew. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "vision/detector.h"

namespace cerberus::vision {

// One measurement, and its point of the path.
struct CameraPathPoint {
  Transform step;                          // since the previous frame, frame pixels
  bool still = true;                       // step is the identity
  std::uint64_t from = ~std::uint64_t{0};  // running time of the previous frame, ns; compared only
  unsigned scene_age = 0;                  // frames of this scene; 1: the first one, 0: not known
  unsigned path_id = 0;                    // 0: no path
  Transform path;                          // since the path began
};

// Of the element that measures.
class CameraPath {
 public:
  // Writes path and path_id; the rest of `point` is known.
  void extend(CameraPathPoint& point, Size frame);

 private:
  Transform path_;
  unsigned id_ = 0;
};

// Of the others.
class CameraFollower {
 public:
  enum class Link {
    unmeasured,  // nothing upstream measures the camera: it stands still
    follows,     // the motion since the last frame is known
    cut,         // the measurement itself began a scene
    lost         // the motion is not known
  };
  struct Step {
    Link link = Link::unmeasured;
    CameraStep motion;
    bool connected = false;  // by its path, whatever timestamps and marks of a break say
  };

  void forget() { last_.reset(); }
  // point: of the frame; nothing: it has none. previous: running time of the last frame seen here, ns.
  Step next(const std::optional<CameraPathPoint>& point, std::uint64_t previous, Size frame);

 private:
  std::optional<CameraPathPoint> last_;  // of the last frame
};

}  // namespace cerberus::vision
