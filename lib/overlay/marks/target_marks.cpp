// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/target_marks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::overlay {

namespace {

constexpr double kCasingOpacity = 0.6;

// Returns the share of [at, at + 1) that lies in [low, high).
double share(int at, double low, double high) {
  return std::clamp(std::min(at + 1.0, high) - std::max(static_cast<double>(at), low), 0.0, 1.0);
}

// Two strokes of half a width `half` that meet at (x, y) and reach `dx` and `dy` pixels far.
struct Bracket {
  double x, y, dx, dy;

  float covered(int px, int py, double half) const {
    const double far_x = x + dx, far_y = y + dy, near_x = x - (dx > 0 ? half : -half),
                 near_y = y - (dy > 0 ? half : -half);
    const auto between = [](int at, double a, double b) { return share(at, std::min(a, b), std::max(a, b)); };
    const double level = between(px, near_x, far_x) * share(py, y - half, y + half),
                 upright = share(px, x - half, x + half) * between(py, near_y, far_y);
    return static_cast<float>(std::max(level, upright));
  }
};

}  // namespace

void draw_target_marks(const Object& object, double line, Area frame, PicturePool& pool,
                       std::vector<Patch>& patches) {
  const double room = kTargetRoom * line, thick = 1.6 * line, casing = std::max(1.0, 0.6 * line);
  const double outer_half = thick / 2 + casing;
  const double arm =
      std::clamp(0.25 * std::min(object.width, object.height) + room, 2 * thick, 8 * thick) - thick / 2;
  const double left = std::max(object.x - room, thick), top = std::max(object.y - room, thick),
               right = std::min(object.x + object.width + room, frame.width - thick),
               bottom = std::min(object.y + object.height + room, frame.height - thick);
  const Premultiplied dark(Color{}, kCasingOpacity), color(identity_color(object.id), 1);
  for (const auto& [x, dx] : {std::pair{left, arm}, {right, -arm}})
    for (const auto& [y, dy] : {std::pair{top, arm}, {bottom, -arm}}) {
      const Area area = Area::around(std::min(x, x + dx), std::min(y, y + dy), std::max(x, x + dx),
                                     std::max(y, y + dy), thick + casing)
                            .intersection(frame);
      if (area.empty()) continue;
      const PicturePtr picture = pool.take(area.width, area.height);
      const Bracket bracket{x - area.x, y - area.y, dx, dy};
      for (int j = 0; j < area.height; ++j) {
        std::uint32_t* row = picture->view().row(j);
        // Beside the level stroke only the columns of the upright one are drawn.
        const bool level = std::abs(j + 0.5 - bracket.y) < outer_half + 1;
        const int from = level ? 0 : std::max(0, static_cast<int>(bracket.x - outer_half - 1)),
                  to =
                      level ? area.width : std::min(area.width, static_cast<int>(bracket.x + outer_half + 2));
        for (int i = from; i < to; ++i)
          if (const float outer = bracket.covered(i, j, outer_half); outer > 0)
            row[i] = (color * bracket.covered(i, j, thick / 2)).over(dark * outer).word();
      }
      patches.push_back({area, picture});
    }
}

}  // namespace cerberus::overlay
