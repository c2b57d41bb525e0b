// SPDX-License-Identifier: LGPL-2.1-or-later
// The trails of objects, which stay on the scene while the camera turns: every past point moves with the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"

namespace cerberus::overlay {

struct TrailPoint {
  vision::Point position;  // pixels of the newest frame
  double time = 0;         // s
};

struct TrailMark {
  std::uint32_t id = 0;
  vision::Point position;
};

class Trails {
 public:
  struct Trail {
    std::uint32_t id = 0;
    std::vector<TrailPoint> points;  // oldest first
  };

  // Largest number of points of a trail: beyond it the oldest are dropped, whatever the duration.
  static constexpr std::size_t kMostPoints = 1024;
  // Largest number of trails: beyond it those with the oldest last point are dropped.
  static constexpr std::size_t kMostTrails = 256;
  // A point this many picture widths away (errors of camera transforms accumulate) is dropped with all points before
  // it.
  static constexpr double kFarAway = 4;

  void reset() { trails_.clear(); }
  // time: s, of this frame; motion: frame k-1 to k in frame pixels; duration: s of history kept, at most.
  // Marks of this frame are appended to their trails; a trail without points is dropped.
  void update(double time, double duration, const vision::Transform& motion, vision::Size frame,
              std::span<const TrailMark> marks);
  std::span<const Trail> trails() const { return trails_; }

 private:
  std::vector<Trail> trails_;
};

}  // namespace cerberus::overlay
