// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/look_schedule.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

std::optional<LookRegion> choose_look(std::span<const LookTarget> targets, Size frame,
                                      const VerificationParameters& p) {
  const LookTarget* first = nullptr;
  for (const LookTarget& target : targets)
    if (target.doubt > 0 && target.height >= p.least_height && (!first || target.doubt > first->doubt))
      first = &target;
  if (!first || frame.width < 2 || frame.height < 2) return std::nullopt;
  double height = first->height;  // of the lowest person who is looked for
  const auto scale = [&](double lowest) { return std::min(p.look_height / lowest, p.most_scale); };
  const auto most = [&](double lowest) {
    return p.most_area / (scale(lowest) * scale(lowest));
  };  // frame pixels
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

}  // namespace cerberus::vision
