// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/dead_time.h"

#include <algorithm>
#include <cmath>

#include "control/following/target_filter.h"

namespace cerberus::control {

namespace {

// Guarded by bench-heads (D) and unit-dead_time.
struct Parameters {
  double kept = 10;       // seconds; derived: a walker turns round every five to ten
  double explained = .5;  // r^2; derived: more of the picture's turn is the head's than is not
  // (radians a second)^2 seconds of reckoned turn. derived: changes of 5 degrees a second over two seconds
  double least = 2 * sensing::radians(5) * sensing::radians(5);
  double pace = .3;  // seconds a second; derived: slower than poses would jump by
};
constexpr Parameters kParameters;

}  // namespace

void DeadTime::Sums::add(double weight, double seen, double reckoned, double keep) {
  const double terms[] = {1, seen, reckoned, seen * seen, seen * reckoned, reckoned * reckoned};
  double* const sums[] = {&n, &z, &d, &zz, &zd, &dd};
  for (std::size_t k = 0; k < std::size(sums); ++k) *sums[k] = *sums[k] * keep + terms[k] * weight;
}

double DeadTime::Sums::explained() const {
  const double var_z = zz - z * z / n, var_d = dd - d * d / n, cov = zd - z * d / n;
  return var_z > 0 && var_d > kParameters.least && cov > 0 ? cov * cov / (var_z * var_d) : 0;
}

void DeadTime::add(motion::Time before, motion::Time taken, double turn, const motion::PoseHistory& reckoned,
                   motion::Time told) {
  const double dt = motion::seconds(taken - before);
  if (!(dt > 0) || dt > TargetFilter::kPause || !std::isfinite(turn)) return;
  const double keep = std::exp(-dt / kParameters.kept);
  double most = kParameters.explained;
  const Sums* best = nullptr;
  motion::Time lag = std::max(-kEarly * kStep, -told / kStep * kStep), found{};
  for (; lag <= kLate * kStep; lag += kStep) {
    Sums& sums = lags_[static_cast<std::size_t>(lag / kStep + kEarly)];
    const double turned = reckoned.at(taken - lag).pan.position - reckoned.at(before - lag).pan.position;
    sums.add(dt, turn / dt, turned / dt, keep);
    if (const double explained = sums.explained(); explained > most) {
      most = explained;
      best = &sums;
      found = lag;
    }
  }
  agrees_ = best && found - late_ <= kStep && late_ - found <= kStep;
  if (!best) return;
  const motion::Time step(static_cast<motion::Time::rep>(kParameters.pace * dt * 1e9));
  late_ += std::clamp(found - late_, -step, step);
}

}  // namespace cerberus::control
