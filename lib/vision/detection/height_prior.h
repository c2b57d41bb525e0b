// SPDX-License-Identifier: LGPL-2.1-or-later
// Height prior: how tall a person is in the picture, by the row of the feet, learnt from the scene.
//
// People of one height who stand on one floor before a camera that does not roll are as tall in the picture as their
// feet are below the horizon, times (body height / mounting height): h = a (y_foot - y_horizon), a straight line in
// the foot row. Single, upright, isolated blobs give (foot row, height) pairs; many are wrong (fragments, groups,
// dogs), so the line is the one that most of them agree with.
#pragma once

#include <array>
#include <cstddef>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

class HeightPrior {
 public:
  // Where no origin stands the value was chosen by hand on vtest.avi. Guard: tests/unit/height_prior and the boxes on
  // vtest.avi.
  struct Parameters {
    double spread =
        0.10;  // of the height, standard deviation. derived: adults differ by 5 %, blobs by as much
    // Standard deviations from the line within which a sample agrees. swept: 1.2 to 2.5.
    double agree = 1.5;
    double share = 0.5;  // of the samples' weight that must agree
    // Agreeing samples before the prior answers. swept: 8 to 12.
    int least = 10;
    double uncertain = 0.16;  // relative standard error of the line beyond which it does not answer
    // Samples that count as one: those of one person are alike, by frames of who walks alone and by strides of bodies.
    // swept: 1 to 4.
    double repeats = 2.0;
    int guesses = 40;         // pairs of samples tried as lines
    int through_horizon = 4;  // every so manieth guess is a line through the picture's upper edge
    // Standard deviation of the slope before any sample, times the slope that belongs to a horizon at the picture's upper
    // edge: the camera of a robot has the horizon in the middle. swept: 1 to 3.
    double slope_spread = 2;
    double baseline = 0.2;  // of the larger height: distance of the foot rows of a pair, at least
    int refit = 16;         // a fit after every count / refit samples: later ones hardly change the line
  };

  HeightPrior() = default;
  explicit HeightPrior(const Parameters& parameters) : parameters_(parameters) {}

  // Forgets the samples.
  void reset() { *this = HeightPrior(parameters_); }

  // Moves the prior with the camera (frame k-1 to k, pixels): a pan or tilt shifts the rows, a zoom scales them.
  void advance(const Transform& motion, Size picture);

  // A sample: a blob that looks like one person. Pixels; `foot` is the lower edge of its box. Its height is a fair
  // weight: where whole persons and fragments contradict each other, the persons are larger.
  void learn(double foot, double height, double weight = 1);

  // Expected height in pixels of a person whose feet are at this row; 0 while unknown: before enough samples agree, and
  // at rows too far from all samples.
  double height(double foot) const;

  // Relative standard error of that height: of the line, not of a person. Only where height() is known.
  double uncertainty(double foot) const;

  bool ready() const { return ready_; }

 private:
  struct Sample {
    float foot = 0, height = 0, weight = 0;
  };
  static constexpr std::size_t kCapacity = 256;

  void fit();

  Parameters parameters_;
  std::array<Sample, kCapacity> samples_{};
  std::size_t count_ = 0, next_ = 0, fresh_ = 0;
  unsigned random_ = 1;
  bool ready_ = false;
  // height = mean_height_ + slope_ (foot - mean_foot_), and variances of the two terms
  double mean_foot_ = 0, mean_height_ = 0, slope_ = 0;
  double mean_variance_ = 0, slope_variance_ = 0;
};

}  // namespace cerberus::vision
