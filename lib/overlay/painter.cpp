// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "overlay/cairo_helpers.h"
#include "overlay/marks/radar.h"
#include "overlay/marks/target_marks.h"

namespace cerberus::overlay {

namespace {

// Longest label in widths of its box, so that labels do not hide a crowd of small people.
constexpr double kLongestLabel = 3;
constexpr double kCrosshairCasing = 0.6;  // opacity

// Returns the part of the object inside the frame: coordinates from other elements may exceed the range of integers.
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

// The rims of boxes begin at even pixels, where samples of chroma begin, and are a number of small vectors wide.
constexpr int kGrid = 4;

int rounded_up(int value, int multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

bool looks_alike(const Object& a, const Object& b) {
  return a.id == b.id && a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height &&
         a.state == b.state && a.target == b.target;
}

}  // namespace

double automatic_line_width(vision::Size frame) {
  return 1.3 * std::pow(std::max(std::min(frame.width, frame.height), 60) / 240.0, 0.7);
}

void Painter::reset() {
  labels_.clear();
  boxes_.clear();
  panel_.clear();
  crosshair_ = {};
}

void Painter::paint(const Scene& scene, std::vector<Patch>& patches) {
  scene_ = &scene;
  const double line = scene.line_width > 0 ? scene.line_width : automatic_line_width(scene.frame);
  const Area frame{0, 0, scene.frame.width, scene.frame.height};
  if (frame != frame_ || line != line_) reset();
  frame_ = frame;
  line_ = line;
  font_ = 9.5 * std::pow(std::max(std::min(frame_.width, frame_.height), 120) / 240.0, 0.6);
  taken_.assign(scene.covered.begin(), scene.covered.end());
  const Patch radar = scene.radar.field_of_view > 0 ? draw_radar(scene.radar, frame_, pool_) : Patch();
  if (radar.pixels) taken_.push_back(radar.area);
  objects_.clear();
  for (const Object& object : scene.objects)
    if (const auto inside = clipped(object, frame_)) objects_.push_back(*inside);
  for (const auto& trail : scene.trails)
    trail_line_.draw(trail, {scene.time, scene.trail_time, line_}, frame_, pool_, patches);
  for (auto& entry : boxes_) entry.second.used = false;
  if (scene.boxes)
    for (const Object& object : objects_) paint_box(object, patches);
  std::erase_if(boxes_, [](const auto& entry) { return !entry.second.used; });
  labels_.begin(font_, pool_);
  if (scene.ids)
    for (const Object& object : objects_) paint_label(object, patches);
  labels_.end();
  if (scene.crosshair) paint_crosshair(patches);
  if (const Patch& panel = panel_.patch(scene.system, font_, frame_, pool_); panel.pixels)
    patches.push_back(panel);
  if (radar.pixels) patches.push_back(radar);
  scene_ = nullptr;
}

void Painter::paint_box(const Object& object, std::vector<Patch>& patches) {
  Box& box = boxes_[object.id];
  box.used = true;
  if (box.patches.empty() || !looks_alike(box.object, object)) {
    box.object = object;
    box.patches.clear();
    draw_box(object, box.patches);
    if (object.target) draw_target_marks(object, line_, frame_, pool_, box.patches);
  }
  patches.insert(patches.end(), box.patches.begin(), box.patches.end());
}

void Painter::draw_box(const Object& object, std::vector<Patch>& patches) {
  const LineStyle style = object.state == ObjectState::coasted   ? LineStyle::dashed
                          : object.state == ObjectState::stopped ? LineStyle::dotted
                                                                 : LineStyle::solid;
  const Outline outline(object.x, object.y, object.width, object.height, line_, style,
                        identity_color(object.id));
  const auto add = [&](const Area& wanted) {
    const Area area = wanted.intersection(frame_);
    if (area.empty()) return;
    const PicturePtr picture = pool_.take_unwritten(area.width, area.height);
    outline.draw(area, picture->view());
    patches.push_back({area, picture});
  };
  const double right = object.x + object.width, bottom = object.y + object.height;
  Area all = Area::around(object.x, object.y, right, bottom, outline.reach()).even();
  all.width = rounded_up(all.width, kGrid);
  // Only the rim of a large box is drawn: the inside of a tall person's box in 4K would be megabytes of transparent
  // pixels. Of a small one four patches would cost more than its inside.
  const double inner = outline.inner_reach();
  const auto thick = [&](double from, double to, int grid) {
    return rounded_up(static_cast<int>(std::ceil(to - from)), grid);
  };
  const int above = thick(all.y, object.y + inner, 2), below = thick(bottom - inner, all.y + all.height, 2);
  const int before = thick(all.x, object.x + inner, kGrid),
            behind = thick(right - inner, all.x + all.width, kGrid);
  const int middle = all.height - above - below;
  if (all.width < 2 * (before + behind) || all.height < 2 * (above + below)) return add(all);
  add({all.x, all.y, all.width, above});
  add({all.x, all.y + all.height - below, all.width, below});
  add({all.x + all.width - behind, all.y + above, behind, middle});
  add({all.x, all.y + above, before, middle});
}

bool Painter::is_free(const Area& area) const {
  return area.y >= 0 && area.y + area.height <= frame_.height &&
         std::none_of(taken_.begin(), taken_.end(),
                      [&](const Area& t) { return !t.intersection(area).empty(); });
}

// Places the label above the box, below it, or inside its top: the first place in the frame that overlaps no other
// label. If there is none for the long label, the short one is tried.
void Painter::paint_label(const Object& object, std::vector<Patch>& patches) {
  const int gap =
      static_cast<int>(std::ceil(scene_->boxes && object.target ? (kTargetRoom + 1) * line_ : line_));
  const int top = static_cast<int>(std::lround(object.y));
  const int bottom = static_cast<int>(std::lround(object.y + object.height));
  std::shared_ptr<const Picture> chosen;
  Area area;
  bool found = false;
  for (const bool detailed : {true, false}) {
    chosen = labels_.label(object, detailed, scene_->speeds);
    if (!chosen || (detailed && chosen->width > kLongestLabel * object.width)) continue;
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
  if (!chosen || area.width > frame_.width || area.height > frame_.height) return;
  if (!found) area.y = std::clamp(top - area.height - gap, 0, frame_.height - area.height);
  taken_.push_back(area);
  patches.push_back({area, chosen});
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
    set_color(cr, {}, kCrosshairCasing);
    cairo_stroke_preserve(cr);
    cairo_set_line_width(cr, line_);
    set_color(cr, {1, 1, 1});
    cairo_stroke(cr);
    cairo_arc(cr, cx, cy, 0.6 * line_, 0, 2 * std::numbers::pi);
    cairo_fill(cr);
  };
  if (!crosshair_.pixels)
    crosshair_ =
        drawn_patch(pool_, frame_, Area::around(cx - arm, cy - arm, cx + arm, cy + arm, reach), draw);
  if (crosshair_.pixels) patches.push_back(crosshair_);
}

}  // namespace cerberus::overlay
