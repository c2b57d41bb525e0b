// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/radar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "overlay/cairo_helpers.h"
#include "sensing/angles.h"

namespace cerberus::overlay {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kWidest = kTurn / 6;  // of a sector, to one side
constexpr double kRadius = .13;        // shares of the frame's smaller side
constexpr double kLeast = 12;          // pixels: a smaller radar cannot be read
constexpr Color kRed{1, .15, .1}, kBlue{.3, .5, 1}, kGray{.6, .6, .6}, kView{1, .8, 0}, kWhite{1, 1, 1};

struct Middle {
  double x, y, radius;
};

// Clockwise from up, as bearings are from ahead.
double angle(double bearing) {
  return bearing - kTurn / 4;
}

void sector(cairo_t* cr, const Middle& at, double from, double to, double radius) {
  cairo_new_path(cr);
  cairo_move_to(cr, at.x, at.y);
  cairo_arc(cr, at.x, at.y, radius, angle(from), angle(to));
  cairo_close_path(cr);
}

void draw_sensor(cairo_t* cr, const Middle& at, const RadarSensor& sensor) {
  const double gap = 1 / at.radius;  // half a pixel on both sides, at the rim
  sector(cr, at, sensor.bearing - sensor.left + gap, sensor.bearing + sensor.right - gap, at.radius);
  if (sensor.reading == 1)
    set_color(cr, kRed, sensor.doubtful ? .25 : .75);
  else
    set_color(cr, sensor.reading == 0 ? kBlue : kGray, .25);
  cairo_fill(cr);
}

void draw_object(cairo_t* cr, const Middle& at, const RadarObject& object) {
  const double away = std::clamp(object.distance / kRadarReach, 0., 1.) * at.radius;
  const double x = at.x + away * std::cos(angle(object.bearing)),
               y = at.y + away * std::sin(angle(object.bearing));
  const double dot = std::max(2., .09 * at.radius);
  const auto disc = [&](double radius, const Color& color) {
    cairo_new_path(cr);
    cairo_arc(cr, x, y, radius, 0, kTurn);
    set_color(cr, color);
    cairo_fill(cr);
  };
  if (object.target) disc(1.6 * dot, kWhite);
  disc(1.2 * dot, {});
  disc(dot, identity_color(object.id));
}

}  // namespace

void divide_round(std::span<RadarSensor> sensors) {
  for (RadarSensor& one : sensors) {
    one.left = one.right = kWidest;
    for (const RadarSensor& other : sensors) {
      const double away = sensing::wrap(other.bearing - one.bearing);
      if (away > 0) one.right = std::min(one.right, away / 2);
      if (away < 0) one.left = std::min(one.left, -away / 2);
    }
  }
}

RadarObject radar_object(const Object& object, double pan, const vision::Lens& lens) {
  const vision::Point middle{object.x + object.width / 2, lens.frame().height / 2.};
  const double feet = std::clamp((object.y + object.height) / lens.frame().height, 0., 1.);
  return {object.id,
          std::isfinite(object.bearing) ? pan + object.bearing : lens.direction(middle, pan, 0).bearing,
          std::isfinite(object.distance) ? object.distance : (.95 - .65 * feet) * kRadarReach, object.target};
}

Patch draw_radar(const Radar& radar, Area frame, PicturePool& pool) {
  const double side = std::min(frame.width, frame.height), radius = kRadius * side;
  if (radius < kLeast) return {};
  const double edge = .02 * frame.width, rim = .1 * radius;
  const Middle at{edge + radius + rim, frame.height - edge - radius - rim, radius};
  const Area area =
      Area::around(at.x - radius - rim, at.y - radius - rim, at.x + radius + rim, at.y + radius + rim, 0);
  return drawn_patch(pool, frame, area, [&](cairo_t* cr) {
    cairo_arc(cr, at.x, at.y, radius + rim, 0, kTurn);
    set_color(cr, {}, .6);
    cairo_fill(cr);
    for (const RadarSensor& sensor : radar.sensors) draw_sensor(cr, at, sensor);
    sector(cr, at, radar.pan - radar.field_of_view / 2, radar.pan + radar.field_of_view / 2, radius);
    set_color(cr, kView, .6);
    cairo_fill(cr);
    set_color(cr, kWhite, .5);
    cairo_set_line_width(cr, std::max(1., .02 * radius));
    for (const double share : {.5, 1.}) {
      cairo_new_path(cr);
      cairo_arc(cr, at.x, at.y, share * radius, 0, kTurn);
      cairo_stroke(cr);
    }
    for (const RadarObject& object : radar.objects) draw_object(cr, at, object);
  });
}

}  // namespace cerberus::overlay
