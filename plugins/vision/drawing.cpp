// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "text/numbers.h"

namespace cerberus::draw {

namespace {

constexpr std::array<Color, 8> kPalette = {{{1, 1, 1},
                                            {0.902, 0.624, 0.000},    // orange
                                            {0.337, 0.706, 0.914},    // sky blue
                                            {0.000, 0.690, 0.510},    // bluish green, a little lighter
                                            {0.941, 0.894, 0.259},    // yellow
                                            {0.150, 0.520, 0.850},    // blue, lighter: on dark pictures
                                            {0.900, 0.420, 0.100},    // vermilion
                                            {0.860, 0.520, 0.700}}};  // reddish purple

constexpr double kCasing = 0.6;  // opacity of the dark casing under lines

double luminance(Color c) {
  return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
}

void source(cairo_t* cr, Color c, double alpha = 1) {
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

Area around(double left, double top, double right, double bottom, double margin) {
  const int x = static_cast<int>(std::floor(left - margin)), y = static_cast<int>(std::floor(top - margin));
  return {x, y, static_cast<int>(std::ceil(right + margin)) - x,
          static_cast<int>(std::ceil(bottom + margin)) - y};
}

void rounded_rectangle(cairo_t* cr, double x, double y, double w, double h, double r) {
  constexpr double kQuarter = std::numbers::pi / 2;
  r = std::max(0.0, std::min({r, w / 2, h / 2}));
  cairo_new_sub_path(cr);
  cairo_arc(cr, x + w - r, y + r, r, -kQuarter, 0);
  cairo_arc(cr, x + w - r, y + h - r, r, 0, kQuarter);
  cairo_arc(cr, x + r, y + h - r, r, kQuarter, 2 * kQuarter);
  cairo_arc(cr, x + r, y + r, r, 2 * kQuarter, 3 * kQuarter);
  cairo_close_path(cr);
}

// The part of the object inside the frame: what strangers claim to lie far outside must not reach integers.
std::optional<Object> clipped(Object object, Area frame) {
  const double right = std::min<double>(object.x + object.width, frame.width),
               bottom = std::min<double>(object.y + object.height, frame.height);
  object.x = std::max(object.x, 0.0);
  object.y = std::max(object.y, 0.0);
  object.width = right - object.x;
  object.height = bottom - object.y;
  const bool sane =
      std::isfinite(object.x) && std::isfinite(object.y) && object.width > 0 && object.height > 0;
  return sane ? std::optional(object) : std::nullopt;
}

// As much as a glance takes in: 3.2, 45.
std::string number(double value) {
  return text::fixed(std::min(value, 99999.0), value < 10 ? 1 : 0).string();
}

}  // namespace

Color identity_color(std::uint32_t id) {
  return id == 0 ? kPalette[0] : kPalette[1 + (id - 1) % 7];
}

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

Area Area::intersection(const Area& other) const {
  const int left = std::max(x, other.x), top = std::max(y, other.y);
  return {left, top, std::min(x + width, other.x + other.width) - left,
          std::min(y + height, other.y + other.height) - top};
}

double automatic_line_width(vision::Size frame) {
  return 1.3 * std::pow(std::max(std::min(frame.width, frame.height), 60) / 240.0, 0.7);
}

void Painter::paint(const Scene& scene, std::vector<Patch>& patches) {
  scene_ = &scene;
  frame_ = {0, 0, scene.frame.width, scene.frame.height};
  line_ = scene.line_width > 0 ? scene.line_width : automatic_line_width(scene.frame);
  const double font = 9.5 * std::pow(std::max(std::min(frame_.width, frame_.height), 120) / 240.0, 0.6);
  if (std::exchange(font_, font) != font) labels_.clear();
  taken_.assign(scene.covered.begin(), scene.covered.end());
  for (auto& entry : labels_) entry.second.used = false;
  objects_.clear();
  for (const Object& object : scene.objects)
    if (const auto inside = clipped(object, frame_)) objects_.push_back(*inside);
  for (const auto& trail : scene.trails) paint_trail(trail, patches);
  if (scene.boxes)
    for (const Object& object : objects_) {
      paint_box(object, patches);
      if (object.target) paint_target(object, patches);
    }
  if (scene.ids)
    for (const Object& object : objects_) paint_label(object, patches);
  if (scene.crosshair) paint_crosshair(patches);
  if (scene.system.pose || scene.system.decision) paint_system(patches);
  std::erase_if(labels_, [](const auto& entry) { return !entry.second.used; });
  scene_ = nullptr;
}

// A line that thins out and fades with age in steps, cut into patches of bounded size. The box's foot trembles by
// pixels from frame to frame: the line follows a short centred mean (ends kept), and leaves out points closer together
// than it is wide.
void Painter::paint_trail(const vision::Trails::Trail& trail, std::vector<Patch>& patches) {
  constexpr std::ptrdiff_t kReach = 3;
  const auto& points = trail.points;
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  smooth_.clear();
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t reach = std::min({kReach, i, n - 1 - i});
    vision::TrailPoint mean{{0, 0}, points[i].time};
    for (std::ptrdiff_t j = i - reach; j <= i + reach; ++j) {
      mean.position.x += points[j].position.x / (2.0 * reach + 1);
      mean.position.y += points[j].position.y / (2.0 * reach + 1);
    }
    const auto distance = [&](vision::Point p) {
      return std::max(std::abs(p.x - mean.position.x), std::abs(p.y - mean.position.y));
    };
    if (i == n - 1 && smooth_.size() > 1 && distance(smooth_.back().position) < line_) smooth_.pop_back();
    if (smooth_.empty() || i == n - 1 || distance(smooth_.back().position) >= std::max(1.0, line_))
      smooth_.push_back(mean);
  }

