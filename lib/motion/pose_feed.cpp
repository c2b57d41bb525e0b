// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/pose_feed.h"

#include <algorithm>

namespace cerberus::motion {

void PoseFeed::begin(const Pose& start) {
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

void PoseFeed::add(const Pose& pose) {
  const std::lock_guard guard(lock_);
  history_.add(pose);
  until_ = pose.until;
  ++news_count_;
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
  ++news_count_;  // patience begins anew
  news_.notify_all();
}

Pose PoseFeed::at(Time time) {
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
    const auto seen = news_count_;
    const auto changed = [&] { return done() || news_count_ != seen; };
    if (!playing_ || patience <= Time::zero())
      news_.wait(guard, changed);
    else if (!news_.wait_for(guard, std::min<Time>(patience, std::chrono::hours(24 * 365)), changed))
      return Answer::silent;
  }
  return interrupted_ ? Answer::interrupted : Answer::known;
}

}  // namespace cerberus::motion
