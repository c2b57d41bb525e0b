// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "overlay/cairo_helpers.h"

namespace cerberus::overlay {

namespace {

constexpr std::array<Color, 8> kPalette = {{{1, 1, 1},
                                            {0.902, 0.624, 0.000},    // orange
                                            {0.337, 0.706, 0.914},    // sky blue
                                            {0.000, 0.690, 0.510},    // bluish green, a little lighter
                                            {0.941, 0.894, 0.259},    // yellow
                                            {0.150, 0.520, 0.850},    // blue, lighter: on dark pictures
                                            {0.900, 0.420, 0.100},    // vermilion
                                            {0.860, 0.520, 0.700}}};  // reddish purple

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

}  // namespace

Color identity_color(std::uint32_t id) {
  return id == 0 ? kPalette[0] : kPalette[1 + (id - 1) % 7];
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
void Painter::paint_trail(const Trails::Trail& trail, std::vector<Patch>& patches) {
  constexpr std::ptrdiff_t kReach = 3;
  const auto& points = trail.points;
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  smooth_.clear();
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t reach = std::min({kReach, i, n - 1 - i});
    TrailPoint mean{{0, 0}, points[i].time};
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
    if (object.state == ObjectState::coasted) cairo_set_dash(cr, dashes, 2, walked);
    if (object.state == ObjectState::stopped) {
      cairo_set_dash(cr, dots, 2, walked);
      cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    }
    cairo_set_line_width(cr, line_ + 2 * casing);
    source(cr, {}, kCasing);
    cairo_stroke_preserve(cr);
    cairo_set_line_width(cr, object.state == ObjectState::stopped ? 1.3 * line_ : line_);
    source(cr, color, object.state == ObjectState::coasted ? 0.85 : 1);
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

}  // namespace cerberus::overlay