  const double most = std::max(96.0, 40 * line_);  // side of a patch, pixels
  std::size_t first = 0;
  while (first + 1 < smooth_.size()) {
    double left = smooth_[first].position.x, right = left, top = smooth_[first].position.y, bottom = top;
    std::size_t last = first;
    while (last + 1 < smooth_.size()) {
      const vision::Point p = smooth_[last + 1].position;
      const double l = std::min(left, p.x), r = std::max(right, p.x), t = std::min(top, p.y),
                   b = std::max(bottom, p.y);
      if (last > first && (r - l > most || b - t > most)) break;
      left = l, right = r, top = t, bottom = b;
      ++last;
    }
    add_patch(patches, frame_, around(left, top, right, bottom, 1.2 * line_ + 2), [&](cairo_t* cr) {
      // One neighbour on either side too: else the casing would cut through the line where patches meet.
      stroke_trail(cr, identity_color(trail.id), first > 0 ? first - 1 : 0,
                   std::min(last + 1, smooth_.size() - 1));
    });
    first = last;
  }
}

// The smoothed points first..last, in steps of age.
void Painter::stroke_trail(cairo_t* cr, Color color, std::size_t first, std::size_t last) {
  constexpr int kSteps = 8;
  const auto step = [&](std::size_t i) {
    const double age = (scene_->time - smooth_[i].time) / std::max(scene_->trail_time, 1e-3);
    return std::clamp(static_cast<int>(kSteps * age), 0, kSteps - 1);
  };
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_BEVEL);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_operator(cr, CAIRO_OPERATOR_SOURCE);  // steps replace what they overlap: joints do not add up
  for (const bool casing : {true, false})
    for (std::size_t begin = first; begin < last;) {
      const int age = step(begin);
      cairo_move_to(cr, smooth_[begin].position.x, smooth_[begin].position.y);
      do {
        ++begin;
        cairo_line_to(cr, smooth_[begin].position.x, smooth_[begin].position.y);
      } while (begin < last && step(begin) == age);
      const double fresh = 1 - (age + 0.5) / kSteps;
      cairo_set_line_width(cr, line_ * (0.5 + 0.7 * fresh) + (casing ? std::max(1.0, 0.7 * line_) : 0));
      source(cr, casing ? Color{} : color, (casing ? 0.45 : 0.95) * std::min(1.0, 1.4 * fresh));
      cairo_stroke(cr);
    }
}

void Painter::paint_box(const Object& object, std::vector<Patch>& patches) {
  const double corner = std::min({2 * line_, object.width / 2, object.height / 2});  // radius
  const double casing = std::max(1.0, 0.6 * line_), reach = line_ / 2 + casing + 1;
  const Color color = identity_color(object.id);
  // Strokes the path that is there; `walked`: length of the outline before it, so that dashes join.
  const auto stroke = [&](cairo_t* cr, double walked) {
    const double dashes[] = {5 * line_, 4 * line_}, dots[] = {0.01, 2.6 * line_};
    if (object.look == Look::coasted) cairo_set_dash(cr, dashes, 2, walked);
    if (object.look == Look::stopped) {
      cairo_set_dash(cr, dots, 2, walked);
      cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    }
    cairo_set_line_width(cr, line_ + 2 * casing);
    source(cr, {}, kCasing);
    cairo_stroke_preserve(cr);
    cairo_set_line_width(cr, object.look == Look::stopped ? 1.3 * line_ : line_);
    source(cr, color, object.look == Look::coasted ? 0.85 : 1);
    cairo_stroke(cr);
  };
  const auto outline = [&](cairo_t* cr) {
    rounded_rectangle(cr, object.x, object.y, object.width, object.height, corner);
    stroke(cr, 0);
  };
  const double right = object.x + object.width, bottom = object.y + object.height;
  const double rim = corner + reach;  // the corners lie in the upper and lower strip
  if (object.width < 4 * rim || object.height < 4 * rim) {
    add_patch(patches, frame_, around(object.x, object.y, right, bottom, reach), outline);
    return;
  }
  // Only the rim: a tall person in 4K would otherwise be megabytes of transparency.
  const Area all = around(object.x, object.y, right, bottom, reach);
  const int thick = static_cast<int>(std::ceil(rim + reach)),
            thin = static_cast<int>(std::ceil(2 * reach)) + 1;
  const double bend = corner * std::numbers::pi / 2, side = object.height - 2 * corner;
  add_patch(patches, frame_, {all.x, all.y, all.width, thick}, outline);
  add_patch(patches, frame_, {all.x, all.y + all.height - thick, all.width, thick}, outline);
  const Area left_side{all.x, all.y + thick, thin, all.height - 2 * thick};
  const Area right_side{all.x + all.width - thin, left_side.y, thin, left_side.height};
  add_patch(patches, frame_, right_side, [&](cairo_t* cr) {
    cairo_move_to(cr, right, object.y + corner);
    cairo_line_to(cr, right, bottom - corner);
    stroke(cr, bend);
  });
  add_patch(patches, frame_, left_side, [&](cairo_t* cr) {
    cairo_move_to(cr, object.x, bottom - corner);
    cairo_line_to(cr, object.x, object.y + corner);
    stroke(cr, 3 * bend + side + (object.width - 2 * corner));
  });
}

