// SPDX-License-Identifier: LGPL-2.1-or-later
// Learns what an axis that reports no position makes of commanded speeds, all the time: how fast the picture turns while
// the commanded speed stays. The tables of heads rise as a power, so two numbers say how the head differs from what is
// known of it (a calibration's map, or that it turns as commanded), also at speeds that were not seen.
//
//   ln(actual / known(commanded)) = a + b ln(commanded / fastest)      a, b: a Kalman filter, both 0 at first
//   of a frame: deviation of ln(seen speed / known) = sqrt((picture / turn of the frame)^2 + error^2)
//
// Radians and seconds; add() allocates nothing.
#pragma once

#include "motion/speed_map.h"
#include "sensing/angles.h"

namespace cerberus::control {

class SpeedTable {
 public:
  // Guard of all: bench-heads (B, D) and unit-speed_table.
  struct Parameters {
    double unknown = .3;                     // of a and b; derived: twice what PoseEstimate expects
    double picture = sensing::radians(.03);  // radians a frame; PoseEstimate::picture_noise
    // Of a frame. swept: at .2 D, near, is lost with two seeds of twenty, while its dead time is not known yet.
    double error = .4;
    double memory = 600;   // seconds in which a table becomes unknown again. chosen: motors that warm up
    double changed = .05;  // of a speed; derived: a third of what PoseEstimate expects
  };

  // known: what was known before; fastest: the axis' limit.
  void reset(const motion::SpeedMap& known, double fastest);
  // Adds a frame of dt seconds in which the picture turned at `seen`; reckoned: the speed by the map() of then.
  void add(double dt, double reckoned, double seen);
  // True if map() has changed since the last call by so much that the driver must be given it.
  bool changed();
  const motion::SpeedMap& map() const { return map_; }

 private:
  // Octaves below the fastest speed: down to 2 degrees a second of 60.
  static constexpr int kPoints = 6;
  double actual(double commanded) const;

  motion::SpeedMap known_, map_;
  double fastest_ = 0;
  double a_ = 0, b_ = 0;
  double aa_ = 0, ab_ = 0, bb_ = 0;  // covariance
};

}  // namespace cerberus::control
