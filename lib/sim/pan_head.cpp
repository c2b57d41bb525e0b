// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/pan_head.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {

using Kind = motion::AxisCommand::Kind;

namespace {

constexpr double kTick = .001;  // seconds

}  // namespace

double PanHead::nearest_speed(double commanded) const {
  const double size = std::min(std::abs(commanded), traits_.speed);
  if (traits_.speeds == 0) return std::copysign(size, commanded);
  return std::copysign(std::round(size / traits_.speed * traits_.speeds) / traits_.speeds * traits_.speed,
                       commanded);
}

double PanHead::true_speed(double commanded) const {
  const double share = std::abs(nearest_speed(commanded)) / traits_.speed;
  return std::copysign(traits_.speed * traits_.table_scale * std::pow(share, traits_.table_exponent),
                       commanded);
}

void PanHead::command(const motion::AxisCommand& command, Time now) {
  Coming coming{motion::seconds(now) + traits_.dead_time, command};
  if (traits_.jitter > 0)
    coming.due += std::uniform_real_distribution<>(-traits_.jitter, traits_.jitter)(random_);
  const bool to = command.kind == Kind::position;
  if (to && (traits_.turns_only || !(command.speed > 0))) coming.command = {};
  coming_.push_back(coming);
}

double PanHead::wanted_speed() const {
  if (command_.kind == Kind::velocity) return true_speed(command_.value);
  if (command_.kind != Kind::position) return 0;
  const double way = command_.value - motor_, size = std::abs(way);
  return std::copysign(
      std::min({command_.speed, traits_.speed, std::sqrt(2 * traits_.acceleration * size), size / kTick}),
      way);
}

void PanHead::elapse(Time until) {
  const double end = motion::seconds(until);
  while (time_ + kTick / 2 < end) {
    while (!coming_.empty() && coming_.front().due <= time_) {
      command_ = coming_.front().command;
      coming_.pop_front();
    }
    const double most = traits_.acceleration * kTick;
    speed_ += std::clamp(wanted_speed() - speed_, -most, most);
    motor_ += speed_ * kTick;
    camera_ = std::clamp(camera_, motor_ - traits_.play / 2, motor_ + traits_.play / 2);
    time_ += kTick;
  }
}

double PanHead::camera() const {
  return traits_.step > 0 ? std::round(camera_ / traits_.step) * traits_.step : camera_;
}

bool PanHead::busy() const {
  return speed_ != 0 || command_.kind == Kind::velocity || !coming_.empty();
}

}  // namespace cerberus::sim
