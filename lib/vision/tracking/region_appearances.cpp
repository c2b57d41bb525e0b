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

AppearanceModel RegionAppearances::place(const Box& box) const {
  return input_.known() ? appearance_of({input_.luma, {}}, box, parameters_.rough_samples)
                        : AppearanceModel{};
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

}  // namespace cerberus::vision
