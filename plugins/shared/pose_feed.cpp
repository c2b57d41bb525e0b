// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pose_feed.hpp"

#include <algorithm>

#include "times.hpp"

namespace cerberus::plugin {

using motion::Time;
using sensing::degrees;
using sensing::radians;

motion::Pose from_c(const CerberusPose& pose) {
  const auto time = [](GstClockTime t) { return t == GST_CLOCK_TIME_NONE ? motion::kNever : time_of(t); };
  return {.from = time(pose.valid_from),
          .until = time(pose.valid_until),
          .pan = {radians(pose.pan), radians(pose.pan_speed), radians(pose.pan_acceleration)},
          .tilt = {radians(pose.tilt), radians(pose.tilt_speed), radians(pose.tilt_acceleration)},
          .settled = pose.settled != FALSE,
          .measured = pose.source == CERBERUS_POSE_MEASURED};
}

CerberusPose to_c(const motion::Pose& pose) {
  CerberusPose out;
  cerberus_pose_init(&out);
  out.pan = degrees(pose.pan.position);
  out.tilt = degrees(pose.tilt.position);
  out.pan_speed = degrees(pose.pan.speed);
  out.tilt_speed = degrees(pose.tilt.speed);
  out.pan_acceleration = degrees(pose.pan.acceleration);
  out.tilt_acceleration = degrees(pose.tilt.acceleration);
  out.valid_from = clock_time(std::max(pose.from, Time::zero()));
  out.valid_until = pose.until == motion::kNever ? GST_CLOCK_TIME_NONE : clock_time(pose.until);
  out.source = pose.measured ? CERBERUS_POSE_MEASURED : CERBERUS_POSE_COMMANDED;
  out.moving = pose.moving();
  out.settled = pose.settled;
  return out;
}

void PoseFeed::begin(const motion::Pose& start) {
  const std::lock_guard guard(lock_);
  history_.clear();
  here_ = start;
  until_ = Time(-1);
  first_ = true;
}

void PoseFeed::forget() {
  const std::lock_guard guard(lock_);
  history_.clear();
  until_ = Time(-1);
  first_ = true;
  here_.pan = {here_.pan.position, 0, 0};
  here_.tilt = {here_.tilt.position, 0, 0};
}

void PoseFeed::tell(const motion::Pose& pose) {
  const std::lock_guard guard(lock_);
  history_.add(pose);
  until_ = pose.until;
  ++told_;
  news_.notify_all();
}

void PoseFeed::interrupt(bool on) {
  const std::lock_guard guard(lock_);
  interrupted_ = on;
  news_.notify_all();
}

void PoseFeed::play(bool on) {
  const std::lock_guard guard(lock_);
  playing_ = on;
  ++told_;  // patience begins anew
  news_.notify_all();
}

motion::Pose PoseFeed::at(Time time) {
  const std::lock_guard guard(lock_);
  if (first_ || history_.empty()) {
    first_ = false;
    here_.from = here_.until = time;
    return here_;
  }
  // Of two pieces that meet at `time` the earlier one, which is known when that time is: the later one may be still on
  // its way, and two runs must give the same.
  return here_ = history_.at(time - Time(1)).at(time);
}

PoseFeed::Answer PoseFeed::wait(Time time, Time patience) {
  std::unique_lock guard(lock_);
  const auto done = [&] { return interrupted_ || first_ || until_ >= time; };
  while (!done()) {
    const auto seen = told_;
    const auto changed = [&] { return done() || told_ != seen; };
    if (!playing_ || patience <= Time::zero())
      news_.wait(guard, changed);
    else if (!news_.wait_for(guard, std::min<Time>(patience, std::chrono::hours(24 * 365)), changed))
      return Answer::silent;
  }
  return interrupted_ ? Answer::interrupted : Answer::known;
}

}  // namespace cerberus::plugin
