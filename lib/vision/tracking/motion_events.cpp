// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/motion_events.h"

#include <algorithm>
#include <utility>

namespace cerberus::vision {

namespace {

constexpr MotionEvents::Time kUsual = std::chrono::milliseconds(40);
constexpr int kLate = 3;  // frame distances: what comes later than this has stopped (as History::kGapFactor)
constexpr MotionEvents::Time kLeast = std::chrono::microseconds(100);  // no camera is faster

}  // namespace

std::chrono::nanoseconds frame_step(std::chrono::nanoseconds step,
                                    std::optional<std::chrono::nanoseconds> time,
                                    std::optional<std::chrono::nanoseconds> last) {
  if (step > step.zero()) return step;
  const auto gap = time && last ? *time - *last : step.zero();
  return gap >= kLeast ? gap : kUsual;
}

MotionEvents::Change MotionEvents::update(bool present, std::optional<Time> time, Time step, Time hold) {
  const Time passed = frame_step(step, time, last_);
  last_ = time;
  step_ = passed;
  if (present) {
    quiet_ = Time::zero();
    return std::exchange(active_, true) ? Change::none : Change::started;
  }
  if (!active_) return Change::none;
  quiet_ += passed;
  return quiet_ >= hold ? end() : Change::none;
}

std::optional<MotionEvents::Time> MotionEvents::ends_after(Time hold) const {
  if (!active_) return std::nullopt;
  return std::max(hold - quiet_, kLate * step_);
}

MotionEvents::Change MotionEvents::end() {
  return std::exchange(active_, false) ? Change::ended : Change::none;
}

}  // namespace cerberus::vision
