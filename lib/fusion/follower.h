// SPDX-License-Identifier: LGPL-2.1-or-later
// Selects the track to follow: the present target while it lives, else the one that the user prefers. Persons precede what
// only moves; a seen person also takes the target over from it, once a person has been there for half a second. A stopped
// target is followed for a limited time.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "fusion/fuser.h"

namespace cerberus::fusion {

constexpr Time kLongAgo = Time::min();  // never

// Returns time - since < duration; false for kLongAgo.
constexpr bool within(Time duration, Time since, Time time) {
  return since != kLongAgo && time - since < duration;
}

class Follower {
 public:
  // Processes the tracks of the frame at `time`. A stopped target is given up after `hold_stopped`, until it moves
  // again.
  void watch(std::span<const Track> tracks, Time time, TargetChoice choice, Time hold_stopped);

  std::uint32_t target() const { return here_ ? followed_ : 0; }  // in this frame; 0: none
  bool found(Time hold, Time time) const { return here_ || within(hold, found_, time); }
  bool stands(Time hold, Time time) const { return within(hold, stopped_, time); }

 private:
  std::uint32_t followed_ = 0;
  bool here_ = false;
  Time found_ = kLongAgo;    // last time there was a track
  Time stopped_ = kLongAgo;  // time at which the target stopped; kLongAgo: it moves
  Time person_ = kLongAgo;   // time from which on every frame has a person; kLongAgo: this one has none
  std::array<std::uint32_t, 16>
      tired_{};  // tracks stopped for longer than hold_stopped, until they move again
  unsigned tired_next_ = 0;
};

}  // namespace cerberus::fusion
