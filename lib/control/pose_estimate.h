// SPDX-License-Identifier: LGPL-2.1-or-later
// Estimates the pose of a head that reports no position, from its dead reckoning and from the turn of the picture, and
// how uncertain that pose is.
//
//   frame k-1 to k, of each axis: u = turn by dead reckoning, z = turn of the picture (absent: not measured)
//   deviations          s_u = reckoning_scale |u|,  s_z = picture_noise + picture_scale |z|
//   turn                u                                        without z
//                       z                                        where they contradict: |z - u| > gate (s_u + s_z) + slack
//                       u + s_u^2 / (s_u^2 + s_z^2) (z - u)      otherwise (minimum variance)
//   uncertainty         sqrt(sum of variances) + sum of reckoning_scale |u| of the turns without z
//                       + picture_scale |position - reference|
//
// A wrong field of view makes every turn wrong by one factor, so its error returns to zero with the head; a wrong speed
// table does not, so its errors add up. A head at rest by its own reckoning stays where it is unless the picture clearly
// contradicts: noise of the picture does not add up at rest. The picture sees head and base together: the base must
// stand, or its turn must have been subtracted. Pure; allocates nothing.
#pragma once

#include <optional>

#include "control/base_rate.h"
#include "motion/pan_tilt.h"

namespace cerberus::control {

class PoseEstimate {
 public:
  struct Parameters {
    // Share of a turn. derived: two of three speeds of the shared VISCA table are within 15 % of other models' tables.
    double reckoning_scale = 0.15;
    // Share of a turn. derived: a horizontal-fov of 60 degrees that is known to one degree.
    double picture_scale = 0.02;
    // Radians a frame. derived: a third of a pixel of 320 over 30 degrees.
    double picture_noise = sensing::radians(0.03);
    double gate = 3;  // in deviations; the usual three sigma
    double slack =
        sensing::radians(0.25);  // radians; derived: a dead time wrong by 25 ms at 10 degrees a second
    // Radians of uncertainty at which the reference counts as lost. derived: a quarter of a lens of 32 degrees, so that
    // the head surely still looks where the old view was.
    double lost = sensing::radians(8);
  };

  PoseEstimate() = default;
  explicit PoseEstimate(const Parameters& parameters) : parameters_(parameters) {}

  // A reference: the head is at `at`, radians, within `uncertainty`.
  void reset(const motion::PanTilt& at, double uncertainty = 0);
  // Adds a frame. reckoned: the turn since the frame before by the head's own reckoning. seen: the turn of the picture;
  // nothing, or not finite: it was not measured.
  void add(const motion::PanTilt& reckoned, const std::optional<Turn>& seen);

  motion::PanTilt position() const { return {pan_.position, tilt_.position}; }
  // Radians: how far the head may be from position(), the larger one of both axes.
  double uncertainty() const;
  bool lost() const { return uncertainty() > parameters_.lost; }

 private:
  struct Axis {
    double position = 0, reference = 0;
    double variance = 0;  // radians squared
    double unseen = 0;    // radians
  };
  void add(Axis& axis, double reckoned, const double* seen) const;
  double uncertainty(const Axis& axis) const;

  Parameters parameters_;
  Axis pan_, tilt_;
};

}  // namespace cerberus::control
