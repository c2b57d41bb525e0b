// SPDX-License-Identifier: LGPL-2.1-or-later
// Samples of two pictures for the estimate of a change of light, stored contiguously because the estimate reads them
// several times.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/change/light_kernels.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Every second row of the pictures and every eighth column, another one from row to row.
class LightSamples {
 public:
  static constexpr int kColumnStep = 8, kRowStep = 2;
  static constexpr int kBandRows = 4;  // rows of samples in a band: 8 of the picture

  // Samples the valid spans; empty: everywhere.
  void take(GrayView reference, GrayView present, std::span<const RowSpan> spans);
  int height() const { return height_; }  // of the pictures
  int rows() const { return static_cast<int>(rows_.size()); }
  int bands() const { return (rows() + kBandRows - 1) / kBandRows; }
  static int picture_row(int row) { return row * kRowStep; }

  // Statistics of the band's samples under the lights of the picture's rows.
  LightSums sums_of_band(int band, std::span<const RowLight> lights) const;
  int first_row(int band) const { return std::min(band * kBandRows, rows()); }
  // Calls each(reference, the same under the light, present, number) for a row's samples, at most kSampleLanes at once. So
  // many can be read from each of the three; what stands from `number` on means nothing.
  template <typename Each>
  void for_each(int row, RowLight light, Each&& each) const {
    const std::uint8_t *a = reference_.data() + start_of(row), *b = present_.data() + start_of(row);
    const bool same = light == RowLight{};
    for (const int number : rows_[static_cast<std::size_t>(row)]) {
      for (int begin = 0; begin < number; begin += kSampleLanes) {
        std::array<std::uint8_t, kSampleLanes> lit;
        if (!same) relight_samples(a + begin, light, lit.data());
        each(a + begin, same ? a + begin : lit.data(), b + begin, std::min(number - begin, kSampleLanes));
      }
      a += third_, b += third_;
    }
  }

  std::size_t bytes() const {
    return reference_.capacity() + present_.capacity() + rows_.capacity() * sizeof(rows_[0]);
  }

 private:
  std::size_t start_of(int row) const { return static_cast<std::size_t>(row) * 3 * third_; }

  int height_ = 0;
  int third_ = 0;  // room for a third of a row
  std::vector<std::uint8_t> reference_, present_;
  std::vector<std::array<std::uint16_t, 3>> rows_;  // number of samples by thirds of a row
};

}  // namespace cerberus::vision
