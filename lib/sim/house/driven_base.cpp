// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/driven_base.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "sim/house/textures.h"

namespace cerberus::sim {
namespace {

constexpr double kStep = .002;  // seconds
constexpr double kFastest = 1.5, kFastestTurn = sensing::radians(60);
constexpr double kPatience = 3;                                 // seconds before what stands in its way
constexpr double kBack = 1;                                     // metres
constexpr double kThere = .005, kAimed = sensing::radians(.2);  // metres, radians

// The speed from which a way so long suffices to brake, which does not pass its end within a step.
double braking(double way, double acceleration) {
  return std::min(std::sqrt(2 * acceleration * way), way / kStep);
}

double approach(double value, double wanted, double most) {
  return value + std::clamp(wanted - value, -most, most);
}

}  // namespace

DrivenBase::DrivenBase(double x, double y, double yaw, std::vector<Leg> legs, const Traits& traits)
    : traits_(traits), legs_(std::move(legs)), x_(x), y_(y), yaw_(yaw) {
  traits_.yaw_rate = std::min(traits_.yaw_rate, kFastestTurn);
  if (legs_.empty()) legs_.push_back({});
  turned_to_ = yaw_ + legs_[0].angle;
}

void DrivenBase::elapse(Time now) {
  for (; done_ + std::chrono::milliseconds(2) <= now; done_ += std::chrono::milliseconds(2)) step();
}

void DrivenBase::next() {
  current_ = (current_ + 1) % legs_.size();
  in_leg_ = waited_ = 0;
  aims_ = true, backs_ = false;
  turned_to_ = yaw_ + legs_[current_].angle;
}

bool DrivenBase::turn(double away) {
  const double most = traits_.yaw_acceleration * kStep;
  const double wanted = std::min(traits_.yaw_rate, braking(std::abs(away), .9 * traits_.yaw_acceleration));
  rate_ = approach(rate_, std::copysign(wanted, away), most);
  if (std::abs(away) > kAimed || std::abs(rate_) > 2 * most) return false;
  rate_ = 0;
  return true;
}

void DrivenBase::wait_or_turn_back() {
  waited_ = blocked_ && speed_ == 0 ? waited_ + kStep : 0;
  if (waited_ < kPatience) return;
  waited_ = 0;
  backs_ = !backs_;
  to_back_ = kBack;
}

void DrivenBase::step() {
  const Leg& leg = legs_[current_];
  in_leg_ += kStep;
  bool done = false;
  const double away_x = leg.x - x_, away_y = leg.y - y_;
  switch (leg.kind) {
    case Leg::wait:
      done = in_leg_ >= leg.seconds;
      break;
    case Leg::turn:
      done = turn(turned_to_ - yaw_);
      break;
    case Leg::drive:
      if (aims_) {
        aims_ = !turn(sensing::wrap(std::atan2(away_y, away_x) - yaw_));
        break;
      }
      wait_or_turn_back();
      // What is left along its heading.
      const double ahead = away_x * std::cos(yaw_) + away_y * std::sin(yaw_);
      const double left = backs_ ? to_back_ : ahead;
      const double most =
          std::min({leg.speed, kFastest, braking(std::max(left, 0.), .9 * traits_.acceleration)});
      const double wanted = blocked_ ? 0 : most;
      speed_ = approach(speed_, backs_ ? -wanted : wanted, traits_.acceleration * kStep);
      done = ahead <= kThere;
      if (done || left <= kThere) speed_ = 0, backs_ = false;
      to_back_ += speed_ * kStep;
      break;
  }
  yaw_ += rate_ * kStep;
  x_ += std::cos(yaw_) * speed_ * kStep, y_ += std::sin(yaw_) * speed_ * kStep;
  if (done) next();
}

Shake::Shake(double rms, double low, double high, std::uint32_t seed)
    : amplitude_(rms * std::sqrt(2. / kSines)) {
  for (std::uint32_t i = 0; i < kSines; ++i) {
    const double share = (i + scramble(seed, i, 1) / 4294967296.) / kSines;
    rate_[i] = 2 * std::numbers::pi * (low + share * (high - low));
    phase_[i] = 2 * std::numbers::pi * (scramble(seed, i, 2) / 4294967296.);
  }
}

double Shake::at(double seconds) const {
  double sum = 0;
  for (int i = 0; i < kSines; ++i) sum += std::sin(rate_[i] * seconds + phase_[i]);
  return amplitude_ * sum;
}

}  // namespace cerberus::sim
