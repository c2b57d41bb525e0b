// SPDX-License-Identifier: LGPL-2.1-or-later
// When the camera last saw each direction around the robot. Directions are the world's: what a turn of the body brings
// before the camera counts as seen, too. A body that drives is taken as standing in the middle of its surroundings.
#pragma once

#include <array>

#include "fusion/follower.h"
#include "sensing/sectors.h"

namespace cerberus::fusion {

class SeenAround {
 public:
  // Older sights are as good as none: a person who walks at 1.4 m/s has left a picture of 60 degrees 4 m away after
  // 3.3 s. Guarded by bench-pir_search.
  static constexpr Time kForgotten = std::chrono::seconds(6);
  // A direction that was missed for this long makes a place as old as can be: else a head in step with the turns of its
  // robot never sees some. Guarded by unit-doubt_search.
  static constexpr Time kMissed = std::chrono::seconds(15);

  // The picture of `time`: radians, pan from the body; yaw_rate a second since the picture before. Nothing is seen
  // with an unknown pan. At the first call nothing was seen for kForgotten.
  void see(Time time, double pan, double lens, double yaw_rate);

  // Of the directions between two pan angles, of the body as it is now.
  struct Unseen {
    sensing::Interval
        part;    // from the first to the last that was not seen for `old`; from > to: there is none
    Time age{};  // the mean of all; each counts up to kForgotten
  };
  Unseen unseen(const sensing::Interval& pans, Time old) const;

 private:
  static constexpr int kCells = 36;
  static double middle(int cell);

  double yaw_ = 0;
  Time time_ = kLongAgo;
  std::array<Time, kCells> seen_{};
};

}  // namespace cerberus::fusion
