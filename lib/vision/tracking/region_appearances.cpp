// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/region_appearances.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
namespace {

// Pixels that are looked at: of a region, and of each of the places in a group.
constexpr int kSamples = 500, kRoughSamples = 120;
constexpr double kFamiliar =
    0.35;  // what looks as much appearance_distance somebody, and is as far from his place, is not he
constexpr double kReach = 0.5;     // S: as far to the side somebody is looked for;
constexpr double kReachUp = 0.05;  // up and down a look tells little: coats and legs are of one colour each
constexpr int kMostColumns = 24;   // to either side
constexpr double kFar = 0.05;      // what the farthest place costs

}  // namespace

AppearanceModel RegionAppearances::appearance_of(const Sight& sight, const Box& box, int samples) const {
  const double sx = static_cast<double>(sight.luma.width) / frame_.width;
  const double sy = static_cast<double>(sight.luma.height) / frame_.height;
  return vision::appearance_of(sight, level_, {box.x * sx, box.y * sy, box.width * sx, box.height * sy},
                               samples);
}

AppearanceModel RegionAppearances::place(const Box& box) const {
  return sight_.known() ? appearance_of({sight_.luma, {}}, box, kRoughSamples) : AppearanceModel{};
}

void RegionAppearances::update(const Sight& sight, std::span<const Region> regions, const Transform& motion,
                               Size frame) {
  sight_ = sight;
  frame_ = frame;
  looks_.assign(regions.size(), {});
  if (!sight_.known() || frame.area() <= 0) {
    level_.skip();
    return;
  }
  level_.update(sight_.luma, motion.rescaled(frame, sight_.luma.size()));
  for (std::size_t j = 0; j < regions.size(); ++j)
    looks_[j] = appearance_of(sight_, regions[j].box, kSamples);
}

void RegionAppearances::look_again(std::size_t region, const Box& box) {
  if (sight_.known()) looks_[region] = appearance_of(sight_, box, kSamples);
}

std::optional<Point> RegionAppearances::find(const TrackHypothesis& body, const Box& region) const {
  if (!sight_.known() || !body.well_known()) return std::nullopt;
  const Box box = body.box();
  const double s = body.size(), reach_up = kReachUp * s;
  const double reach = std::min(kReach * s, 2 * std::sqrt(body.x.pp) + 0.1 * s);
  const double pixel = static_cast<double>(frame_.width) / sight_.luma.width;
  const double step = std::max(box.width / 6, pixel), step_up = std::max(reach_up, pixel);
  const int columns = std::min(static_cast<int>(reach / step), kMostColumns),
            rows = static_cast<int>(reach_up / step_up);
  std::optional<Point> found;
  double least = kFamiliar;
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) {
      const Box there{box.x + i * step, box.y + j * step_up, box.width, box.height};
      if (overlap_area(there, region) < 0.8 * there.area()) continue;
      const double difference = appearance_distance(body.look, appearance_of(sight_, there, kRoughSamples));
      if (difference < 0) continue;
      const double x = i * step / reach, y = j * step_up / reach_up;
      const double cost = difference + kFar * (x * x + 2 * y * y);
      if (cost >= least) continue;
      least = cost;
      found = Point{i * step, j * step_up};
    }
  return found;
}

}  // namespace cerberus::vision