// How far the target's corners lie outside its box, in widths of a line.
constexpr double kTargetRoom = 2.5;

// A bracket at each corner, thicker than the box and round it; within the frame where that ends there.
void Painter::paint_target(const Object& object, std::vector<Patch>& patches) {
  const double room = kTargetRoom * line_, thick = 1.6 * line_, casing = std::max(1.0, 0.6 * line_);
  const double arm =
      std::clamp(0.25 * std::min(object.width, object.height) + room, 2 * thick, 8 * thick) - thick / 2;
  const double left = std::max(object.x - room, thick), top = std::max(object.y - room, thick),
               right = std::min(object.x + object.width + room, frame_.width - thick),
               bottom = std::min(object.y + object.height + room, frame_.height - thick);
  for (const auto& [x, dx] : {std::pair{left, arm}, {right, -arm}})
    for (const auto& [y, dy] : {std::pair{top, arm}, {bottom, -arm}}) {
      const Area area = around(std::min(x, x + dx), std::min(y, y + dy), std::max(x, x + dx),
                               std::max(y, y + dy), thick + casing);
      add_patch(patches, frame_, area, [&](cairo_t* cr) {
        cairo_move_to(cr, x + dx, y);
        cairo_line_to(cr, x, y);
        cairo_line_to(cr, x, y + dy);
        cairo_set_line_width(cr, thick + 2 * casing);
        source(cr, {}, kCasing);
        cairo_stroke_preserve(cr);
        cairo_set_line_width(cr, thick);
        source(cr, identity_color(object.id));
        cairo_stroke(cr);
      });
    }
}

// The object's label, drawn when its words are new: identity, two bars for stopped, and where `detailed` speed and
// distance.
const Painter::Label& Painter::label(const Object& object, bool detailed) {
  const std::string id = object.id ? std::to_string(object.id) : std::string();
  std::string more;
  if (detailed && scene_->speeds && object.look != Look::stopped && std::isfinite(object.speed))
    more = number(object.speed) + " px/s";
  if (detailed && std::isfinite(object.distance) && object.distance > 0)
    more = (more.empty() ? "" : more + "  ") + number(object.distance) + " m";
  const char look = static_cast<char>('0' + static_cast<int>(object.look));
  const auto [entry, fresh] = labels_.try_emplace(id + look + more);
  entry->second.used = true;
  if (fresh) draw_label(entry->second, identity_color(object.id), object.look, id, more);
  return entry->second;
}

// A pill in the object's colour. Stays empty where there are no words.
void Painter::draw_label(Label& label, Color color, Look look, const std::string& id,
                         const std::string& more) {
  const bool bars = look == Look::stopped;
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
  source(cr, color, look == Look::coasted ? 0.8 : 0.95);
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

// In widths of its box: a crowd of small people is not to vanish behind numbers.
constexpr double kLongestLabel = 3;

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

void Painter::paint_crosshair(std::vector<Patch>& patches) {
  const double cx = frame_.width / 2.0, cy = frame_.height / 2.0;
  const double arm = 0.06 * std::min(frame_.width, frame_.height), hole = 0.3 * arm, reach = 1.5 * line_ + 2;
  const auto draw = [&](cairo_t* cr) {
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      cairo_move_to(cr, cx + dx * hole, cy + dy * hole);
      cairo_line_to(cr, cx + dx * arm, cy + dy * arm);
    }
    cairo_set_line_width(cr, 2.2 * line_);
    source(cr, {}, kCasing);
    cairo_stroke_preserve(cr);
    cairo_set_line_width(cr, line_);
    source(cr, {1, 1, 1});
    cairo_stroke(cr);
    cairo_arc(cr, cx, cy, 0.6 * line_, 0, 2 * std::numbers::pi);
    cairo_fill(cr);
  };
  add_patch(patches, frame_, around(cx - arm, cy - arm, cx + arm, cy + arm, reach), draw);
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

}  // namespace cerberus::draw
