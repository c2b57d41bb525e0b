// SPDX-License-Identifier: LGPL-2.1-or-later
#include "burnt_in_scenes.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace cerberus::bench {
namespace {

constexpr double kMargin = 25 / 640.0;  // to the picture's edges, of its width: timeoverlay's at 640 columns
constexpr double kTextHeight = 24 / 480.0;  // of an em, of the picture's height: Sans 18 at 480 lines

// Blends an ARGB32 surface (premultiplied) into the luma plane.
void blend(cairo_surface_t* surface, vision::MutableGrayView frame, int left, int top) {
  cairo_surface_flush(surface);
  const std::uint8_t* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  const int width = cairo_image_surface_get_width(surface), height = cairo_image_surface_get_height(surface);
  for (int y = std::max(0, -top); y < std::min(height, frame.height - top); ++y)
    for (int x = std::max(0, -left); x < std::min(width, frame.width - left); ++x) {
      const auto* pixel = data + y * stride + 4 * x;
      std::uint8_t& luma = frame.at(left + x, top + y);
      const int alpha = pixel[3];
      luma = static_cast<std::uint8_t>(pixel[1] + (luma * (255 - alpha) + 127) / 255);
    }
}

std::string text_at(Writing writing, double seconds) {
  const int ms = static_cast<int>(std::lround(seconds * 1000)), s = ms / 1000;
  char out[80];
  if (writing == Writing::sans_clock)
    std::snprintf(out, sizeof out, "%d:%02d:%02d.%03d", s / 3600, s / 60 % 60, s % 60, ms % 1000);
  else
    std::snprintf(out, sizeof out, "2026-11-22 %02d:%02d:%02d", 9 + s / 3600, (41 + s / 60) % 60, s % 60);
  return writing == Writing::blinking_logo ? "REC" : out;
}

}  // namespace

const char* name_of(Corner corner) {
  static constexpr const char* names[] = {"top left", "top right", "bottom left", "bottom right"};
  return names[static_cast<int>(corner)];
}
const char* name_of(Writing writing) {
  static constexpr const char* names[] = {"sans clock", "monospace clock", "blinking logo"};
  return names[static_cast<int>(writing)];
}

vision::Box write_into(vision::MutableGrayView frame, Writing writing, Corner corner, double seconds) {
  const double em = std::round(kTextHeight * frame.height), margin = std::round(kMargin * frame.width);
  const int width = static_cast<int>(em * 12), height = static_cast<int>(em * 1.6);
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  cairo_t* cr = cairo_create(surface);
  const bool mono = writing == Writing::monospace_clock, logo = writing == Writing::blinking_logo;
  cairo_select_font_face(cr, mono ? "DejaVu Sans Mono" : "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         logo ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, mono ? em * .85 : em);
  const std::string text = text_at(writing, seconds);
  cairo_text_extents_t extents;
  cairo_text_extents(cr, text.c_str(), &extents);
  const double indent = logo ? em : 4, shown = indent + extents.x_advance + 4;
  if (mono) {
    cairo_set_source_rgba(cr, 0, 0, 0, .7);
    cairo_rectangle(cr, 0, 0, shown, height);
    cairo_fill(cr);
  }
  if (!logo || std::fmod(seconds, 1.0) < .5) {
    if (logo) {
      cairo_arc(cr, em / 2, em * .8, em * .35, 0, 6.2832);
      cairo_set_source_rgb(cr, .9, .9, .9);
      cairo_fill(cr);
    }
    cairo_move_to(cr, indent, em * 1.15);
    cairo_text_path(cr, text.c_str());
    cairo_set_source_rgb(cr, 0, 0, 0);
    cairo_set_line_width(cr, em / 8);
    if (!mono) cairo_stroke_preserve(cr);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_fill(cr);
  }
  const bool right = corner == Corner::top_right || corner == Corner::bottom_right;
  const bool bottom = corner == Corner::bottom_left || corner == Corner::bottom_right;
  // The clock grows to the left where it stands on the right: digits of the same width keep their places.
  const double left = right ? frame.width - margin - std::ceil(shown) : margin;
  const double top = bottom ? frame.height - margin - height : margin;
  blend(surface, frame, static_cast<int>(left), static_cast<int>(top));
  cairo_destroy(cr);
  cairo_surface_destroy(surface);
  return {left, top, std::ceil(shown), static_cast<double>(height)};
}

}  // namespace cerberus::bench
