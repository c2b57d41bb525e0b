// SPDX-License-Identifier: LGPL-2.1-or-later
// Light that changes between two pictures of the same scene: exposure and gain steps (global), mains flicker
// sampled by a rolling shutter (bands of rows). The estimate is robust against moving objects and is compensated before
// pictures are compared.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/change/light_kernels.h"
#include "vision/change/light_samples.h"

namespace cerberus::vision {

class LightChange {
 public:
  // present ~ gain * reference + offset over the samples, and a further gain for each band of 8 rows. The line goes
  // robustly through the median differences of 16 brightness classes; a band's gain is the median of its samples'
  // gains. The two can be confused where bright and dark areas lie apart. For a still camera both orders are tried and
  // the one with the smaller residual is kept; for a moving one misregistration would decide. Changes within the noise
  // are not made.
  void estimate(const LightSamples& samples, bool still);
  void clear();

  bool none() const { return none_; }
  // Of the picture as a whole: the mean of its rows.
  double gain() const { return gain_; }
  double offset() const { return offset_; }  // grey levels
  // Share of the sampled pixels that agree with the model to within a few levels: low when the picture as a
  // whole cannot be explained by a change of light.
  double agreement() const { return agreement_; }
  // out := row y of the reference under the present light. Saturated pixels of the reference were possibly
  // brighter than recorded: under less light any value from there on is possible, and that of `present` is taken.
  void relight(const std::uint8_t* reference, const std::uint8_t* present, int y, int count,
               std::uint8_t* out) const;
  RowLight row(int y) const { return y < static_cast<int>(rows_.size()) ? rows_[y] : RowLight{}; }
  std::size_t bytes() const {
    return rows_.capacity() * sizeof(RowLight) + doubt_.capacity();
  }  // beside the object itself

 private:
  static constexpr int kClasses = 16, kReach = 127, kLevels = 2 * kReach + 1;
  bool estimate_global(const LightSamples& samples);
  bool estimate_bands(const LightSamples& samples);
  double misfit(const LightSamples& samples) const;
  double excess_of_band(const LightSamples& samples, int band) const;
  // Lower half: number of samples; upper half: the sum of their levels' lower 4 bits, so that one addition counts both.
  // 32 bits each: a sixteenth of 3840 x 2160 pixels may all be alike.
  using Counts = std::array<std::uint64_t, kClasses * kLevels>;  // by class, then by difference
  Counts count_differences(const LightSamples& samples) const;
  RowLight light_of(int row) const;  // of samples

  bool none_ = true;
  double gain_ = 1, offset_ = 0, agreement_ = 1;
  std::vector<RowLight> rows_;
  std::vector<std::uint8_t> doubt_;  // 1/256 that the row's gain may be off by
};

}  // namespace cerberus::vision
