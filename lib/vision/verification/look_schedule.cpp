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
    if (target.doubt > 0 && target.box.height >= p.least_height && (!first || target.doubt > first->doubt))
      first = &target;
  if (!first || frame.width < 2 || frame.height < 2) return std::nullopt;
  const double scale = std::min(p.look_height / first->box.height, p.most_scale);
  const double most = p.most_area / (scale * scale);  // frame pixels
  Box region = padded(first->box, frame, p);
  for (;;) {
    const LookTarget* best = nullptr;
    double gain = 0;
    for (const LookTarget& target : targets) {
      const double ratio = target.box.height / first->box.height;
      if (!(target.doubt > 0) || ratio < p.flattest || ratio > p.steepest) continue;
      const Box both = around(region, padded(target.box, frame, p));
      const double added = both.area() - region.area();
      if (both.area() > most || added < 1) continue;
      if (target.doubt / added > gain) gain = target.doubt / added, best = &target;
    }
    if (!best) break;
    region = around(region, padded(best->box, frame, p));
  }
  if (region.area() > most) {  // one group that is too wide: its middle
    const double width = std::min(region.width, most / region.height);
    region.x += (region.width - width) / 2;
    region.width = width;
  }
  LookRegion look;
  look.x = static_cast<int>(region.x), look.y = static_cast<int>(region.y);
  look.width = std::clamp(static_cast<int>(std::ceil(region.right())) - look.x, 1, frame.width - look.x);
  look.height = std::clamp(static_cast<int>(std::ceil(region.bottom())) - look.y, 1, frame.height - look.y);
  look.scale = scale;
  return look;
}

}  // namespace cerberus::vision
