// SPDX-License-Identifier: LGPL-2.1-or-later
// What the painter's parts draw with.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "overlay/painter.h"

namespace cerberus::overlay {

inline constexpr double kCasing = 0.6;  // opacity of the dark casing under lines
// How far the target's corners lie outside its box, in widths of a line.
inline constexpr double kTargetRoom = 2.5;

inline void source(cairo_t* cr, Color c, double alpha = 1) {
  cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha);
}

// A patch of the frame, drawn by `draw` in the frame's coordinates; clipped to the frame.
template <typename Draw>
void add_patch(std::vector<Patch>& patches, Area frame, Area area, Draw draw) {
  area = area.intersection(frame);
  if (area.empty()) return;
  SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, area.width, area.height));
  ContextPtr cr(cairo_create(surface.get()));
  // Half the time of the default, and no eye sees it in lines of two pixels.
  cairo_set_antialias(cr.get(), CAIRO_ANTIALIAS_FAST);
  cairo_set_tolerance(cr.get(), 0.4);
  cairo_translate(cr.get(), -area.x, -area.y);
  draw(cr.get());
  if (cairo_status(cr.get()) != CAIRO_STATUS_SUCCESS) return;
  cr.reset();
  cairo_surface_flush(surface.get());
  patches.push_back({area, std::move(surface)});
}

inline Area around(double left, double top, double right, double bottom, double margin) {
  const int x = static_cast<int>(std::floor(left - margin)), y = static_cast<int>(std::floor(top - margin));
  return {x, y, static_cast<int>(std::ceil(right + margin)) - x,
          static_cast<int>(std::ceil(bottom + margin)) - y};
}

inline void rounded_rectangle(cairo_t* cr, double x, double y, double w, double h, double r) {
  constexpr double kQuarter = std::numbers::pi / 2;
  r = std::max(0.0, std::min({r, w / 2, h / 2}));
  cairo_new_sub_path(cr);
  cairo_arc(cr, x + w - r, y + r, r, -kQuarter, 0);
  cairo_arc(cr, x + w - r, y + h - r, r, 0, kQuarter);
  cairo_arc(cr, x + r, y + h - r, r, kQuarter, 2 * kQuarter);
  cairo_arc(cr, x + r, y + r, r, 2 * kQuarter, 3 * kQuarter);
  cairo_close_path(cr);
}

}  // namespace cerberus::overlay
