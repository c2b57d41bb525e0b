// SPDX-License-Identifier: LGPL-2.1-or-later
// Light that changes between two pictures of the same scene: exposure and gain steps (global), mains flicker
// seen through a rolling shutter (bands of rows). Robust against moving objects, so that it can be taken out
// before pictures are compared.
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
  // robustly through the median differences of 16 brightness classes; a band's gain is the median of what its samples
  // say. Either can be taken for the other where bright and dark lie apart: if the camera is still both orders are
  // tried, and what leaves less is kept; else registration's errors would be what is told apart. Changes too small to
  // tell from noise are not made.
  void estimate(const LightSamples& samples, bool still);
  void clear();

  bool none() const { return none_; }
  // Of the picture as a whole: the mean of its rows.
  double gain() const { return gain_; }
  double offset() const { return offset_; }  // grey levels
  // Share of the sampled pixels that agree with the model to within a few levels: low when the picture as a
  // whole cannot be explained by a change of light.
  double agreement() const { return agreement_; }
  // out := row y of the reference under the present light. What was too bright for the sensor there may have been
  // brighter than the reference says: in less light it may be anything from there on, and what `present` shows is as
  // good.
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
  using Counts = std::array<std::array<std::uint64_t, kLevels>, kClasses>;
  Counts count_differences(const LightSamples& samples) const;
  RowLight light_of(int row) const;  // of samples

  bool none_ = true;
  double gain_ = 1, offset_ = 0, agreement_ = 1;
  std::vector<RowLight> rows_;
  std::vector<std::uint8_t> doubt_;  // 1/256 that the row's gain may be off by
};

}  // namespace cerberus::vision
