// SPDX-License-Identifier: LGPL-2.1-or-later
// The least squares step inside the robust fit of a motion.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "vision/ego_motion/motion_fit.h"
#include "vision/ego_motion/motion_fit_kernels.h"

namespace cerberus::vision {

// Whether the camera exposes all rows of a picture at one time or one after another.
enum class Shutter { global, rolling };

// Unknowns are displacements in pixels at the picture's edge, so that one weak prior fits all of them: X, Y are pixels
// from the centre over the half diagonal.
//   X' = X + (t + a X + b Y - (g X + h Y) X') / half diagonal
class MotionLeastSquares {
 public:
  explicit MotionLeastSquares(Size picture);

  // (half diagonal / focal length)^2 of a lens of 110 degrees: wider ones are no longer plane.
  static constexpr double kMostBend = 3.2;

  // Returns the turn, through a lens of this bend, that maps `from` to `to`.
  Transform turn(Point from, Point to, double bend) const;

  // Solves the normal equations, which are in this scale(), for the motion. Returns false where the samples do not
  // determine it.
  MotionScale scale() const { return {cx_, cy_, 1 / scale_}; }
  bool step(MotionModel model, const MotionNormal& normal, Transform& motion) const;

  // The same for a similarity and the bend of a camera that turns about its own centre, H = K R K^-1 (Hartley,
  // Zisserman, Multiple View Geometry, 2nd ed., 8.4): to first order in the angle it adds (t . x) x / f^2 to every
  // point, with the shift t of the middle and the focal length f, one more unknown. t is taken from `motion` and
  // returned in it. With a rolling shutter an accelerating turn displaces the lower rows more: to first order a shear
  // and a stretch along the columns (Forssen, Ringaby, Rectifying rolling shutter video from hand-held devices, CVPR
  // 2010), two more unknowns. `lens`: in, the estimate so far; out, the estimate from the samples alone.
  bool step_turned(const MotionNormal& normal, Shutter shutter, LensBend& lens, Transform& motion) const;

 private:
  struct Unknown;
  template <std::size_t N>
  struct Normal;
  template <std::size_t N>
  bool step(std::span<const Unknown, N> unknowns, const MotionNormal& all, Transform& motion) const;
  template <std::size_t N>
  bool step_turned(std::span<const Unknown, N> unknowns, const MotionNormal& all, LensBend& lens,
                   Transform& motion) const;
  template <std::size_t N>
  Transform composed(std::span<const Unknown, N> unknowns, const std::array<double, N>& values) const;
  Transform in_pixels(const Transform& scaled) const;

  double cx_, cy_, scale_;
};

}  // namespace cerberus::vision
