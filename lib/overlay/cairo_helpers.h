// SPDX-License-Identifier: LGPL-2.1-or-later
// Helpers for drawing with cairo, which draws text and shapes that seldom change.
#pragma once

#include <cairo.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "overlay/color.h"
#include "overlay/picture.h"

namespace cerberus::overlay {

struct SurfaceDeleter {
  void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
};
using SurfacePtr = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
struct ContextDeleter {
  void operator()(cairo_t* c) const { cairo_destroy(c); }
};
using ContextPtr = std::unique_ptr<cairo_t, ContextDeleter>;

inline void set_color(cairo_t* cr, Color c, double alpha = 1) {
  cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha);
}

// A sans-serif face at `size` pixels.
inline void select_font(cairo_t* cr, double size, bool bold = false) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size);
}

// Returns the width of `text` in the context's font, pixels.
inline double text_width(cairo_t* cr, const char* text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cr, text, &extents);
  return extents.x_advance;
}

// A context to measure text with.
inline ContextPtr measuring_context() {
  const SurfacePtr scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  return ContextPtr(cairo_create(scratch.get()));
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

// Returns the part of `area` within the frame, drawn by `draw` in the frame's coordinates; a patch without pixels if
// the part is empty or cairo fails.
template <typename Draw>
Patch drawn_patch(PicturePool& pool, Area frame, Area area, Draw draw) {
  area = area.intersection(frame);
  if (area.empty()) return {};
  const PicturePtr picture = pool.take(area.width, area.height);
  const SurfacePtr surface(
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(picture->words.data()),
                                          CAIRO_FORMAT_ARGB32, area.width, area.height, 4 * area.width));
  const ContextPtr cr(cairo_create(surface.get()));
  cairo_translate(cr.get(), -area.x, -area.y);
  draw(cr.get());
  cairo_surface_flush(surface.get());
  if (cairo_status(cr.get()) != CAIRO_STATUS_SUCCESS) return {};
  return {area, picture};
}

}  // namespace cerberus::overlay
