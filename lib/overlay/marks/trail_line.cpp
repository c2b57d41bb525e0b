// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/trail_line.h"

#include <algorithm>
#include <cmath>

#include "overlay/color.h"
#include "overlay/marks/line_kernels.h"

namespace cerberus::overlay {

namespace {

constexpr float kFar = -1e6f;
constexpr int kSteps = 8;                                 // of age
constexpr double kOpacity = 0.95, kCasingOpacity = 0.45;  // of a fresh line

// Returns the freshness of what was drawn at `time`, in steps: nearly 1 fresh, nearly 0 faded.
double freshness(double time, const TrailLine::Style& style) {
  const double age = (style.time - time) / std::max(style.duration, 1e-3);
  return 1 - (std::clamp(static_cast<int>(kSteps * age), 0, kSteps - 1) + 0.5) / kSteps;
}

}  // namespace

void TrailLine::smooth(std::span<const TrailPoint> points, double line) {
  constexpr std::ptrdiff_t kReach = 3;
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  points_.clear();
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t reach = std::min({kReach, i, n - 1 - i});
    TrailPoint mean{{0, 0}, points[i].time};
    for (std::ptrdiff_t j = i - reach; j <= i + reach; ++j) {
      mean.position.x += points[j].position.x;
      mean.position.y += points[j].position.y;
    }
    mean.position.x /= 2.0 * static_cast<double>(reach) + 1;
    mean.position.y /= 2.0 * static_cast<double>(reach) + 1;
    const auto distance = [&](vision::Point p) {
      return std::max(std::abs(p.x - mean.position.x), std::abs(p.y - mean.position.y));
    };
    if (i == n - 1 && points_.size() > 1 && distance(points_.back().position) < line) points_.pop_back();
    if (points_.empty() || i == n - 1 || distance(points_.back().position) >= std::max(1.0, line))
      points_.push_back(mean);
  }
}

void TrailLine::draw(const Trails::Trail& trail, const Style& style, Area frame, PicturePool& pool,
                     std::vector<Patch>& patches) {
  smooth(trail.points, style.line);
  const double most = std::max(48.0, 18 * style.line);  // side of a patch, pixels
  const double margin = 1.2 * style.line + 2;
  for (std::size_t first = 0; first + 1 < points_.size();) {
    double left = points_[first].position.x, right = left, top = points_[first].position.y, bottom = top;
    std::size_t last = first;
    while (last + 1 < points_.size()) {
      const vision::Point p = points_[last + 1].position;
      const double l = std::min(left, p.x), r = std::max(right, p.x), t = std::min(top, p.y),
                   b = std::max(bottom, p.y);
      if (last > first && (r - l > most || b - t > most)) break;
      left = l, right = r, top = t, bottom = b;
      ++last;
    }
    if (const Area area = Area::around(left, top, right, bottom, margin).even().intersection(frame);
        !area.empty()) {
      const PicturePtr picture = pool.take_unwritten(area.width, area.height);
      draw_part(trail.id, style, area, first, last, picture->view());
      patches.push_back({area, picture});
    }
    first = last;
  }
}

// Draws the smoothed points first..last: a dark casing, and on it the line in steps of age. The stretches before and
// after them are measured, too, and a pixel that is nearer to one of those is left to their patch: the line is
// translucent, so a pixel that two patches drew would be darker.
void TrailLine::draw_part(std::uint32_t id, const Style& style, Area area, std::size_t first,
                          std::size_t last, vision::View<std::uint32_t> picture) {
  DepthMap map;
  map.stride = (area.width + kLineAlignment - 1) / kLineAlignment * kLineAlignment;
  depth_.assign(static_cast<std::size_t>(map.stride * area.height), kFar);
  strength_.assign(depth_.size(), 0);
  map.depth = depth_.data();
  map.strength = strength_.data();
  FadingLine line;
  line.color = {identity_color(id), kOpacity};
  line.casing = static_cast<float>(kCasingOpacity);
  line.casing_width = static_cast<float>(std::max(1.0, 0.7 * style.line) / 2);
  const std::size_t begin = first > 0 ? first - 1 : 0, end = std::min(last + 1, points_.size() - 1);
  for (std::size_t i = begin; i < end; ++i) {
    const vision::Point from = points_[i].position, to = points_[i + 1].position;
    const double fresh = freshness(points_[i].time, style);
    Stretch stretch;
    stretch.x = static_cast<float>(from.x - area.x), stretch.y = static_cast<float>(from.y - area.y);
    stretch.dx = static_cast<float>(to.x - from.x), stretch.dy = static_cast<float>(to.y - from.y);
    stretch.half = static_cast<float>(style.line * (0.5 + 0.7 * fresh) / 2);
    const bool own = i >= first && i < last;
    stretch.strength = own ? static_cast<float>(std::min(1.0, 1.4 * fresh)) : 0;
    const double margin = stretch.half + line.casing_width + 1;
    const Area part = Area::around(std::min(from.x, to.x), std::min(from.y, to.y), std::max(from.x, to.x),
                                   std::max(from.y, to.y), margin)
                          .intersection(area);
    if (part.empty()) continue;
    const int left = part.x - area.x, top = part.y - area.y;
    measure_stretch(stretch, map, left, left + part.width, top, top + part.height);
  }
  draw_depth(line, map, area.width, area.height, picture.data);
}

}  // namespace cerberus::overlay
