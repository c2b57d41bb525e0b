// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/scene_calm.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// Guard: tests/unit/scene_calm; bench-development prints the shares.
constexpr struct Parameters {
  int least =
      8;  // corners: fewer say nothing of a scene. derived: as many as determine a motion (PatchMatches)
  double memory =
      1;  // s, time constant. derived: two strides of a walker, or a swing of a hand that holds a camera
} kParameters;

bool touches(Point corner, double reach, std::span<const Box> boxes) {
  return std::ranges::any_of(boxes, [&](const Box& b) {
    return corner.x > b.x - reach && corner.x < b.right() + reach && corner.y > b.y - reach &&
           corner.y < b.bottom() + reach;
  });
}

}  // namespace

void SceneCalm::add(const SceneCorners& corners, const Transform& motion, std::span<const Box> objects,
                    Size frame, double seconds) {
  if (motion.corner_motion(frame) * 320 <= kBearable * frame.width) return follow(1, seconds);
  int count = 0, fitting = 0;
  for (const SceneCorners::Corner& c :
       std::span(corners.corner).first(static_cast<std::size_t>(corners.count))) {
    const Point place{c.x * frame.width / 256.0, c.y * frame.height / 256.0};
    if (touches(place, corners.reach * frame.width, objects)) continue;
    ++count;
    fitting += c.fits;
  }
  if (count >= kParameters.least) follow(static_cast<double>(fitting) / count, seconds);
}

void SceneCalm::follow(double share, double seconds) {
  if (seconds > 0 && std::isfinite(seconds)) step_ = seconds;
  share_ += std::min(1.0, step_ / kParameters.memory) * (share - share_);
}

}  // namespace cerberus::vision
