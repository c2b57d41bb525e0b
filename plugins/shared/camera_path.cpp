// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera_path.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

namespace cerberus::plugin {
namespace {

using vision::Transform;

Transform transform(const gdouble (&matrix)[9]) {
  Transform result;
  std::copy(std::begin(matrix), std::end(matrix), result.m.begin());
  return result;
}

constexpr double kRounding = 0.01;  // px

// How far apart the two send the frame's corners, px in all.
double difference(const Transform& a, const Transform& b, vision::Size frame) {
  double sum = 0;
  for (const double x : {0.0, static_cast<double>(frame.width)})
    for (const double y : {0.0, static_cast<double>(frame.height)}) {
      const vision::Point p = a.apply({x, y}), q = b.apply({x, y});
      sum += std::hypot(p.x - q.x, p.y - q.y);
    }
  return sum;
}

// No two paths of a process have the same number: a selector may change from one camera's stream to another's.
guint new_path() {
  static std::atomic<guint> last = 0;
  guint id = 0;
  while (id == 0) id = ++last;
  return id;
}

}  // namespace

void CameraPath::extend(CerberusCameraMotion& motion, vision::Size frame) {
  const Transform step = transform(motion.matrix), before = path_;
  if (!motion.still) path_ = step * path_;  // times identity would round, for some matrices
  // Where rounding has eaten what two points of the path should tell, a new one begins.
  if (motion.scene_age == 1 || !(difference(path_ * before.inverse(), step, frame) < kRounding)) {
    path_ = {};
    id_ = new_path();
  }
  std::copy(path_.m.begin(), path_.m.end(), std::begin(motion.path));
  motion.path_id = id_;
}

CameraFollower::Step CameraFollower::next(const CerberusCameraMotion* motion, GstClockTime previous,
                                          vision::Size frame) {
  // Where the camera was measured until now, we do not know where it went.
  if (!motion) return {std::exchange(last_, std::nullopt) ? Link::lost : Link::unmeasured, {}, {}};
  const guint age = last_ ? last_->scene_age : 0;
  const guint path = last_ ? last_->path_id : 0;
  const Transform then = last_ ? transform(last_->path) : Transform{};
  last_ = *motion;
  if (motion->scene_age == 1) return {Link::cut, {}, {}};
  const bool any_paths = path != 0 && motion->path_id != 0;
  const bool connected = any_paths && motion->path_id == path;
  const bool next = motion->from == previous && (motion->scene_age == 0 || motion->scene_age == age + 1);
  if (!connected && (any_paths || !next)) return {Link::lost, {}, {}};
  Motion step{transform(motion->matrix), motion->still != FALSE};
  if (!next) {
    const Transform now = transform(motion->path);
    step = now.m == then.m ? Motion{} : Motion{now * then.inverse(), false};
  }
  // A stranger's numbers may be anything.
  if (!step.transform.is_sane(frame)) return {Link::lost, {}, {}};
  return {Link::follows, step, connected};
}

}  // namespace cerberus::plugin
