// SPDX-License-Identifier: LGPL-2.1-or-later
// What is written into the picture: the objects' labels, and the panel that tells of head and sensors.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "overlay/cairo_helpers.h"
#include "overlay/painter.h"
#include "text/numbers.h"

namespace cerberus::overlay {

namespace {

// In widths of its box: a crowd of small people is not to vanish behind numbers.
constexpr double kLongestLabel = 3;

double luminance(Color c) {
  return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
}

// As much as a glance takes in: 3.2, 45.
std::string number(double value) {
  return text::fixed(std::min(value, 99999.0), value < 10 ? 1 : 0).string();
}

}  // namespace

void select_font(cairo_t* cairo, double size, bool bold) {
  cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
}

double text_width(cairo_t* cairo, const char* text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text, &extents);
  return extents.x_advance;
}

// The object's label, drawn when its words are new: identity, two bars for stopped, and where `detailed` speed and
// distance.
const Painter::Label& Painter::label(const Object& object, bool detailed) {
  const std::string id = object.id ? std::to_string(object.id) : std::string();
  std::string more;
  if (detailed && scene_->speeds && object.state != ObjectState::stopped && std::isfinite(object.speed))
    more = number(object.speed) + " px/s";
  if (detailed && std::isfinite(object.distance) && object.distance > 0)
    more = (more.empty() ? "" : more + "  ") + number(object.distance) + " m";
  const char look = static_cast<char>('0' + static_cast<int>(object.state));
  const auto [entry, fresh] = labels_.try_emplace(id + look + more);
  entry->second.used = true;
  if (fresh) draw_label(entry->second, identity_color(object.id), object.state, id, more);
  return entry->second;
}

// A pill in the object's colour. Stays empty where there are no words.
void Painter::draw_label(Label& label, Color color, ObjectState look, const std::string& id,
                         const std::string& more) {
  const bool bars = look == ObjectState::stopped;
  const double pad = 0.4 * font_, gap = 0.45 * font_, bars_width = 0.5 * font_, small = 0.85 * font_;
  const SurfacePtr scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const ContextPtr measure(cairo_create(scratch.get()));
  select_font(measure.get(), font_, true);
  const double id_width = id.empty() ? 0 : text_width(measure.get(), id.c_str());
  select_font(measure.get(), small);
  const double more_width = more.empty() ? 0 : text_width(measure.get(), more.c_str());
  const int parts = !id.empty() + bars + !more.empty();
  if (parts == 0) return;

  const double width = 2 * pad + id_width + (bars ? bars_width : 0) + more_width + (parts - 1) * gap;
  const double height = 1.35 * font_;
  label.width = static_cast<int>(std::ceil(width)) + 2;
  label.height = static_cast<int>(std::ceil(height)) + 2;
  label.pixels.reset(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, label.width, label.height));
  const ContextPtr context(cairo_create(label.pixels.get()));
  cairo_t* cr = context.get();
  rounded_rectangle(cr, 0.5, 0.5, width + 1, height + 1, 0.35 * font_);
  source(cr, {}, 0.55);
  cairo_fill(cr);
  rounded_rectangle(cr, 1, 1, width, height, 0.3 * font_);
  source(cr, color, look == ObjectState::coasted ? 0.8 : 0.95);
  cairo_fill(cr);

  double x = 1 + pad;
  const double base = 1 + height / 2 + 0.36 * font_;
  source(cr, luminance(color) > 0.45 ? Color{0.05, 0.05, 0.05} : Color{1, 1, 1});
  if (!id.empty()) {
    select_font(cr, font_, true);
    cairo_move_to(cr, x, base);
    cairo_show_text(cr, id.c_str());
    x += id_width + gap;
  }
  if (bars) {
    for (const double at : {0.0, 0.32 * font_})
      cairo_rectangle(cr, x + at, 1 + height / 4, 0.16 * font_, height / 2);
    cairo_fill(cr);
    x += bars_width + gap;
  }
  if (!more.empty()) {
    select_font(cr, small);
    cairo_move_to(cr, x, base - 0.03 * font_);
    cairo_show_text(cr, more.c_str());
  }
  cairo_surface_flush(label.pixels.get());
}

