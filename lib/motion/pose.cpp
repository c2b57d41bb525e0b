// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/pose.h"

#include <algorithm>

namespace cerberus::motion {

namespace {

AxisState advance(const AxisState& state, double dt) {
  return {state.position + (state.speed + 0.5 * state.acceleration * dt) * dt,
          state.speed + state.acceleration * dt, state.acceleration};
}

}  // namespace

Pose Pose::at(Time time) const {
  Pose pose = *this;
  pose.from = std::clamp(time, from, std::max(from, until));
  const double dt = seconds(pose.from - from);
  pose.pan = advance(pan, dt);
  pose.tilt = advance(tilt, dt);
  return pose;
}

void PoseHistory::add(const Pose& pose) {
  while (count_ > 0 && nth_last(0).from >= pose.from) {
    next_ = (next_ + kKept - 1) % kKept;
    --count_;
  }
  poses_[next_] = pose;
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

Pose PoseHistory::at(Time time) const {
  if (count_ == 0) return {};
  unsigned n = 0;
  while (n + 1 < count_ && nth_last(n).from > time) ++n;
  return nth_last(n).at(time);
}

}  // namespace cerberus::motion
