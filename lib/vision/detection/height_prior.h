// SPDX-License-Identifier: LGPL-2.1-or-later
// How tall a person is in this scene, learnt from the scene itself.
//
// People of one height standing on one floor before a camera that does not roll are as tall in the picture as their
// feet are below the horizon, times (body height / mounting height): h = a (y_foot - y_horizon), a straight line in
// the foot row. Single, upright, isolated blobs give (foot row, height) pairs; many are wrong (fragments, groups,
// dogs), so a line is sought that most of them agree on.
#pragma once

#include <array>
#include <cstddef>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

class HeightPrior {
 public:
  void reset() { *this = {}; }

  // One frame further: what was learnt moves with the camera (frame k-1 to k; a pan or tilt shifts the rows, a zoom
  // scales them).
  void advance(const Transform& motion, Size picture);

  // Evidence of this frame: a blob that looks like one person. Pixels; `foot` is the lower edge of its box. Its height
  // is a fair weight: where wholes and pieces contradict each other, wholes are larger.
  void learn(double foot, double height, double weight = 1);

  // Expected height of a person whose feet are at this row, 0 while unknown: before enough blobs agree, and at rows
  // too far from all that was seen to say.
  double height(double foot) const;

  bool ready() const { return ready_; }

 private:
  struct Sample {
    float foot = 0, height = 0, weight = 0;
  };
  static constexpr std::size_t kCapacity = 256;
  static constexpr std::size_t kLeast = 8;  // agreeing samples before anything is said

  void fit();

  std::array<Sample, kCapacity> samples_{};
  std::size_t count_ = 0, next_ = 0, fresh_ = 0;
  unsigned random_ = 1;
  bool ready_ = false;
  // height = mean_height_ + slope_ (foot - mean_foot_); variances of the two terms, and of a single person
  double mean_foot_ = 0, mean_height_ = 0, slope_ = 0;
  double mean_variance_ = 0, slope_variance_ = 0;
};

}  // namespace cerberus::vision
