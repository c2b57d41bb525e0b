// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/sectors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensing/angles.h"

namespace cerberus::sensing {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kTouch = 1e-6;  // rad: tolerance for the rounding of bearings given in decimal degrees

// Returns the clockwise angle from the arc's start to a direction, [0, 2 pi); 0 also for kTouch before the start.
double offset(const Arc& arc, double direction) {
  double clockwise = wrap(direction - arc.from);
  if (clockwise < 0) clockwise += kTurn;
  return clockwise > kTurn - kTouch ? 0 : clockwise;
}

}  // namespace

Geometry::Geometry() {
  const std::array<double, 3> paper{0, radians(-120), radians(120)};
  set(paper, radians(120));
}

bool Geometry::set(std::span<const double> bearings, double field_of_view) {
  std::array<double, kMaxSensors> fields{};
  fields.fill(field_of_view);
  return set(bearings, std::span(fields).first(std::min(bearings.size(), fields.size())));
}

bool Geometry::set(std::span<const double> bearings, std::span<const double> fields_of_view) {
  if (bearings.empty() || bearings.size() > kMaxSensors || fields_of_view.size() != bearings.size())
    return false;
  const auto sees = [](double field) { return field > 0 && field <= kTurn + kTouch; };  // false for NaN
  if (!std::ranges::all_of(fields_of_view, sees)) return false;
  if (!std::ranges::all_of(bearings, [](double bearing) { return std::isfinite(bearing); })) return false;
  bearings_ = fields_of_view_ = {};
  std::ranges::transform(bearings, bearings_.begin(), wrap);
  std::ranges::transform(fields_of_view, fields_of_view_.begin(),
                         [](double field) { return std::min(field, kTurn); });
  count_ = static_cast<int>(bearings.size());
  return true;
}

Arc Geometry::sector(int sensor) const {
  const double width = field_of_view(sensor);
  return {wrap(bearing(sensor) - width / 2), width};
}

// Every part of the intersection begins at the start of a sector, so each sector's start is tried.
Arcs overlap(const Geometry& geometry, SensorBits fired) {
  Arcs found;
  for (int i = 0; i < geometry.count(); ++i) {
    if (!(fired >> i & 1)) continue;
    Arc part = geometry.sector(i);
    const bool known = std::ranges::any_of(
        found, [&](const Arc& other) { return std::abs(wrap(other.from - part.from)) < kTouch; });
    if (known || (part.width >= kTurn && found.count > 0)) continue;
    bool common = true;
    for (int j = 0; j < geometry.count() && common; ++j) {
      if (!(fired >> j & 1) || j == i) continue;
      const Arc other = geometry.sector(j);
      const double start = offset(other, part.from);
      common = other.width >= kTurn || start <= other.width + kTouch;
      if (other.width < kTurn) part.width = std::min(part.width, std::max(0.0, other.width - start));
    }
    if (common) found.push(part);
  }
  return found;
}

}  // namespace cerberus::sensing
