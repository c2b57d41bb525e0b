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

 private:
  template <int N, typename Design, typename Compose>
  bool solve(const MotionSamples& samples, const std::array<float, MotionSamples::kMax>& weights,
             Transform& motion, Design&& design, Compose&& compose) const;

  double cx_, cy_, scale_;
};

}  // namespace cerberus::vision
