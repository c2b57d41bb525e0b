// SPDX-License-Identifier: LGPL-2.1-or-later
// How calm a scene is: the share of its corners that the camera's motion explains. Where depth (parallax), blur or a shaken
// lens move many of them otherwise, registration leaves edges over, and moving regions are not to be trusted.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "vision/ego_motion/motion_fit.h"
#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Pixels of a picture 320 wide that a registered difference bears: a corner as near fits.
constexpr double kBearable = 0.5;

// The corners of one frame whose place in the next one is sure. Not only those from which the motion was estimated.
struct SceneCorners {
  struct Corner {
    std::uint8_t x, y;  // in the earlier frame, 256ths of the picture's sides
    bool fits;          // the motion explains its place to kBearable
  };
  float reach = 0;  // of the picture's width: half the side of what is seen of a corner
  int count = 0;
  std::array<Corner, MotionSamples::kMax> corner;
};

class SceneCalm {
 public:
  // The next frame begins a scene.
  void reset() { *this = {}; }
  // motion: of the camera since the earlier frame, of this size in pixels. One that moves no corner of the picture by more than
  // kBearable counts as calm: noise may move the scene's corners, but nothing passes such a camera by. objects: the tracks'
  // boxes in the earlier frame; corners that they touch do not count. seconds: since that frame (<= 0: unknown, the last known
  // distance is used).
  void add(const SceneCorners& corners, const Transform& motion, std::span<const Box> objects, Size frame,
           double seconds);
  // Share of the corners outside the objects that fit, 0..1: running mean of about a second. A scene begins with 1, because
  // nothing speaks against it yet; frames with few such corners do not count.
  double share() const { return share_; }

 private:
  void follow(double share, double seconds);

  double share_ = 1;
  double step_ = 0.04;  // seconds between frames, until a distance is known
};

}  // namespace cerberus::vision
