// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/region_appearances.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

Box RegionAppearances::in_sight(const Box& box) const {
  const double sx = static_cast<double>(input_.luma.width) / frame_.width;
  const double sy = static_cast<double>(input_.luma.height) / frame_.height;
  return {box.x * sx, box.y * sy, box.width * sx, box.height * sy};
}

AppearanceModel RegionAppearances::appearance_of(const Sight& input, const Box& box, int samples) const {
  return vision::appearance_of(input, level_, in_sight(box), samples);
}

void RegionAppearances::update(const Sight& input, std::span<const Region> regions, const Transform& motion,
                               Size frame) {
  input_ = input;
  frame_ = frame;
  appearances_.assign(regions.size(), {});
  if (!input_.known() || frame.area() <= 0) {
    level_.skip();
    return;
  }
  level_.update(input_.luma, motion.rescaled(frame, input_.luma.size()));
  for (std::size_t j = 0; j < regions.size(); ++j)
    appearances_[j] = appearance_of(input_, regions[j].box, parameters_.samples);
}

void RegionAppearances::recompute(std::size_t region, const Box& box) {
  if (input_.known()) appearances_[region] = appearance_of(input_, box, parameters_.samples);
}

std::optional<Point> RegionAppearances::find(const TrackHypothesis& track, const Box& region) const {
  if (!input_.known() || !track.has_appearance()) return std::nullopt;
  const Parameters& q = parameters_;
  const Box box = track.box();
  const double s = track.size(), reach_up = track.parameters->position_noise * s;
  const double reach = std::min(q.reach * s, 2 * std::sqrt(track.x.pp) + track.parameters->found_noise * s);
  const double pixel = static_cast<double>(frame_.width) / input_.luma.width;
  const double step = std::max(box.width / q.steps, pixel), step_up = std::max(reach_up, pixel);
  const int columns = static_cast<int>(reach / step), rows = static_cast<int>(reach_up / step_up);
  std::optional<Point> found;
  double least = track.parameters->different;
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) {
      const Box there{box.x + i * step, box.y + j * step_up, box.width, box.height};
      if (overlap_area(there, region) < q.inside * there.area()) continue;
      const double difference =
          appearance_distance(track.appearance.model, appearance_of(input_, there, q.rough_samples));
      if (difference < 0) continue;
      const double x = i * step / reach, y = j * step_up / reach_up;
      const double cost = difference + q.displacement * (x * x + 2 * y * y);
      if (cost >= least) continue;
      least = cost;
      found = Point{i * step, j * step_up};
    }
  return found;
}

}  // namespace cerberus::vision
