// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/system_panel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "overlay/cairo_helpers.h"
#include "text/numbers.h"

namespace cerberus::overlay {

namespace {

// Appends an angle. Values beyond any head's angles become a question mark: they would not fit in the panel.
void append_degrees(std::string& text, double value) {
  if (std::abs(value) <= 1e4)
    text += text::fixed(value, 1).string_view();
  else
    text += '?';
}

Color light_color(std::uint8_t reading) {
  return reading == 1 ? Color{1, 0.15, 0.1} : reading == 0 ? Color{0.15, 0.35, 1} : Color{0.5, 0.5, 0.5};
}

}  // namespace

const Patch& SystemPanel::patch(const System& system, double font, Area frame, PicturePool& pool) {
  std::string lines[2];
  if (system.pose) {
    lines[0] = "pan ";
    append_degrees(lines[0], system.pan);
    lines[0] += "  tilt ";
    append_degrees(lines[0], system.tilt);
  }
  if (system.decision) lines[1] = system.rule.empty() ? system.action : system.rule + ": " + system.action;
  const bool same =
      frame == frame_ && font == font_ && std::equal(lines, lines + 2, lines_) && system.lights == lights_;
  if (same) return patch_;
  frame_ = frame;
  font_ = font;
  std::swap(lines, lines_);
  lights_ = system.lights;
  patch_ = lines_[0].empty() && lines_[1].empty() ? Patch() : draw(frame, pool);
  return patch_;
}

Patch SystemPanel::draw(Area frame, PicturePool& pool) const {
  const ContextPtr measure = measuring_context();
  select_font(measure.get(), font_);
  const double pad = 0.5 * font_, led = 0.5 * font_, step = 2.4 * led, row = 1.35 * font_, edge = 0.6 * font_;
  const double leds = lights_.empty() ? 0 : step * static_cast<double>(lights_.size()) + 0.3 * font_;
  const double width = 2 * pad + std::max(text_width(measure.get(), lines_[0].c_str()),
                                          leds + text_width(measure.get(), lines_[1].c_str()));
  const double height = pad + row * (!lines_[0].empty() + !lines_[1].empty());
  const auto draw_lights = [&](cairo_t* cr, double x, double y) {
    for (const Light& light : lights_) {
      cairo_arc(cr, x + led, y + row / 2, led, 0, 2 * std::numbers::pi);
      set_color(cr, light_color(light.reading));
      cairo_fill(cr);
      const std::string name = std::to_string(light.sensor);
      set_color(cr, {1, 1, 1});
      select_font(cr, 0.75 * font_, true);
      cairo_move_to(cr, x + led - text_width(cr, name.c_str()) / 2, y + row / 2 + 0.27 * font_);
      cairo_show_text(cr, name.c_str());
      x += step;
    }
  };
  const Area area = Area::around(edge, edge, edge + width, edge + height, 1);
  return drawn_patch(pool, frame, area, [&](cairo_t* cr) {
    rounded_rectangle(cr, edge, edge, width, height, 0.35 * font_);
    set_color(cr, {}, 0.6);
    cairo_fill(cr);
    double y = edge + 0.5 * pad;
    for (const std::string& line : lines_) {
      if (line.empty()) continue;
      double x = edge + pad;
      if (&line == &lines_[1]) {
        draw_lights(cr, x, y);
        x += leds;
      }
      select_font(cr, font_);
      set_color(cr, {1, 1, 1});
      cairo_move_to(cr, x, y + row / 2 + 0.36 * font_);
      cairo_show_text(cr, line.c_str());
      y += row;
    }
  });
}

}  // namespace cerberus::overlay
