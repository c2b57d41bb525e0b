// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/camera_path.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr double kRounding = 0.01;  // px

// How far apart the two send the frame's corners, px in all.
double difference(const Transform& a, const Transform& b, Size frame) {
  double sum = 0;
  for (const double x : {0.0, static_cast<double>(frame.width)})
    for (const double y : {0.0, static_cast<double>(frame.height)}) {
      const Point p = a.apply({x, y}), q = b.apply({x, y});
      sum += std::hypot(p.x - q.x, p.y - q.y);
    }
  return sum;
}

// No two paths of a process have the same number: a selector may change from one camera's stream to another's.
unsigned new_path() {
  static std::atomic<unsigned> last = 0;
  unsigned id = 0;
  while (id == 0) id = ++last;
  return id;
}

}  // namespace

void CameraPath::extend(CameraPathPoint& point, Size frame) {
  const Transform before = path_;
  if (!point.still) path_ = point.step * path_;  // times identity would round, for some matrices
  // A new path begins where two points of this one no longer give their step, because of rounding.
  if (point.scene_age == 1 || !(difference(path_ * before.inverse(), point.step, frame) < kRounding)) {
    path_ = {};
    id_ = new_path();
  }
  point.path = path_;
  point.path_id = id_;
}

CameraFollower::Step CameraFollower::next(const std::optional<CameraPathPoint>& point, std::uint64_t previous,
                                          Size frame) {
  // If the camera was measured until now, its motion is not known.
  if (!point) return {std::exchange(last_, std::nullopt) ? Link::lost : Link::unmeasured, {}, {}};
  const CameraPathPoint then = std::exchange(last_, point).value_or(CameraPathPoint{});
  if (point->scene_age == 1) return {Link::cut, {}, {}};
  const bool any_paths = then.path_id != 0 && point->path_id != 0;
  const bool connected = any_paths && point->path_id == then.path_id;
  const bool next =
      point->from == previous && (point->scene_age == 0 || point->scene_age == then.scene_age + 1);
  if (!connected && (any_paths || !next)) return {Link::lost, {}, {}};
  CameraStep step{point->step, point->still};
  if (!next)
    step = point->path.m == then.path.m ? CameraStep{} : CameraStep{point->path * then.path.inverse(), false};
  // A measurement of another element is not trusted.
  if (!step.transform.is_sane(frame)) return {Link::lost, {}, {}};
  return {Link::follows, step, connected};
}

}  // namespace cerberus::vision
