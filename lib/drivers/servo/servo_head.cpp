// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/servo/servo_head.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "drivers/transport/exclusive.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::AxisLimits;

constexpr int kLastPulse =
    2;  // periods with the width 0 before the output is disabled: the pulse that ran has ended
constexpr std::chrono::milliseconds kReport{40};

// The PWM chips of this machine, for messages.
std::string chips() {
  std::string list;
  std::error_code ignored;
  for (std::filesystem::directory_iterator it("/sys/class/pwm", ignored), end; !ignored && it != end;
       it.increment(ignored))
    list.append(list.empty() ? "" : ", ").append(it->path().filename().string());
  return list.empty() ? "This machine has none: is the overlay for it enabled?" : "There are: " + list + ".";
}

}  // namespace

ServoHead::~ServoHead() {
  if (!options_.release_delay) return;  // "never" holds beyond the end of this process
  for (Axis* axis : {&pan_, &tilt_}) {
    axis->channel.set_width(Time::zero());
    axis->channel.enable(false);
  }
}

std::string ServoHead::open_axis(const char* name, Axis& axis, std::chrono::milliseconds patience) {
  if (!axis.there()) return {};
  std::string step;
  const int error = axis.channel.open(options_.chip, axis.options.channel, options_.period, patience, step);
  axis.enabled = false;
  axis.width = Time::zero();
  axis.error = 0;
  if (error == 0) return {};
  const std::string what =
      "channel " + std::to_string(axis.options.channel) + " of the PWM chip " + options_.chip;
  if (error == EACCES || error == EPERM)
    return "no permission to write " + step + ": add the user to the group gpio, or let a udev rule allow it";
  if (!std::filesystem::exists(options_.chip))
    return "there is no PWM chip " + options_.chip + ". " + chips();
  if (error == EALREADY)
    return what + " (" + name + ") is driven by " + program_with(step) + ": end that first";
  if (error == EBUSY) return what + " (" + name + ") is used by the kernel or has another period";
  return what + " (" + name + ") cannot be used (" + step + ": " + std::strerror(error) +
         "): has the chip that channel?";
}

void ServoHead::set_limits(Axis& axis, const AxisLimits& limits) {
  const AxisLimits reach = axis.options.reach();
  axis.limits = limits;
  axis.limits.from = std::clamp(limits.from, reach.from, reach.to);
  axis.limits.to = std::clamp(limits.to, reach.from, reach.to);
  if (axis.options.slew > 0) axis.limits.speed = std::min(limits.speed, axis.options.slew);
}

std::string ServoHead::check() const {
  Axis pan, tilt;
  pan.options = options_.pan;
  tilt.options = options_.tilt;
  if (!pan.there() && !tilt.there())
    return "servo-pwm drives no servo: name the channel of an axis (pan='channel=0')";
  if (pan.there() && tilt.there() && options_.pan.channel == options_.tilt.channel)
    return "pan and tilt have the same channel, " + std::to_string(options_.pan.channel) +
           ": each servo has its own";
  for (const ServoAxisOptions* axis : {&options_.pan, &options_.tilt})
    if (axis->channel >= 0 && axis->longest >= options_.period)
      return "a pulse of " + std::to_string(axis->longest.count() / 1000) +
             " microseconds does not end before the next one (frequency and pulse)";
  return {};
}

std::string ServoHead::open(const HeadSetup& setup, Time now) {
  if (std::string wrong = check(); !wrong.empty()) return wrong;
  pan_.options = options_.pan;
  tilt_.options = options_.tilt;
  const auto prepare = [&](const char* name, Axis& axis, const AxisLimits& limits, double start) {
    axis.plan = motion::Plan(start, now);
    axis.rest_since = now;
    if (!axis.there()) return std::string();
    if (std::string wrong = axis.options.beyond_reach(name, limits); !wrong.empty()) return wrong;
    set_limits(axis, limits);
    return open_axis(name, axis, PwmChannel::kPatience);
  };
  if (std::string wrong = prepare("pan", pan_, setup.limits.pan, setup.pan); !wrong.empty()) return wrong;
  return prepare("tilt", tilt_, setup.limits.tilt, setup.tilt);
}

HeadAbilities ServoHead::abilities() const {
  // The position of a servo is its plan, which is better than what the picture shows of it.
  return {.position = true, .velocity = true, .feedback = true, .rate = kRate};
}

void ServoHead::order(Axis& axis, const AxisCommand& command, Time now) {
  axis.command = command;
  if (!axis.there()) return;
  const bool rests = axis.enabled && axis.width != Time::zero() && !axis.moves;
  axis.begins = rests || (axis.begins && axis.moves);
  axis.plan = motion::Plan::make(now, axis.plan.at(now), command, axis.limits);
  axis.moves = axis.plan.end() > now || (!axis.known && command.kind != AxisCommand::Kind::hold);
  axis.rest_since = now;
}

void ServoHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  if (gone_) return;
  order(pan_, pan, now);
  order(tilt_, tilt, now);
  next_period_ = now;  // the first pulse is not kept waiting
}

void ServoHead::limit(const motion::Limits& limits, Time now) {
  set_limits(pan_, limits.pan);
  set_limits(tilt_, limits.tilt);
  order(pan_, pan_.command, now);
  order(tilt_, tilt_.command, now);
}

void ServoHead::halt(Axis& axis, Time now) noexcept {
  if (!axis.there()) return;
  axis.command = {};
  const motion::AxisState here = axis.plan.at(now);
  AxisLimits limits = axis.limits;
  limits.acceleration = std::max(limits.acceleration, std::abs(here.speed) / motion::seconds(kStopTime));
  // The stop of a servo beyond limits that were moved does not bring it back.
  limits.from = std::min(limits.from, here.position);
  limits.to = std::max(limits.to, here.position);
  axis.plan = motion::Plan::make(now, here, {}, limits);
  axis.moves = axis.plan.end() > now;
  axis.rest_since = now;
}

void ServoHead::stop(Time now) noexcept {
  halt(pan_, now);
  halt(tilt_, now);
}

void ServoHead::release(Time now) noexcept {
  for (Axis* axis : {&pan_, &tilt_}) {
    if (!axis->there()) continue;
    axis->plan = motion::Plan(axis->plan.at(now).position, now);
    axis->command = {};
    axis->moves = false;
    if (axis->channel.set_width(Time::zero()) == 0) axis->channel.enable(false);
    axis->width = Time::zero();
    axis->enabled = false;
  }
}

// A pulse that is cut short would be a command to turn: first no new pulse, then, when the last one is over, off.
void ServoHead::end_pulses(Axis& axis) noexcept {
  if (axis.width != Time::zero()) {
    axis.error = axis.channel.set_width(Time::zero());
    axis.width = Time::zero();
    axis.quiet_periods = 0;
  } else if (++axis.quiet_periods >= kLastPulse) {
    axis.error = axis.channel.enable(false);
    axis.enabled = false;
  }
}

void ServoHead::drive(Axis& axis, Time now) {
  if (!axis.there() || axis.error != 0) return;
  const bool moves = now < axis.plan.end();
  if (moves || std::exchange(axis.moves, moves)) {  // at its end, too
    axis.rest_since = now;
    axis.moves = moves;
    // Where the plan begins the width would be the one at rest: the first pulse is that of the next period.
    const Time ahead = std::exchange(axis.begins, false) ? options_.period : Time::zero();
    const Time width = axis.options.pulse_at(axis.plan.at(now + ahead).position);
    if (width != axis.width) axis.error = axis.channel.set_width(width);
    axis.width = width;
    if (!axis.enabled && axis.error == 0) axis.error = axis.channel.enable(true);
    axis.enabled = axis.known = true;
  } else if (axis.enabled && options_.release_delay && now - axis.rest_since >= *options_.release_delay) {
    end_pulses(axis);
  }
}

// A moving axis writes anyway.
void ServoHead::probe(Time now) noexcept {
  if (now < next_probe_) return;
  next_probe_ = now + kProbe;
  for (Axis* axis : {&pan_, &tilt_})
    if (axis->there() && !axis->moves && axis->error == 0) axis->error = axis->channel.probe();
}

Time ServoHead::tick(Time now) {
  if (gone_) {
    if (now < next_open_) return next_open_;
    next_open_ = now + kReopen;
    // Without patience: tick() must not block, and the next try is due soon.
    constexpr std::chrono::milliseconds kOnce{0};
    if (!open_axis("pan", pan_, kOnce).empty() || !open_axis("tilt", tilt_, kOnce).empty()) return next_open_;
    gone_ = false;
    fault_.clear();
    for (Axis* axis : {&pan_, &tilt_}) {
      axis->plan = motion::Plan(axis->plan.at(now).position, now);
      axis->command = {};
      axis->moves = false;
    }
  }
  if (now < next_period_) return next_period_;
  next_period_ = now + options_.period;
  drive(pan_, now);
  drive(tilt_, now);
  probe(now);
  if (const int error = pan_.error != 0 ? pan_.error : tilt_.error; error != 0) {
    release(now);
    pan_.channel.close();
    tilt_.channel.close();
    gone_ = true;
    fault_ = "the PWM chip " + options_.chip + " does not answer any more (" + std::strerror(error) + ")";
    next_open_ = now + kReopen;
    return next_open_;
  }
  return next_period_;
}

std::optional<PoseLine> ServoHead::take_pose(Time now) {
  if (gone_ || now < next_report_) return std::nullopt;
  next_report_ = now + kReport;
  return PoseLine{pan_.plan.at(now), tilt_.plan.at(now), 0};
}

}  // namespace cerberus::drivers
