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
constexpr double kCreeps = .25;                 // of its speed: what is slower on the whole is held up
constexpr double kFar = 1e9;                    // metres
constexpr double kTurnsAbove = .02;             // metres a second: the heading follows the way
constexpr double kRaise = 1.5;                  // a second: how fast a hand is raised
constexpr double kWave = 2 * std::numbers::pi;  // radians a second

}  // namespace

Walker::Walker(double x, double y, double heading, std::vector<Instruction> instructions,
               const Traits& traits)
    : traits_(traits), instructions_(std::move(instructions)) {
  traits_.acceleration = std::min(traits_.acceleration, kHardest);
  stance_.x = x, stance_.y = y, stance_.heading = heading;
  origin_ = {x, y};
  if (instructions_.empty()) instructions_.push_back({});
}

void Walker::elapse(Time now) {
  for (; done_ + std::chrono::milliseconds(2) <= now; done_ += std::chrono::milliseconds(2)) step();
}

void Walker::next() {
  if (!detour_.empty()) {
    detour_.erase(detour_.begin());
    returns_ = returns_ && !detour_.empty();
  } else {
    const Instruction& done = instructions_[current_];
    current_ = (current_ + 1) % instructions_.size();
    if (done.kind != Instruction::go || done.stops) {
      origin_ = {stance_.x, stance_.y};
      first_of_way_ = current_;
    }
  }
  in_instruction_ = held_up_ = 0;
  nearest_ = kFar;
}

const Instruction& Walker::then() const {
  if (detour_.size() > 1) return detour_[1];
  return instructions_[detour_.empty() ? (current_ + 1) % instructions_.size() : current_];
}

std::size_t Walker::last_of_way() const {
  std::size_t last = current_;
  for (std::size_t i = 0; i < instructions_.size() && !instructions_[last].stops; ++i)
    last = (last + 1) % instructions_.size();
  return last;
}

Spot Walker::destination() const {
  const Instruction& last = instructions_[last_of_way()];
  return {last.x, last.y};
}

void Walker::follow(const std::vector<Spot>& corners) {
  const double speed = now().speed;
  detour_.clear();
  for (const Spot& corner : corners) detour_.push_back({Instruction::go, corner.x, corner.y, speed});
  held_up_ = 0;
  nearest_ = kFar;
}

void Walker::lead(std::vector<Spot> way) {
  if (!way.empty()) way.pop_back();
  follow(way);
  current_ = last_of_way();
  returns_ = false;
}

void Walker::send_back(const std::vector<Spot>& way) {
  follow(way);
  current_ = first_of_way_;
  returns_ = !way.empty();
}

void Walker::stop_at(const Spot& place) {
  if (place.x != stance_.x) velocity_.x = 0;
  if (place.y != stance_.y) velocity_.y = 0;
  stance_.x = place.x, stance_.y = place.y;
  stance_.speed = std::hypot(velocity_.x, velocity_.y);
}

void Walker::touch(const Spot& place, const Spot& away) {
  const double into = std::min(velocity_.x * away.x + velocity_.y * away.y, 0.);
  velocity_.x -= into * away.x, velocity_.y -= into * away.y;
  stance_.x = place.x, stance_.y = place.y;
  stance_.speed = std::hypot(velocity_.x, velocity_.y);
}

// With which it passes a place: slower where its way bends.
double Walker::corner_speed(const Instruction& to) const {
  constexpr double kBend = .5, kSlow = .7;  // radians; metres a second
  const Instruction& next = then();
  if (next.kind != Instruction::go) return kFastest;
  const double here = std::atan2(to.y - stance_.y, to.x - stance_.x);
  const double then = std::atan2(next.y - to.y, next.x - to.x);
  return std::abs(sensing::wrap(then - here)) > kBend ? kSlow : kFastest;
}

// The velocity with which it goes to a place; nothing: it is there.
std::optional<Spot> Walker::towards(const Instruction& to) {
  const double x = to.x - stance_.x, y = to.y - stance_.y, away = std::hypot(x, y);
  const double going = std::hypot(velocity_.x, velocity_.y);
  const double reached = to.stops ? kNear : std::max(kNear, going * going / (2 * traits_.acceleration));
  if (away <= reached) return std::nullopt;
  double speed = std::clamp(to.speed, 0., kFastest);
  const double nearer = std::max(nearest_ - away, 0.);
  held_up_ = std::max(held_up_ + kStep - nearer / (kCreeps * speed), 0.);
  nearest_ = std::min(nearest_, away);
  const double end = to.stops ? 0 : corner_speed(to);
  if (end < speed)
    speed = std::min(speed, std::sqrt(end * end + 2 * traits_.acceleration * std::max(0., away - kNear / 2)));
  return Spot{x / away * speed, y / away * speed};
}

void Walker::step() {
  const Instruction now = this->now();
  in_instruction_ += kStep;
  double towards = stance_.heading;
  std::optional<Spot> wanted = Spot{};
  if (now.kind == Instruction::go) wanted = this->towards(now);
  if (!wanted) next();
  if (wanted) {
    const double x = wanted->x + aside_.x - velocity_.x, y = wanted->y + aside_.y - velocity_.y;
    const double more = std::hypot(x, y), most = traits_.acceleration * kStep;
    const double share = more > most ? most / more : 1;
    velocity_.x += share * x, velocity_.y += share * y;
  }
  stance_.speed = std::hypot(velocity_.x, velocity_.y);
  if (stance_.speed > kTurnsAbove) towards = std::atan2(velocity_.y, velocity_.x);
  const double turn = sensing::wrap(towards - stance_.heading), most_turn = traits_.turn_rate * kStep;
  stance_.heading = sensing::wrap(stance_.heading + std::clamp(turn, -most_turn, most_turn));
  stance_.x += velocity_.x * kStep, stance_.y += velocity_.y * kStep;

  // A step is .42 of the height at 1.4 m/s and changes with the root of the speed (Grieve, 1968).
  const double step = .42 * traits_.height * std::sqrt(stance_.speed / 1.4);
  const double shorter = .7 * traits_.height;
  stance_.step = std::min(step, shorter);
  if (stance_.step > 0)
    stance_.phase += std::numbers::pi * stance_.speed * kStep / std::max(stance_.step, .1);
  const double hand = now.kind == Instruction::gesture ? 1 : 0, raise = kRaise * kStep;
  stance_.gesture += std::clamp(hand - stance_.gesture, -raise, raise);
  stance_.wave += kWave * kStep;

  if (now.kind != Instruction::go && in_instruction_ >= now.seconds) next();
}

}  // namespace cerberus::sim
