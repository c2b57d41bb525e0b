// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/reckoning.h"

#include <algorithm>

namespace cerberus::motion {

void Reckoning::begin(Time time, const PanTilt& at) {
  next_ = count_ = 0;
  add({time, at, {}});
}

void Reckoning::add(const Step& step) {
  steps_[next_] = step;
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

void Reckoning::turn(Time time, const PanTilt& speed) {
  time = std::max(time, nth_last(count_ - 1).from);
  const Pose here = at(time);
  while (count_ > 1 && nth_last(0).from >= time) {
    next_ = (next_ + kKept - 1) % kKept;
    --count_;
  }
  const Step step{time, {here.pan.position, here.tilt.position}, speed};
  if (nth_last(0).from >= time)
    steps_[(next_ + kKept - 1) % kKept] = step;
  else
    add(step);
}

void Reckoning::place(Time time, const PanTilt& at) {
  const Pose here = this->at(time);
  const double pan = at.pan - here.pan.position, tilt = at.tilt - here.tilt.position;
  for (Step& step : steps_) {
    step.at.pan += pan;
    step.at.tilt += tilt;
  }
}

Pose Reckoning::at(Time time) const {
  unsigned n = 0;
  while (n + 1 < count_ && nth_last(n).from > time) ++n;
  const Step& step = nth_last(n);
  const double dt = std::max(0.0, seconds(time - step.from));
  Pose pose;
  pose.from = time;
  pose.pan = {step.at.pan + step.speed.pan * dt, step.speed.pan, 0};
  pose.tilt = {step.at.tilt + step.speed.tilt * dt, step.speed.tilt, 0};
  if (n > 0) pose.until = nth_last(n - 1).from;
  pose.settled = n == 0 && !pose.moving();
  return pose;
}

}  // namespace cerberus::motion
