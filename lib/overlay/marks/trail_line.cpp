// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/trail_line.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "overlay/color.h"

namespace cerberus::overlay {

namespace {

constexpr float kFar = -1e6f;
constexpr float kOthers = -1;  // the age of a stretch of another patch

// Returns the freshness of a step of age: 1 fresh, 0 faded.
double freshness(int step, int steps) {
  return 1 - (step + 0.5) / steps;
}

}  // namespace

int TrailLine::step(double time, const Style& style) const {
  const double age = (style.time - time) / std::max(style.duration, 1e-3);
  return std::clamp(static_cast<int>(kSteps * age), 0, kSteps - 1);
}

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
    if (const Area area = Area::around(left, top, right, bottom, margin).intersection(frame); !area.empty()) {
      const PicturePtr picture = pool.take(area.width, area.height);
      draw_part(trail.id, style, area, first, last, picture->view());
      patches.push_back({area, picture});
    }
    first = last;
  }
}

// Depth of the pixels' centres inside a stretch of the line with round ends, where that is more than it was. What lies
// deeper than -reach is measured.
void TrailLine::measure(Area area, vision::Point from, vision::Point to, float half, float step,
                        float reach) {
  const double margin = half + reach + 1;
  const Area part = Area::around(std::min(from.x, to.x), std::min(from.y, to.y), std::max(from.x, to.x),
                                 std::max(from.y, to.y), margin)
                        .intersection(area);
  if (part.empty()) return;
  const auto ax = static_cast<float>(from.x - area.x), ay = static_cast<float>(from.y - area.y);
  const auto dx = static_cast<float>(to.x - from.x), dy = static_cast<float>(to.y - from.y);
  const float square = dx * dx + dy * dy, inverse = square > 0 ? 1 / square : 0;
  for (int y = part.y - area.y; y < part.y - area.y + part.height; ++y) {
    const float py = static_cast<float>(y) + 0.5f - ay;
    float* depth = depth_.data() + static_cast<std::ptrdiff_t>(y) * area.width;
    float* steps = step_.data() + static_cast<std::ptrdiff_t>(y) * area.width;
    const int begin = part.x - area.x, end = begin + part.width;
    for (int x = begin; x < end; ++x) {
      const float px = static_cast<float>(x) + 0.5f - ax;
      float t = (px * dx + py * dy) * inverse;
      t = t < 0 ? 0 : t;
      t = t > 1 ? 1 : t;
      const float ex = px - t * dx, ey = py - t * dy;
      const float here = half - std::sqrt(ex * ex + ey * ey);
      steps[x] = here > depth[x] ? step : steps[x];
      depth[x] = here > depth[x] ? here : depth[x];
    }
  }
}

// The smoothed points first..last: a dark casing, and on it the line in steps of age. The stretches before and after
// them are measured, too, and a pixel that is nearer to one of those is left to their patch: the line is translucent,
// so a pixel that two patches drew would be darker.
void TrailLine::draw_part(std::uint32_t id, const Style& style, Area area, std::size_t first,
                          std::size_t last, vision::View<std::uint32_t> picture) {
  const std::size_t pixels = static_cast<std::size_t>(area.width) * static_cast<std::size_t>(area.height);
  depth_.assign(pixels, kFar);
  step_.assign(pixels, 0);
  const auto casing = static_cast<float>(std::max(1.0, 0.7 * style.line) / 2);
  const std::size_t begin = first > 0 ? first - 1 : 0, end = std::min(last + 1, points_.size() - 1);
  for (std::size_t i = begin; i < end; ++i) {
    const int age = step(points_[i].time, style);
    const double width = style.line * (0.5 + 0.7 * freshness(age, kSteps));
    const bool own = i >= first && i < last;
    measure(area, points_[i].position, points_[i + 1].position, static_cast<float>(width / 2),
            own ? static_cast<float>(age) : kOthers, casing);
  }
  std::array<Premultiplied, kSteps> lines, casings;
  for (int age = 0; age < kSteps; ++age) {
    const double strength = std::min(1.0, 1.4 * freshness(age, kSteps));
    lines[age] = {identity_color(id), 0.95 * strength};
    casings[age] = {Color{}, 0.45 * strength};
  }
  for (int y = 0; y < area.height; ++y) {
    const float* depth = depth_.data() + static_cast<std::ptrdiff_t>(y) * area.width;
    const float* steps = step_.data() + static_cast<std::ptrdiff_t>(y) * area.width;
    std::uint32_t* row = picture.row(y);
    for (int x = 0; x < area.width; ++x) {
      if (depth[x] + casing <= -0.5f || steps[x] == kOthers) continue;
      const auto age = static_cast<std::size_t>(steps[x]);
      const float outer = std::clamp(depth[x] + casing + 0.5f, 0.0f, 1.0f),
                  inner = std::clamp(depth[x] + 0.5f, 0.0f, 1.0f);
      row[x] = (lines[age] * inner + casings[age] * (outer * (1 - inner))).word();
    }
  }
}

}  // namespace cerberus::overlay
