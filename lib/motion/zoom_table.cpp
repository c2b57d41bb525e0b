// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/zoom_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

namespace cerberus::motion {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Takes a number off the text; false: there is none.
bool take_number(std::string_view& text, double& number) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return std::isfinite(number);
}

}  // namespace

std::string ZoomTable::parse(const std::string& text) {
  constexpr std::size_t kMost = 64;
  std::vector<Point> points;
  const std::string wrong =
      "\"" + text + "\" is no zoom table: write positions (0 to 2) and degrees, '0 60; 0.5 20; 1 3.2', ";
  for (std::string_view rest = text; !rest.empty();) {
    double position = 0, degrees = 0;
    if (!take_number(rest, position) || !take_number(rest, degrees) || (!rest.empty() && rest[0] != ';'))
      return wrong + "with a point in numbers";
    if (!rest.empty()) rest.remove_prefix(1);
    if (!(position >= 0 && position <= kMostZoom) || !(degrees >= 0.1 && degrees <= 179))
      return wrong + "the field of view 0.1 to 179";
    const Point point{position, std::tan(degrees * kDegree / 2)};
    if (!points.empty() &&
        (point.position <= points.back().position || point.tangent >= points.back().tangent))
      return wrong + "positions rising, fields of view falling";
    points.push_back(point);
  }
  if (points.size() == 1 || points.size() > kMost) return wrong + "2 to 64 of them";
  points_ = std::move(points);
  return {};
}

double ZoomTable::field_of_view(double position) const {
  if (points_.empty()) return 0;
  const auto above = std::ranges::upper_bound(points_, position, {}, &Point::position);
  const Point& b = above == points_.end() ? points_.back() : *above;
  const Point& a = above == points_.begin() || above == points_.end() ? b : *(above - 1);
  const double share = b.position > a.position ? (position - a.position) / (b.position - a.position) : 0;
  return 2 * std::atan(a.tangent * std::pow(b.tangent / a.tangent, share));
}

double ZoomTable::position_for(double field_of_view) const {
  if (points_.empty()) return 0;
  const double tangent = std::tan(field_of_view / 2);
  if (!(tangent < points_.front().tangent)) return points_.front().position;
  if (tangent <= points_.back().tangent) return points_.back().position;
  const auto below = std::ranges::find_if(points_, [&](const Point& p) { return p.tangent < tangent; });
  const Point &a = *(below - 1), &b = *below;
  return a.position +
         (b.position - a.position) * std::log(tangent / a.tangent) / std::log(b.tangent / a.tangent);
}

}  // namespace cerberus::motion
