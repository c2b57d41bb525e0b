// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/regions.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vision/labelling.h"
#include "vision/mask.h"
#include "vision/morphology.h"

namespace cerberus::vision {

double intersection_over_union(const Box& a, const Box& b) {
  const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  if (!(w > 0 && h > 0)) return 0;
  return w * h / (a.area() + b.area() - w * h);
}

struct RegionFinder::State {
  RegionOptions options;
  Morphology morphology;
  Labeller labeller;
  std::vector<Region> regions;
  Size size;
};

RegionFinder::RegionFinder() : state_(std::make_unique<State>()) {}
RegionFinder::~RegionFinder() = default;
RegionFinder::RegionFinder(RegionFinder&&) noexcept = default;
RegionFinder& RegionFinder::operator=(RegionFinder&&) noexcept = default;

void RegionFinder::set_options(const RegionOptions& options) {
  state_->options = options;
}

void RegionFinder::reset() {
  state_->regions.clear();
}

std::size_t RegionFinder::bytes() const {
  return state_->morphology.bytes() + state_->labeller.bytes();
}

std::span<const Region> RegionFinder::update(MutableGrayView mask, View<std::uint16_t> labels,
                                             const Transform&) {
  State& s = *state_;
  s.regions.clear();
  s.morphology.close(mask, s.options.closing * mask.width / 320 | 1);
  const double least = s.options.minimum_area > 0 ? s.options.minimum_area : 4e-4 * mask.size().area();
  for (const Component& c : s.labeller.find(mask)) {
    if (c.area < least) continue;
    const double box = static_cast<double>(c.width()) * c.height();
    s.regions.push_back(
        {{static_cast<double>(c.left), static_cast<double>(c.top), static_cast<double>(c.width()),
          static_cast<double>(c.height())},
         static_cast<double>(c.area),
         c.centroid(),
         std::min(1.0, 0.3 + c.area / box),
         static_cast<int>(std::min<std::size_t>(&c - s.labeller.components().data() + 1, 65535))});
  }
  s.labeller.write(labels);
  return s.regions;
}

}  // namespace cerberus::vision
