// SPDX-License-Identifier: LGPL-2.1-or-later
// Whom to follow: the one who is followed already, else whom the user prefers. Who stands still is watched for a while.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "fusion/fuser.h"

namespace cerberus::fusion {

constexpr Time kLongAgo = Time::min();  // never

// time - since < duration; false for what never was.
constexpr bool within(Time duration, Time since, Time time) {
  return since != kLongAgo && time - since < duration;
}

class Follower {
 public:
  // The tracks of the frame of `time`. One who stands is let go after `hold_stopped`, until it moves again.
  void watch(std::span<const Track> tracks, Time time, TargetChoice choice, Time hold_stopped);

  std::uint32_t target() const { return here_ ? followed_ : 0; }  // in this frame; 0: nobody
  bool found(Time hold, Time time) const { return here_ || within(hold, found_, time); }
  bool stands(Time hold, Time time) const { return within(hold, stopped_, time); }

 private:
  std::uint32_t followed_ = 0;
  bool here_ = false;
  Time found_ = kLongAgo;                  // last time there was a track
  Time stopped_ = kLongAgo;                // since when the followed one stands; kLongAgo: it moves
  std::array<std::uint32_t, 16> tired_{};  // stood longer than hold_stopped, until they move again
  unsigned tired_next_ = 0;
};

}  // namespace cerberus::fusion
