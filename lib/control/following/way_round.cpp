// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/way_round.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cerberus::control {

namespace {

constexpr WayRound::Parameters kParameters;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kUnmet = std::numeric_limits<double>::infinity();
// A place within this distance of the head was reached.
constexpr double kThere = .05;

// As seen from the side of the target, for which right is positive.
struct Mirrored {
  double target, rate, head, view;
  double stop, other;  // of the target's side, and the other one
};

double wait_time(const Mirrored& m, double speed) {
  const double back = std::max(0.0, (m.stop - m.head) / speed);
  if (m.target + m.rate * kParameters.warning <= m.stop + m.view) return back;
  return m.rate < 0 ? std::max(back, (m.target - m.view - m.stop) / -m.rate) : kUnmet;
}

double round_time(const Mirrored& m, const motion::AxisLimits& limits, double dead_time) {
  const double target = m.target - kTurn;
  if (limits.speed + m.rate <= 0) return kUnmet;
  const double start = limits.speed / (2 * limits.acceleration) + dead_time;
  const double met = std::max(0.0, (m.head - m.view - target) / (limits.speed + m.rate)) + start;
  const double out = m.other - m.view - target;  // of view from the other stop
  if (out <= 0) return met;
  return m.rate > 0 ? std::max(met, out / m.rate) : kUnmet;
}

}  // namespace

bool WayRound::decide(const Situation& now, const motion::AxisLimits& limits) {
  const double side = now.target > limits.to ? 1 : -1;
  const bool goes = active() && side == side_;
  const Mirrored m{side * now.target,
                   side * now.rate,
                   side * now.head,
                   now.view > 0 ? kParameters.seen * now.view / 2 : kParameters.unknown,
                   side > 0 ? limits.to : -limits.from,
                   side > 0 ? limits.from : -limits.to};
  const double wait = wait_time(m, limits.speed), round = round_time(m, limits, now.dead_time);
  if (round > kParameters.longest || wait <= (goes ? kParameters.worth : 1) * round) {
    end();
    return false;
  }
  if (!goes) passed_ = false;
  side_ = side;
  target_ = now.target;
  rate_ = now.rate;
  time_ = now.effect;
  deadline_ = now.effect + round + kParameters.patience;
  return true;
}

std::optional<motion::AxisCommand> WayRound::command(double effect, double head,
                                                     const motion::AxisLimits& limits) {
  if (active() && effect > deadline_) end();
  if (!active()) return std::nullopt;
  const double place = target_ + rate_ * (effect - time_) - side_ * kTurn;
  passed_ = passed_ || side_ * (head - place) < kThere;
  const double goal = passed_ ? (side_ > 0 ? limits.from : limits.to) : limits.clamp(place);
  return motion::AxisCommand{motion::AxisCommand::Kind::position, goal, limits.speed};
}

}  // namespace cerberus::control
