// SPDX-License-Identifier: LGPL-2.1-or-later
// How high people are in the picture, by where their feet are: on even ground a straight line (R. Hartley,
// A. Zisserman, "Multiple View Geometry in Computer Vision", 2nd ed., 8.7: a person's height goes with the distance of
// the feet from the horizon). It is learnt from the detector's persons, most of whom must agree, and turns with the camera.
#pragma once

#include <array>
#include <cstddef>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/verification/verification_parameters.h"

namespace cerberus::vision {

class HeightLine {
 public:
  enum class Fit {
    unknown,      // too little is known of this place
    fits,         // as high as people are there
    contradicts,  // no person who stands there is as high, or as low
  };

  void reset();
  // The camera's motion from the last frame to this one, in pixels.
  void move(const Transform& motion);
  // A person whom the detector has found. Pixels.
  void learn(const Box& person, const VerificationParameters& p);
  Fit judge(const Box& person, const VerificationParameters& p) const;

 private:
  struct Sample {
    Point head, foot;
    double height() const { return foot.y - head.y; }
  };
  static constexpr std::size_t kSamples = 64;

  void fit(const VerificationParameters& p);

  std::array<Sample, kSamples> samples_;
  std::size_t learnt_ = 0;  // counts on
  double middle_ = 0, height_ = 0,
         slope_ = 0;  // height at feet in the row y: height_ + slope_ * (y - middle_)
  double height_variance_ = 0, slope_variance_ = 0;
};

}  // namespace cerberus::vision
