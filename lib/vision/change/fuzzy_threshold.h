// SPDX-License-Identifier: LGPL-2.1-or-later
// The threshold by indices of fuzziness (paper Eq. 4-10; Tobias and Seara, IEEE Trans. Image Processing
// 11(12), 2002).
#pragma once

#include <array>
#include <cstdint>

#include "vision/change/three_frame_difference.h"

namespace cerberus::vision {

enum class Weighting { linear, log };   // g = h | ln(1 + h)
enum class Extremes { subset, image };  // width of the S-function from the subset's or the whole image's ends

struct FuzzyThresholdOptions {
  Weighting weighting = Weighting::log;
  Extremes extremes = Extremes::image;
  int order = 1;               // k of Eq. 8 and 9
  double seed_share = 0.3964;  // P1
  bool clip = true;            // drop the few highest levels (log weighting only)
};

// Everything the choice rests on, for the picture `stage=histogram` (the paper's figures 2 and 3) and for
// tests.
struct FuzzyThresholdCurves {
  int lowest = 0, highest = 0, middle = 0;  // x0, x1, m
  int seed_low = 0, seed_high = 0;          // j, r
  double psi_background = 0, psi_object = 0, alpha = 1;
  std::array<double, 256> beta{};   // normalised index of the background subset with level x added
  std::array<double, 256> omega{};  // index of the object subset with level x added; both 0 outside j < x < r
  std::array<double, 256> membership{};  // S-function of the whole histogram (Eq. 4, 6)
};

// Returns Th: a pixel is moving if its difference is > Th (Eq. 3). 0 for an empty histogram.
int fuzzy_threshold(const Histogram& histogram, const FuzzyThresholdOptions& options,
                    FuzzyThresholdCurves* curves = nullptr);

// Th held inside [floor, 1.5 floor], floor = max(6, 4 sigma): the guard rail of preset `default`.
int clamp_to_noise(int threshold, double sigma);

}  // namespace cerberus::vision
