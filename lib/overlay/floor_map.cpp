// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/floor_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "overlay/cairo_helpers.h"
#include "overlay/inset.h"

namespace cerberus::overlay {

namespace {

constexpr double kMargin = .4;     // metres around the outermost walls
constexpr double kLongest = 12;    // metres that the drawn view reaches
constexpr double kRayStep = .05;   // metres: less than a pixel
constexpr int kRays = 60;          // one a degree of a usual lens
constexpr double kWayStep = .1;    // metres between two points of the way
constexpr std::size_t kWay = 600;  // points: the last 60 m

constexpr Color kWall{.12, .13, .15}, kFloor{.93, .92, .88}, kThing{.66, .64, .6}, kRobot{.05, .3, .75},
    kView{1, .75, 0}, kSeen{.85, .1, .1}, kHidden{.45, .45, .45};

struct Drawing {
  SurfacePtr surface;
  ContextPtr cr;
  Drawing(std::uint32_t* words, vision::Size size, std::ptrdiff_t stride)
      : surface(cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(words),
                                                    CAIRO_FORMAT_ARGB32, size.width, size.height,
                                                    static_cast<int>(4 * stride))),
        cr(cairo_create(surface.get())) {}
};

void rectangle(cairo_t* cr, const FloorPlan::Area& area) {
  cairo_rectangle(cr, area.left, area.top, area.right - area.left, area.bottom - area.top);
}

void circle(cairo_t* cr, double x, double y, double radius) {
  cairo_new_sub_path(cr);
  cairo_arc(cr, x, y, radius, 0, 2 * std::numbers::pi);
}

// How far one sees the floor over low furniture: to a wall, a pillar or what is high.
double free_distance(const FloorPlan& plan, double x, double y, double direction) {
  const double dx = std::cos(direction), dy = std::sin(direction);
  double away = 0;
  for (; away < kLongest; away += kRayStep) {
    const double at_x = x + away * dx, at_y = y + away * dy;
    const auto within = [&](const FloorPlan::Area& area) {
      return at_x >= area.left && at_x <= area.right && at_y >= area.top && at_y <= area.bottom;
    };
    const bool pillar = std::ranges::any_of(plan.pillars, [&](const FloorPlan::Pillar& one) {
      return std::hypot(at_x - one.x, at_y - one.y) < one.radius;
    });
    if (pillar || std::ranges::none_of(plan.rooms, within) || std::ranges::any_of(plan.high, within)) break;
  }
  return std::max(0., away - kRayStep);
}

}  // namespace

FloorMap::FloorMap(FloorPlan plan, vision::Size frame) : plan_(std::move(plan)) {
  double right = 0, bottom = 0;
  for (const FloorPlan::Area& room : plan_.rooms) {
    const bool first = &room == &plan_.rooms.front();
    left_ = first ? room.left : std::min(left_, room.left);
    top_ = first ? room.top : std::min(top_, room.top);
    right = first ? room.right : std::max(right, room.right);
    bottom = first ? room.bottom : std::max(bottom, room.bottom);
  }
  left_ -= kMargin, top_ -= kMargin, right += kMargin, bottom += kMargin;
  constexpr double kFine = 100;  // inset_size() takes whole numbers: centimetres
  size_ = inset_size({static_cast<int>(kFine * (right - left_)), static_cast<int>(kFine * (bottom - top_))},
                     frame);
  if (size_.area() == 0) return;
  scale_ = std::min(size_.width / (right - left_), size_.height / (bottom - top_));
  ground_.resize(static_cast<std::size_t>(size_.area()));
  draw_ground();
}

void FloorMap::draw_ground() {
  const Drawing to(ground_.data(), size_, size_.width);
  cairo_t* cr = to.cr.get();
  set_color(cr, kWall);
  cairo_paint(cr);
  cairo_scale(cr, scale_, scale_);
  cairo_translate(cr, -left_, -top_);
  for (const FloorPlan::Area& room : plan_.rooms) rectangle(cr, room);
  set_color(cr, kFloor);
  cairo_fill(cr);
  for (const FloorPlan::Area& thing : plan_.furniture) rectangle(cr, thing);
  for (const FloorPlan::Pillar& pillar : plan_.pillars) circle(cr, pillar.x, pillar.y, pillar.radius);
  set_color(cr, kThing);
  cairo_fill(cr);
}

void FloorMap::draw(const FloorScene& scene, vision::View<std::uint32_t> picture) {
  for (int y = 0; y < size_.height; ++y)
    std::copy_n(ground_.begin() + static_cast<std::ptrdiff_t>(y) * size_.width, size_.width, picture.row(y));
  if (way_.empty() || std::hypot(scene.x - way_.back().x, scene.y - way_.back().y) >= kWayStep)
    way_.push_back({scene.x, scene.y});
  if (way_.size() > kWay) way_.erase(way_.begin());

  const Drawing to(picture.data, size_, picture.stride);
  cairo_t* cr = to.cr.get();
  cairo_scale(cr, scale_, scale_);
  cairo_translate(cr, -left_, -top_);
  const double pixel = 1 / scale_;

  cairo_move_to(cr, scene.x, scene.y);
  for (int i = 0; i <= kRays; ++i) {
    const double direction = scene.view + scene.field_of_view * (static_cast<double>(i) / kRays - .5);
    const double away = free_distance(plan_, scene.x, scene.y, direction);
    cairo_line_to(cr, scene.x + away * std::cos(direction), scene.y + away * std::sin(direction));
  }
  cairo_close_path(cr);
  set_color(cr, kView, .55);
  cairo_fill(cr);

  for (const Point& point : way_) cairo_line_to(cr, point.x, point.y);
  cairo_line_to(cr, scene.x, scene.y);
  cairo_set_line_width(cr, std::max(1.6 * pixel, .08));
  set_color(cr, kRobot, .6);
  cairo_stroke(cr);

  for (const FloorScene::Person& person : scene.people) {
    circle(cr, person.x, person.y, std::max(3 * pixel, .25));
    set_color(cr, person.visible ? kSeen : kHidden);
    cairo_fill(cr);
  }

  // An arrowhead of .8 m that points where the robot drives.
  const double length = std::max(4.5 * pixel, .45);
  constexpr double kTurns[] = {0, 2.5, std::numbers::pi, -2.5}, kShares[] = {1, 1, .4, 1};
  for (int i = 0; i < 4; ++i)
    cairo_line_to(cr, scene.x + kShares[i] * length * std::cos(scene.heading + kTurns[i]),
                  scene.y + kShares[i] * length * std::sin(scene.heading + kTurns[i]));
  cairo_close_path(cr);
  set_color(cr, kRobot);
  cairo_fill(cr);
}

}  // namespace cerberus::overlay
