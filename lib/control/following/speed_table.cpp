// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/speed_table.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace cerberus::control {

namespace {

constexpr SpeedTable::Parameters kParameters;

constexpr double kGate = 3;  // sigma; the usual three
constexpr double kLeast =
    3;  // turn of a frame, in deviations of the picture: below it its logarithm is of noise

}  // namespace

void SpeedTable::reset(const motion::SpeedMap& known, double fastest) {
  *this = {};
  known_ = map_ = known;
  fastest_ = fastest;
  aa_ = bb_ = kParameters.unknown * kParameters.unknown;
}

double SpeedTable::actual(double commanded) const {
  // At its full speed a head that differs by more has another lens than is told.
  constexpr double kMost = kGate * kParameters.unknown;
  return known_.actual(commanded) *
         std::exp(std::clamp(a_, -kMost, kMost) + b_ * std::log(commanded / fastest_));
}

void SpeedTable::add(double dt, double reckoned, double seen) {
  const Parameters& p = kParameters;
  if (!(dt > 0) || !(fastest_ > 0) || !(reckoned * seen > 0)) return;
  const double commanded = std::abs(map_.command_for(reckoned)), turn = std::abs(reckoned) * dt;
  if (std::min(turn, std::abs(seen) * dt) < kLeast * p.picture || !(commanded > 0)) return;
  const double most = p.unknown * p.unknown, grown = most * dt / p.memory;
  aa_ = std::min(most, aa_ + grown);
  bb_ = std::min(most, bb_ + grown);
  const double x = std::log(commanded / fastest_);
  const double innovation = std::log(std::abs(seen) / actual(commanded));
  const double pa = aa_ + ab_ * x, pb = ab_ + bb_ * x;  // P H^T
  const double noise = p.picture * p.picture / (turn * turn) + p.error * p.error;
  const double s = pa + pb * x + noise;
  if (!(innovation * innovation < kGate * kGate * s)) return;
  const double ka = pa / s, kb = pb / s;
  a_ += ka * innovation;
  b_ += kb * innovation;
  aa_ -= ka * pa;
  ab_ -= ka * pb;
  bb_ -= kb * pb;
}

bool SpeedTable::changed() {
  bool differs = false;
  for (int k = 0; k < kPoints; ++k) {
    const double commanded = std::ldexp(fastest_, -k);
    differs = differs || std::abs(std::log(actual(commanded) / map_.actual(commanded))) > kParameters.changed;
  }
  if (!differs) return false;
  std::vector<motion::SpeedPoint> points;
  for (int k = kPoints; k-- > 0;) {
    const double commanded = std::ldexp(fastest_, -k);
    points.push_back({commanded, actual(commanded)});
  }
  if (!motion::SpeedMap::is_valid(points)) return false;
  map_ = motion::SpeedMap(std::move(points));
  return true;
}

}  // namespace cerberus::control
