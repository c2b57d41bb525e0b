// SPDX-License-Identifier: LGPL-2.1-or-later
// When an event begins and ends, from triggers alone: it lasts from its first trigger until `post_roll` after the last
// one, and a trigger within `join` of that end continues it. Knows no frames. Not thread-safe.
#pragma once

#include <algorithm>

#include "record/unit.h"

namespace cerberus::record {

// What makes an event last: each one releases its own hold.
enum class Holder : unsigned { application = 1, motion = 2 };

class EventCycle {
 public:
  struct Settings {
    Time post_roll = std::chrono::seconds(5);
    Time join = std::chrono::seconds(2);
  };

  void configure(const Settings& settings) { settings_ = settings; }

  // Something happened at `time`: an event begins, or the present one goes on. Returns true if one begins.
  bool trigger(Time time) {
    const bool begins = !active_;
    if (begins) begin_ = last_ = time;
    active_ = true;
    last_ = std::max(last_, time);
    return begins;
  }
  // As trigger(), and the event lasts until release() of the same holder.
  bool hold(Time time, Holder holder = Holder::application) {
    held_ |= static_cast<unsigned>(holder);
    return trigger(time);
  }
  // The event ends `post_roll` after `time`, or after a later trigger, unless another one holds it.
  void release(Time time, Holder holder = Holder::application) {
    const auto hold = static_cast<unsigned>(holder);
    if ((held_ & hold) && active_) last_ = std::max(last_, time);
    held_ &= ~hold;
  }

  bool active() const { return active_; }
  bool held() const { return held_ != 0; }
  Time begin() const { return begin_; }  // its first trigger
  // What is decoded later than this does not belong to the event, as far as is known now.
  Time end() const { return held_ ? Time::max() : last_ + settings_.post_roll; }
  // Whether a trigger at `time`, or a later one, is another event's.
  bool over(Time time) const { return !held_ && time > end() + settings_.join; }

  // Times begin anew at `time`, where no earlier trigger has a meaning: an event that is held goes on from there.
  void restart(Time time) {
    if (!held_) close();
    begin_ = last_ = time;
  }

  // The event is closed; the next trigger begins another one.
  void close() {
    active_ = false;
    held_ = 0;
  }

 private:
  Settings settings_;
  bool active_ = false;
  unsigned held_ = 0;  // a bit for each Holder
  Time begin_{}, last_{};
};

}  // namespace cerberus::record
