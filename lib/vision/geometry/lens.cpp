// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/lens.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "sensing/angles.h"

namespace cerberus::vision {
namespace {

constexpr double kAhead = 0.05;  // cosine: less than 87 degrees off the axis
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Lens::Lens(double horizontal_fov, Size frame) : frame_(frame) {
  if (horizontal_fov > 0 && horizontal_fov < std::numbers::pi && frame.width > 0 && frame.height > 0)
    focal_ = frame.width / 2.0 / std::tan(horizontal_fov / 2);
}

Lens::Ray Lens::ray(Point p, double tilt) const {
  const double right = (p.x - frame_.width / 2.0) / focal_, up = (frame_.height / 2.0 - p.y) / focal_;
  const double c = std::cos(tilt), s = std::sin(tilt);
  return {right, up * c + s, c - up * s};
}

Direction Lens::direction(Point p, double pan, double tilt) const {
  if (!known()) return {kNan, kNan};
  const Ray r = ray(p, tilt);
  return {sensing::wrap(pan + std::atan2(r.right, r.ahead)), std::atan2(r.up, std::hypot(r.right, r.ahead))};
}

std::optional<Point> Lens::project(const Direction& d, double pan, double tilt) const {
  const double side = d.bearing - pan, level = std::cos(d.elevation);
  const double right = level * std::sin(side), ahead = level * std::cos(side), up = std::sin(d.elevation);
  const double c = std::cos(tilt), s = std::sin(tilt);
  const double depth = ahead * c + up * s;  // the ray in the camera's axes
  if (!known() || !(depth > kAhead)) return std::nullopt;
  return Point{frame_.width / 2.0 + focal_ * right / depth,
               frame_.height / 2.0 - focal_ * (up * c - ahead * s) / depth};
}

Transform Lens::turn(double pan_before, double tilt_before, double pan_after, double tilt_after) const {
  if (!known()) return {};
  // Axes of the camera: right, down, ahead.
  const auto rotation = [](double pan, double tilt) {
    const double cp = std::cos(pan), sp = std::sin(pan), ct = std::cos(tilt), st = std::sin(tilt);
    return Transform{{cp, sp * st, sp * ct, 0, ct, -st, -sp, cp * st, cp * ct}};
  };
  const auto transposed = [](const Transform& t) {
    const auto& m = t.m;
    return Transform{{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}};
  };
  const double f = focal_, x = 0.5 * (frame_.width - 1), y = 0.5 * (frame_.height - 1);
  const Transform camera{{f, 0, x, 0, f, y, 0, 0, 1}}, back{{1 / f, 0, -x / f, 0, 1 / f, -y / f, 0, 0, 1}};
  return camera * (transposed(rotation(pan_after, tilt_after)) * rotation(pan_before, tilt_before)) * back;
}

double Lens::floor_distance(Point p, double tilt, double mounting_height) const {
  if (!known() || !(mounting_height > 0)) return kNan;
  const Ray r = ray(p, tilt);
  if (!(r.up < 0)) return kNan;
  return mounting_height * std::hypot(r.right, r.ahead) / -r.up;
}

Placement Lens::place(const Box& box, double pan, double tilt, double mounting_height) const {
  const double middle = box.x + box.width / 2;
  Placement place{direction({middle, box.y + box.height / 2}, pan, tilt).bearing, kNan, kNan, kNan, kNan};
  if (!known() || !(mounting_height > 0) || box.bottom() > frame_.height - 1) return place;
  const Point foot{middle, box.bottom()};
  const Ray r = ray(foot, tilt);
  if (!(r.up < 0)) return place;
  place.distance = floor_distance(foot, tilt, mounting_height);
  place.metres_per_pixel = mounting_height / -r.up / focal_;
  place.width = box.width * place.metres_per_pixel;
  place.height = mounting_height + place.distance * std::tan(direction({middle, box.y}, pan, tilt).elevation);
  return place;
}

}  // namespace cerberus::vision
