// SPDX-License-Identifier: LGPL-2.1-or-later
// Learns the dead time of a head that reports no position, all the time: by how much the picture turns later than the
// driver reckons. Of each lag the correlation of both turns is kept, and forgotten slowly; the lag that explains most of
// the picture's turn is approached.
//
//   lag l:  z = turn of the picture / dt,  d = reckoned turn / dt, a time l earlier;  r^2 = cov(z, d)^2 / (var z var d)
//
// The turn of a base adds to z what d does not have: it lowers r, and with too low an r nothing is learnt. Seconds and
// radians; allocates nothing.
#pragma once

#include <array>

#include "motion/pose.h"

namespace cerberus::control {

class DeadTime {
 public:
  void reset() { *this = {}; }
  // Adds the turn of the picture between two frames, which were taken at these times. told: the dead time by which
  // `reckoned` was made.
  void add(motion::Time before, motion::Time taken, double turn, const motion::PoseHistory& reckoned,
           motion::Time told);
  // How much later the head turns than it is reckoned; negative: earlier.
  motion::Time late() const { return late_; }
  // Whether the last frames agree with late().
  bool agrees() const { return agrees_; }

 private:
  static constexpr motion::Time kStep = std::chrono::milliseconds(20);
  static constexpr int kEarly = 10, kLate = 60;  // lags, steps: -.2 to 1.2 s
  // Weighted by time, of what is kept.
  struct Sums {
    double n = 0, z = 0, d = 0, zz = 0, zd = 0, dd = 0;
    void add(double weight, double seen, double reckoned, double keep);
    double explained() const;  // r^2; 0: too little turned
  };

  std::array<Sums, kEarly + 1 + kLate> lags_{};
  motion::Time late_{};
  bool agrees_ = false;
};

}  // namespace cerberus::control
