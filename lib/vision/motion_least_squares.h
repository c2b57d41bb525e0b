// SPDX-License-Identifier: LGPL-2.1-or-later
// The least squares step inside the robust fit of a motion.
#pragma once

#include <array>

#include "vision/motion_fit.h"

namespace cerberus::vision {

// Unknowns are displacements in pixels at the picture's edge, so that one weak prior fits all of them: X, Y are pixels
// from the centre over the half diagonal.
//   X' = X + (t + a X + b Y - (g X + h Y) X') / half diagonal
class MotionLeastSquares {
 public:
  explicit MotionLeastSquares(Size picture);

  // The motion of least sum of weight * squared Mahalanobis distance. False where the samples do not determine it.
  bool step(MotionModel model, const MotionSamples& samples,
            const std::array<float, MotionSamples::kMax>& weights, Transform& motion) const;

  // The same for a similarity and the bend of a camera that turns about its own centre, H = K R K^-1 (Hartley, Zisserman,
  // Multiple View Geometry, 2nd ed., 8.4): to first order in the angle it adds (t . x) x / f^2 to every point, with the
  // shift t of the middle and the focal length f, one unknown more. t is that of `motion`, in and out.
  bool step_turned(const MotionSamples& samples, const std::array<float, MotionSamples::kMax>& weights,
                   Transform& motion) const;

 private:
  template <int N, typename Design, typename Compose>
  bool solve(const MotionSamples& samples, const std::array<float, MotionSamples::kMax>& weights,
             Transform& motion, Design&& design, Compose&& compose) const;

  double cx_, cy_, scale_;
};

}  // namespace cerberus::vision