// Above the box, below it, or inside its top: the first place in the frame that no other label has; what is long gives
// way to what is short.
void Painter::paint_label(const Object& object, std::vector<Patch>& patches) {
  const int gap =
      static_cast<int>(std::ceil(scene_->boxes && object.target ? (kTargetRoom + 1) * line_ : line_));
  const int top = static_cast<int>(std::lround(object.y));
  const int bottom = static_cast<int>(std::lround(object.y + object.height));
  const auto is_free = [&](const Area& a) {
    return a.y >= 0 && a.y + a.height <= frame_.height &&
           std::none_of(taken_.begin(), taken_.end(),
                        [&](const Area& t) { return !t.intersection(a).empty(); });
  };
  const Label* chosen = nullptr;
  Area area;
  bool found = false;
  for (const bool detailed : {true, false}) {
    chosen = &label(object, detailed);
    if (!chosen->pixels || (detailed && chosen->width > kLongestLabel * object.width)) continue;
    area.width = chosen->width;
    area.height = chosen->height;
    area.x = std::clamp(static_cast<int>(std::lround(object.x - line_ / 2 - 1)), 0,
                        std::max(0, frame_.width - area.width));
    for (const int y : {top - area.height - gap, bottom + gap, top + gap}) {
      area.y = y;
      if ((found = is_free(area))) break;
    }
    if (found) break;
  }
  if (!chosen->pixels || area.width > frame_.width || area.height > frame_.height) return;
  if (!found) area.y = std::clamp(top - area.height - gap, 0, frame_.height - area.height);
  taken_.push_back(area);
  patches.push_back({area, SurfacePtr(cairo_surface_reference(chosen->pixels.get()))});
}

// A panel in the corner: the head's angles, the sensors as the paper's LEDs (red: detects, blue: does not, grey: says
// nothing) with their numbers, as they look from left to right, the rule and the action.
void Painter::paint_system(std::vector<Patch>& patches) {
  const System& system = scene_->system;
  const auto degrees = [](double value) {
    // What is no angle of a head does not fit in either.
    const bool fits = std::abs(value) <= 1e4;
    return fits ? text::fixed(value, 1).string() : std::string("?");
  };
  std::string lines[2];
  if (system.pose) lines[0] = "pan " + degrees(system.pan) + "  tilt " + degrees(system.tilt);
  if (system.decision) lines[1] = system.rule.empty() ? system.action : system.rule + ": " + system.action;

  const SurfacePtr scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const ContextPtr measure(cairo_create(scratch.get()));
  select_font(measure.get(), font_);
  const double pad = 0.5 * font_, led = 0.5 * font_, step = 2.4 * led, row = 1.35 * font_, edge = 0.6 * font_;
  const double leds =
      system.lights.empty() ? 0 : step * static_cast<double>(system.lights.size()) + 0.3 * font_;
  const double width = 2 * pad + std::max(text_width(measure.get(), lines[0].c_str()),
                                          leds + text_width(measure.get(), lines[1].c_str()));
  const double height = pad + row * (!lines[0].empty() + !lines[1].empty());
  add_patch(patches, frame_, around(edge, edge, edge + width, edge + height, 1), [&](cairo_t* cr) {
    rounded_rectangle(cr, edge, edge, width, height, 0.35 * font_);
    source(cr, {}, 0.6);
    cairo_fill(cr);
    double y = edge + 0.5 * pad;
    for (const std::string& line : lines) {
      if (line.empty()) continue;
      double x = edge + pad;
      if (&line == &lines[1])
        for (const Light& light : system.lights) {
          cairo_arc(cr, x + led, y + row / 2, led, 0, 2 * std::numbers::pi);
          source(cr, light.reading == 1   ? Color{1, 0.15, 0.1}
                     : light.reading == 0 ? Color{0.15, 0.35, 1}
                                          : Color{0.5, 0.5, 0.5});
          cairo_fill(cr);
          const std::string name = std::to_string(light.sensor);
          source(cr, {1, 1, 1});
          select_font(cr, 0.75 * font_, true);
          cairo_move_to(cr, x + led - text_width(cr, name.c_str()) / 2, y + row / 2 + 0.27 * font_);
          cairo_show_text(cr, name.c_str());
          x += step;
        }
      if (&line == &lines[1]) x = edge + pad + leds;
      select_font(cr, font_);
      source(cr, {1, 1, 1});
      cairo_move_to(cr, x, y + row / 2 + 0.36 * font_);
      cairo_show_text(cr, line.c_str());
      y += row;
    }
  });
}

}  // namespace cerberus::overlay
