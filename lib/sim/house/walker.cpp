// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/walker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensing/angles.h"

namespace cerberus::sim {
namespace {

constexpr double kStep = .002;                  // seconds
constexpr double kFastest = 4, kHardest = 3;    // metres a second, and a second squared
constexpr double kNear = .06;                   // metres: a place is reached
constexpr double kTurnsAbove = .02;             // metres a second: the heading follows the way
constexpr double kRaise = 1.5;                  // a second: how fast a hand is raised
constexpr double kWave = 2 * std::numbers::pi;  // radians a second

}  // namespace

Walker::Walker(double x, double y, double heading, std::vector<Instruction> instructions,
               const Traits& traits)
    : traits_(traits), instructions_(std::move(instructions)) {
  traits_.acceleration = std::min(traits_.acceleration, kHardest);
  stance_.x = x, stance_.y = y, stance_.heading = heading;
  if (instructions_.empty()) instructions_.push_back({});
}

void Walker::elapse(Time now) {
  for (; done_ + std::chrono::milliseconds(2) <= now; done_ += std::chrono::milliseconds(2)) step();
}

void Walker::next() {
  current_ = (current_ + 1) % instructions_.size();
  in_instruction_ = 0;
}

// With which it passes a place: slower where its way bends.
double Walker::corner_speed(const Instruction& to) const {
  constexpr double kBend = .5, kSlow = .7;  // radians; metres a second
  const Instruction& next = instructions_[(current_ + 1) % instructions_.size()];
  if (next.kind != Instruction::go) return kFastest;
  const double here = std::atan2(to.y - stance_.y, to.x - stance_.x);
  const double then = std::atan2(next.y - to.y, next.x - to.x);
  return std::abs(sensing::wrap(then - here)) > kBend ? kSlow : kFastest;
}

void Walker::go(const Instruction& to) {
  const double x = to.x - stance_.x, y = to.y - stance_.y, away = std::hypot(x, y);
  const double going = std::hypot(way_x_, way_y_);
  const double reached = to.stops ? kNear : std::max(kNear, going * going / (2 * traits_.acceleration));
  if (away <= reached) return next();
  double speed = std::clamp(to.speed, 0., kFastest);
  const double end = to.stops ? 0 : corner_speed(to);
  if (end < speed)
    speed = std::min(speed, std::sqrt(end * end + 2 * traits_.acceleration * std::max(0., away - kNear / 2)));
  const double more_x = x / away * speed - way_x_, more_y = y / away * speed - way_y_;
  const double more = std::hypot(more_x, more_y), most = traits_.acceleration * kStep;
  const double share = more > most ? most / more : 1;
  way_x_ += share * more_x, way_y_ += share * more_y;
}

void Walker::step() {
  const Instruction& now = instructions_[current_];
  in_instruction_ += kStep;
  double towards = stance_.heading;
  if (now.kind == Instruction::go) {
    go(now);
  } else {
    const double going = std::hypot(way_x_, way_y_), most = traits_.acceleration * kStep;
    const double share = going > most ? 1 - most / going : 0;
    way_x_ *= share, way_y_ *= share;
    if (now.kind == Instruction::face) towards = std::atan2(now.y - stance_.y, now.x - stance_.x);
  }
  stance_.speed = std::hypot(way_x_, way_y_);
  if (now.kind != Instruction::face && stance_.speed > kTurnsAbove) towards = std::atan2(way_y_, way_x_);
  const double turn = sensing::wrap(towards - stance_.heading), most_turn = traits_.turn_rate * kStep;
  stance_.heading = sensing::wrap(stance_.heading + std::clamp(turn, -most_turn, most_turn));
  stance_.x += way_x_ * kStep, stance_.y += way_y_ * kStep;

  // A step is .42 of the height at 1.4 m/s and changes with the root of the speed (Grieve, 1968).
  const double step = .42 * traits_.height * std::sqrt(stance_.speed / 1.4);
  const double shorter = .7 * traits_.height;
  stance_.step = std::min(step, shorter);
  if (stance_.step > 0)
    stance_.phase += std::numbers::pi * stance_.speed * kStep / std::max(stance_.step, .1);
  const double hand = now.kind == Instruction::gesture ? 1 : 0, raise = kRaise * kStep;
  stance_.gesture += std::clamp(hand - stance_.gesture, -raise, raise);
  stance_.wave += kWave * kStep;

  const bool waits = now.kind == Instruction::stand || now.kind == Instruction::gesture;
  if (waits && in_instruction_ >= now.seconds) next();
  if (now.kind == Instruction::face && std::abs(turn) < most_turn) next();
}

}  // namespace cerberus::sim
