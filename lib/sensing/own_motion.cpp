// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/own_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensing/angles.h"

namespace cerberus::sensing {

namespace {

// Metres to the nearest warm thing beside a way: an assumption. Guarded by bench-pir_search.
constexpr double kNearest = 2;

bool is_in(const Arc& arc, double direction) {
  const double clockwise = wrap(direction - arc.from);
  return (clockwise < 0 ? clockwise + 2 * std::numbers::pi : clockwise) <= arc.width;
}

double known(double value) {
  return std::isfinite(value) ? std::abs(value) : 0;
}

}  // namespace

double passing_rate(const Arc& field, const BodyMotion& motion) {
  constexpr double kAside = std::numbers::pi / 2;
  const bool sees_aside = is_in(field, kAside) || is_in(field, -kAside);
  const double aside =
      sees_aside ? 1 : std::max(std::abs(std::sin(field.from)), std::abs(std::sin(field.from + field.width)));
  return known(motion.yaw_rate) + known(motion.speed) * aside / kNearest;
}

void PulseDoubt::update(Time time, bool high, bool moves) {
  time = std::clamp(time, time_, kNever - kDoubtLinger);  // no sum or difference below overflows
  time_ = time;
  if (moves_)
    moved_ = time;
  else if (high_ && moved_ <= time - kDoubtLinger)
    evidence_ = time;
  if (moves) moved_ = time;
  if (high && !high_) evidence_ = moved_ <= time - kSettle ? time : kLongAgo;
  high_ = high;
  moves_ = moves;
  doubtful_ = high && evidence_ <= time - kDoubtLinger;
}

Time PulseDoubt::due() const {
  if (!high_ || (doubtful_ && moves_)) return kNever;
  if (doubtful_) return moved_ + kDoubtLinger;
  return moves_ || evidence_ < moved_ ? evidence_ + kDoubtLinger : kNever;
}

}  // namespace cerberus::sensing
