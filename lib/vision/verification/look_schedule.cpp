// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/look_schedule.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cerberus::vision {

namespace {

Box around(const Box& a, const Box& b) {
  const double x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

Box padded(const Box& box, Size frame, const VerificationParameters& p) {
  const double side = p.side_margin * box.height, above = p.top_margin * box.height;
  const double x = std::clamp(box.x - side, 0.0, frame.width - 1.0),
               y = std::clamp(box.y - above, 0.0, frame.height - 1.0);
  return {x, y, std::clamp(box.right() + side, x + 1, double(frame.width)) - x,
          std::clamp(box.bottom() + above, y + 1, double(frame.height)) - y};
}

// Scaled pixels.
double area_of(const LookRegion& region) {
  return region.box().area() * region.scale * region.scale;
}

bool shows(const LookRegion& region, const Box& box, double height, const VerificationParameters& p) {
  return share_within(box, region.box()) > p.in_look && height * region.scale >= p.fine * p.look_height;
}

// area: scaled pixels that the region may have, before its sides become whole pixels. nullopt: nobody to look for, or less than
// a whole look's area is left and the target does not fit.
std::optional<LookRegion> choose_region(std::span<const LookTarget> targets, Size frame, double area,
                                        const VerificationParameters& p) {
  const LookTarget* first = nullptr;
  for (const LookTarget& target : targets)
    if (target.doubt > 0 && target.height >= p.least_height && (!first || target.doubt > first->doubt))
      first = &target;
  if (!first || frame.width < 2 || frame.height < 2) return std::nullopt;
  double height = first->height;  // of the lowest person who is looked for
  const auto scale = [&](double lowest) { return std::min(p.look_height / lowest, p.most_scale); };
  const auto most = [&](double lowest) { return area / (scale(lowest) * scale(lowest)); };  // frame pixels
  Box region = padded(first->box, frame, p);
  for (;;) {
    const LookTarget* best = nullptr;
    double gain = 0;
    for (const LookTarget& target : targets) {
      const double ratio = target.height / first->height;
      if (!(target.doubt > 0) || ratio < p.flattest || ratio > p.steepest) continue;
      const Box both = around(region, padded(target.box, frame, p));
      const double added = both.area() - region.area();
      if (both.area() > most(std::min(height, target.height)) || (added < 1 && target.height >= height))
        continue;
      if (target.doubt / std::max(added, 1.0) > gain)
        gain = target.doubt / std::max(added, 1.0), best = &target;
    }
    if (!best) break;
    region = around(region, padded(best->box, frame, p));
    height = std::min(height, best->height);
  }
  if (region.area() > most(height)) {  // one group that is too wide: its middle
    if (area < p.most_area) return std::nullopt;
    const double width = std::min(region.width, most(height) / region.height);
    region.x += (region.width - width) / 2;
    region.width = width;
  }
  LookRegion look;
  look.x = static_cast<int>(region.x), look.y = static_cast<int>(region.y);
  look.width = std::clamp(static_cast<int>(std::ceil(region.right())) - look.x, 1, frame.width - look.x);
  look.height = std::clamp(static_cast<int>(std::ceil(region.bottom())) - look.y, 1, frame.height - look.y);
  look.scale = scale(height);
  return look;
}

}  // namespace

LookRegions choose_look(std::span<LookTarget> targets, Size frame, std::size_t most,
                        const VerificationParameters& p) {
  LookRegions look;
  double left = p.most_area;
  while (look.count < std::min(most, LookRegions::kMost)) {
    const auto region = choose_region(targets, frame, left, p);
    if (!region) break;
    look.all[look.count++] = *region, left -= area_of(*region);
    for (LookTarget& target : targets)
      if (shows(*region, target.box, target.height, p)) target.doubt = 0;
  }
  return look;
}

bool shows(const LookRegions& look, const Box& box, double height, const VerificationParameters& p) {
  return std::ranges::any_of(look.chosen(),
                             [&](const LookRegion& region) { return shows(region, box, height, p); });
}

}  // namespace cerberus::vision
