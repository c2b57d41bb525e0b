// SPDX-License-Identifier: LGPL-2.1-or-later
// Evidence that a body is a person: it is found frame after frame at the place where it is expected, its head is seen, and
// it walks. A body that explains noise is there once, and the place that a person has left, which has the person's outline,
// does not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/preallocate.h"

namespace cerberus::vision {

class WalkingBodies {
 public:
  // Lengths in heights of the body. Guard: tests/unit (walking_bodies, places, steady), bench-in_window, bench-steady.
  struct Parameters {
    // By which the foot moves from frame to frame, at most. x derived: a runner (2.5 heights a second) at 10 frames a
    // second. measured: with .5 a body goes on at the place that a walker left (unit steady).
    double step_x = 0.25, step_y = 0.3;
    // Of the larger height that the smaller one has, at least, from frame to frame. derived: two steps of the heights that
    // PeopleFinder tries.
    double same_height = 0.8;
    int least_frames = 3;  // before a distance counts. As a walker's
    // Distance that is one more sample of its height: what stands teaches nothing. measured: MOTA on TUD-Stadtmitte is .017,
    // .006 with .06 and .004 with .1, that on PETS09-S2L1 .731, .731 and .727; with a sample every frame a
    // clock over the picture costs 1.1 % of the recall.
    double stride = 0.08;
  };
  static constexpr std::size_t kMost = 20;  // bodies a frame

  struct Walk {
    double farthest = 0;   // distance that it has been from its first place, in heights
    bool goes_on = false;  // Is it a stride away from where it last went on?
  };

  WalkingBodies() = default;
  explicit WalkingBodies(const Parameters& parameters) : parameters_(parameters) {}

  void preallocate();
  void reset();
  // Called once a frame, before add(). motion: frame k-1 to k, pixels.
  void advance(const Transform& motion);
  // Records a body of this frame, pixels. Returns its walk; none before its least_frames-th frame in a row. stirs: it differs
  // from the frame before. What rests goes nowhere in this frame, wherever it is found, and keeps its walk.
  Walk add(const Box& body, bool stirs = true);
  std::size_t bytes() const;

 private:
  struct Place {  // pixels of the present frame
    float x, y;
  };
  struct Body {
    Place foot, first, last;  // last: where it last went on
    float height, farthest;
    int frames;
  };
  static double distance(const Place& a, const Place& b) { return std::hypot(a.x - b.x, a.y - b.y); }

  Parameters parameters_;
  std::vector<Body> now_, before_;
};

inline void WalkingBodies::preallocate() {
  vision::preallocate(now_, kMost);
  vision::preallocate(before_, kMost);
}

inline void WalkingBodies::reset() {
  now_.clear();
  before_.clear();
}

inline void WalkingBodies::advance(const Transform& motion) {
  std::swap(now_, before_);
  now_.clear();
  for (Body& body : before_)
    for (Place* place : {&body.foot, &body.first, &body.last}) {
      const Point moved = motion.apply({place->x, place->y});
      *place = {static_cast<float>(moved.x), static_cast<float>(moved.y)};
    }
}

inline WalkingBodies::Walk WalkingBodies::add(const Box& box, bool stirs) {
  const Parameters& q = parameters_;
  if (now_.size() == kMost) return {};
  const double h = box.height;
  const Place foot{static_cast<float>(box.x + box.width / 2), static_cast<float>(box.bottom())};
  Body body{foot, foot, foot, static_cast<float>(h), 0, 1};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Body& b : before_) {
    const double away = distance(b.foot, foot);
    if (!(away < nearest) || std::abs(b.foot.x - foot.x) > q.step_x * h ||
        std::abs(b.foot.y - foot.y) > q.step_y * h ||
        std::min<double>(h, b.height) < q.same_height * std::max<double>(h, b.height))
      continue;
    nearest = away;
    body = {foot, b.first, b.last, static_cast<float>(h), b.farthest, b.frames + 1};
  }
  Walk walk;
  if (body.frames >= q.least_frames) walk.farthest = body.farthest;
  if (body.frames >= q.least_frames && stirs) {
    walk.farthest = std::max<double>(body.farthest, distance(foot, body.first) / h);
    walk.goes_on = distance(foot, body.last) > q.stride * h;
    body.farthest = static_cast<float>(walk.farthest);
    if (walk.goes_on) body.last = foot;
  }
  now_.push_back(body);
  return walk;
}

inline std::size_t WalkingBodies::bytes() const {
  return bytes_of(now_) + bytes_of(before_);
}

}  // namespace cerberus::vision
