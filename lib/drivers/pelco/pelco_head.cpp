// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/pelco/pelco_head.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using sensing::degrees;
using sensing::radians;

// The nearest step of a straight line from 0 to `fastest` degrees a second.
int step_of(const AxisCommand& command, double fastest) {
  if (command.kind != AxisCommand::Kind::velocity || !std::isfinite(command.value)) return 0;
  const double step = degrees(command.value) / fastest * pelco::kMostStep;
  return static_cast<int>(std::lround(std::clamp<double>(step, -pelco::kMostStep, pelco::kMostStep)));
}

// A head at its stop, or beyond it, that would go on outwards.
bool outwards(double angle, int step, const motion::AxisLimits& axis) {
  return (step > 0 && angle >= axis.to) || (step < 0 && angle <= axis.from);
}

}  // namespace

std::string PelcoHead::open(const HeadSetup& setup, Time now) {
  limits_ = setup.limits;
  if (options_.address < 1 || options_.address > 255) return "a Pelco-D address is 1 to 255";
  if (!(options_.pan_speed > 0) || !(options_.tilt_speed > 0))
    return "pan-speed and tilt-speed must be more than 0";
  tried_ = now;
  if (std::string wrong = stream_.open(options_.device, options_.baud); !wrong.empty()) return wrong;
  connected_ = true;
  stop(now);
  return {};
}

HeadAbilities PelcoHead::abilities() const {
  return {.position = false, .velocity = true, .feedback = options_.feedback, .rate = kRate};
}

void PelcoHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  int p = step_of(pan, options_.pan_speed), t = step_of(tilt, options_.tilt_speed);
  if (pan_degrees_ && outwards(radians(*pan_degrees_), p, limits_.pan)) p = 0;
  if (tilt_degrees_ && outwards(radians(*tilt_degrees_), t, limits_.tilt)) t = 0;
  if (p == pan_ && t == tilt_) return;
  if (p == 0 && t == 0) return stop(now);
  stops_owed_ = 0;
  pan_ = p;
  tilt_ = t;
  sent_ = now;
  send(pelco::drive(options_.address, pan_, tilt_));
}

void PelcoHead::limit(const motion::Limits& limits, Time) {
  limits_ = limits;
}

void PelcoHead::stop(Time now) noexcept {
  pan_ = tilt_ = 0;
  stops_owed_ = kStops - 1;
  sent_ = now;
  send(pelco::drive(options_.address, 0, 0));
}

void PelcoHead::read(Time now) {
  std::vector<std::uint8_t> bytes;
  while (stream_.read(bytes)) {
    answers_.append(bytes);
    bytes.clear();
  }
  while (const auto position = answers_.take()) {
    if (position->address != options_.address) continue;
    (position->axis == pelco::Axis::pan ? pan_degrees_ : tilt_degrees_) = position->degrees;
    new_pose_ = pan_degrees_ && tilt_degrees_;
    pan_time_ = now;
    if ((pan_degrees_ && outwards(radians(*pan_degrees_), pan_, limits_.pan)) ||
        (tilt_degrees_ && outwards(radians(*tilt_degrees_), tilt_, limits_.tilt)))
      stop(now);
  }
}

Time PelcoHead::tick(Time now) {
  if (!stream_.is_open()) {
    if (std::exchange(connected_, false)) tried_ = now;  // reported before it is tried again
    fault_ = "the Pelco-D head at " + options_.device + " is gone";
    if (now - tried_ < kReconnect) return tried_ + kReconnect;
    tried_ = now;
    if (!stream_.open(options_.device, options_.baud).empty()) return now + kReconnect;
    connected_ = true;
    pan_time_ = now;
    stop(now);  // it stands until the next move
  }
  read(now);
  if (!stream_.is_open()) return now;
  // A head that is limited by its own positions must report them.
  const bool silent = options_.feedback && pan_degrees_ && now - pan_time_ > kSilence;
  if (silent && fault_.empty()) {
    fault_ = "the Pelco-D head at " + options_.device + " does not answer";
    stop(now);
  }
  if (!silent) fault_.clear();
  const Time again = stops_owed_ > 0 ? Time(kStopAgain) : Time(kRepeat);
  if ((stops_owed_ > 0 || pan_ != 0 || tilt_ != 0) && now - sent_ >= again) {
    if (stops_owed_ > 0) --stops_owed_;
    sent_ = now;
    send(pelco::drive(options_.address, pan_, tilt_));
  } else if (options_.feedback && now - asked_ >= kRepeat / 2) {
    asked_ = now;
    send(pelco::position_query(options_.address, next_query_));
    next_query_ = next_query_ == pelco::Axis::pan ? pelco::Axis::tilt : pelco::Axis::pan;
  }
  return now + kStopAgain;
}

std::optional<PoseLine> PelcoHead::take_pose(Time now) {
  if (!std::exchange(new_pose_, false)) return std::nullopt;
  return PoseLine{
      {radians(*pan_degrees_), 0, 0}, {radians(*tilt_degrees_), 0, 0}, motion::seconds(now - pan_time_)};
}

void PelcoHead::watch(std::vector<pollfd>& fds) const {
  if (stream_.is_open()) fds.push_back({stream_.fd(), POLLIN, 0});
}

}  // namespace cerberus::drivers
