// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/trails.h"

#include <algorithm>
#include <cmath>

namespace cerberus::overlay {

namespace {

bool near_picture(vision::Point p, vision::Size frame) {
  const double reach = Trails::kFarAway * std::max(frame.width, frame.height);
  return std::isfinite(p.x) && std::isfinite(p.y) && std::abs(p.x) <= reach && std::abs(p.y) <= reach;
}

}  // namespace

void Trails::update(double time, double duration, const vision::Transform& motion, vision::Size frame,
                    std::span<const TrailMark> marks) {
  const bool moved = !motion.is_identity();
  for (Trail& trail : trails_) {
    auto& points = trail.points;
    if (moved)
      for (TrailPoint& p : points) p.position = motion.apply(p.position);
    // Only the points after the last one that is too old or too far are kept.
    const auto bad = std::find_if(points.rbegin(), points.rend(), [&](const TrailPoint& p) {
      return p.time < time - duration || !near_picture(p.position, frame);
    });
    points.erase(points.begin(), bad.base());
  }
  for (const TrailMark& mark : marks) {
    if (!near_picture(mark.position, frame)) continue;
    auto trail =
        std::find_if(trails_.begin(), trails_.end(), [&](const Trail& t) { return t.id == mark.id; });
    if (trail == trails_.end()) trail = trails_.insert(trails_.end(), Trail{mark.id, {}});
    if (trail->points.size() >= kMostPoints) trail->points.erase(trail->points.begin());
    trail->points.push_back({mark.position, time});
  }
  std::erase_if(trails_, [](const Trail& t) { return t.points.empty(); });
  while (trails_.size() > kMostTrails)
    trails_.erase(std::min_element(trails_.begin(), trails_.end(), [](const Trail& a, const Trail& b) {
      return a.points.back().time < b.points.back().time;
    }));
}

}  // namespace cerberus::overlay
