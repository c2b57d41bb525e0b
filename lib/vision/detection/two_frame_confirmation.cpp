// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/two_frame_confirmation.h"

#include <algorithm>
#include <cmath>

#include "vision/geometry/registration.h"
#include "vision/image/preallocate.h"

namespace cerberus::vision {
void TwoFrameConfirmation::preallocate() {
  vision::preallocate(last_, 2 * kMost);
}

bool TwoFrameConfirmation::was_there(const Box& box, std::size_t before, const Transform& motion,
                                     double slack) const {
  return std::any_of(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(before), [&](const Place& b) {
    const Point from{b.x + b.width / 2.0 - 0.5, b.y + b.height / 2.0 - 0.5}, to = motion.apply(from);
    const double reach = parameters_.reach * std::min(b.width, b.height) + slack;
    const Box around{b.x + to.x - from.x - reach, b.y + to.y - from.y - reach, b.width + 2 * reach,
                     b.height + 2 * reach};
    return overlap_area(around, box) >= parameters_.common * box.area();
  });
}

void TwoFrameConfirmation::filter(std::vector<Region>& regions, int frames, double minimum_area,
                                  const Transform& motion, Size picture) {
  if (frames > parameters_.frames) return;
  const std::size_t before = last_.size();
  const auto whole = [](double v) { return static_cast<std::int16_t>(std::lround(v)); };
  for (const Region& r : regions)
    if (last_.size() < before + kMost)
      last_.push_back({whole(r.box.x), whole(r.box.y), whole(r.box.width), whole(r.box.height)});
  const bool stands = motion.is_identity();
  // Before the first frame that may have regions there is none to compare with: a standing camera makes few errors.
  if (frames > parameters_.first || !stands)
    std::erase_if(regions, [&](const Region& r) {
      if (minimum_area <= 0 && r.area < parameters_.speck * picture.area()) return true;
      const Box& b = r.box;
      const bool at_edge = b.x <= 0 || b.y <= 0 || b.right() >= picture.width || b.bottom() >= picture.height;
      if (frames > kUnsettledFrames && (stands || at_edge)) return false;
      return b.area() <= parameters_.small * picture.area() &&
             !was_there(b, before, motion, parameters_.slack * picture.width / 320);
    });
  last_.erase(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(before));
}

}  // namespace cerberus::vision
