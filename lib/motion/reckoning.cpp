// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/reckoning.h"

#include <algorithm>
#include <cmath>

namespace cerberus::motion {
namespace {

// The camera's state `dt` seconds after its motor was at `motor`, and in `contact` the seconds until the motor has taken
// up the play, if it is doing so.
AxisState camera_after(double dt, double motor, double camera, double speed, double half_play,
                       double& contact) {
  const double now = motor + speed * dt;
  const double position = std::clamp(camera, now - half_play, now + half_play);
  constexpr double kTouching = 1e-12;
  const double way = speed > 0 ? position + half_play - now : now - position + half_play;
  if (speed == 0 || way <= kTouching) return {position, speed, 0};
  contact = std::min(contact, way / std::abs(speed));
  return {position, 0, 0};
}

}  // namespace

void Reckoning::begin(Time time, const PanTilt& at) {
  next_ = count_ = 0;
  add({time, at, at, {}});
}

void Reckoning::add(const Step& step) {
  steps_[next_] = step;
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

const Reckoning::Step& Reckoning::step_at(Time time, Time& end) const {
  unsigned n = 0;
  while (n + 1 < count_ && nth_last(n).from > time) ++n;
  end = n > 0 ? nth_last(n - 1).from : kNever;
  return nth_last(n);
}

void Reckoning::turn(Time time, const PanTilt& speed) {
  time = std::max(time, nth_last(count_ - 1).from);
  Time end;
  const Step& before = step_at(time, end);
  const double dt = seconds(time - before.from);
  const Pose here = at(time);
  const Step step{time,
                  {before.motor.pan + before.speed.pan * dt, before.motor.tilt + before.speed.tilt * dt},
                  {here.pan.position, here.tilt.position},
                  speed};
  while (count_ > 1 && nth_last(0).from >= time) {
    next_ = (next_ + kKept - 1) % kKept;
    --count_;
  }
  if (nth_last(0).from >= time)
    steps_[(next_ + kKept - 1) % kKept] = step;
  else
    add(step);
}

void Reckoning::place(Time time, const PanTilt& at) {
  const Pose here = this->at(time);
  const double pan = at.pan - here.pan.position, tilt = at.tilt - here.tilt.position;
  for (Step& step : steps_)
    for (PanTilt* each : {&step.motor, &step.camera}) {
      each->pan += pan;
      each->tilt += tilt;
    }
}

Pose Reckoning::at(Time time) const {
  Pose pose;
  pose.from = time;
  const Step& step = step_at(time, pose.until);
  const double dt = std::max(0.0, seconds(time - step.from));
  double contact = 1e6;  // seconds
  pose.pan = camera_after(dt, step.motor.pan, step.camera.pan, step.speed.pan, half_play_.pan, contact);
  pose.tilt = camera_after(dt, step.motor.tilt, step.camera.tilt, step.speed.tilt, half_play_.tilt, contact);
  pose.settled = pose.until == kNever && step.speed.pan == 0 && step.speed.tilt == 0;
  if (contact < 1e6)
    pose.until = std::min(pose.until, time + Time(static_cast<Time::rep>(std::ceil(contact * 1e9))));
  return pose;
}

}  // namespace cerberus::motion
