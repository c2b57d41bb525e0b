// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/search/seen_around.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensing/angles.h"

namespace cerberus::fusion {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

double SeenAround::middle(int cell) {
  return (cell + .5) * kTurn / kCells;
}

void SeenAround::see(Time time, double pan, double lens, double yaw_rate) {
  if (time_ == kLongAgo)
    seen_.fill(time - kForgotten);
  else if (std::isfinite(yaw_rate))
    yaw_ = sensing::wrap(yaw_ + yaw_rate * std::chrono::duration<double>(time - time_).count());
  time_ = time;
  const double reach = std::max(lens, kTurn / kCells) / 2;
  for (int cell = 0; cell < kCells; ++cell)
    if (std::abs(sensing::wrap(middle(cell) - yaw_ - pan)) <= reach)  // false for NaN
      seen_[static_cast<unsigned>(cell)] = time;
}

SeenAround::Unseen SeenAround::unseen(const sensing::Interval& pans, Time old) const {
  constexpr double kHalfCell = kTurn / kCells / 2;
  Unseen unseen{{pans.to, pans.from}, Time::zero()};
  int cells = 0;
  bool missed = false;
  for (int cell = 0; cell < kCells; ++cell) {
    const double pan = pans.middle() + sensing::wrap(middle(cell) - yaw_ - pans.middle());
    if (!pans.holds(pan)) continue;
    const Time age = time_ - seen_[static_cast<unsigned>(cell)];
    missed = missed || age > kMissed;
    unseen.age += std::min(age, kForgotten);
    ++cells;
    if (age < old) continue;
    unseen.part.from = std::max(pans.from, std::min(unseen.part.from, pan - kHalfCell));
    unseen.part.to = std::min(pans.to, std::max(unseen.part.to, pan + kHalfCell));
  }
  if (cells > 0) unseen.age /= cells;
  if (missed) unseen.age = kForgotten;
  return unseen;
}

}  // namespace cerberus::fusion
