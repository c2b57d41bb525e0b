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
  int first_row(int band) const { return std::min(band * kBandRows, rows()); }

  // Calls each(third, reference, present) for a row's samples; third: of the picture's width, 0 to 2.
  template <typename Each>
  void for_each(int row, Each&& each) const {
    const Row& r = rows_[static_cast<std::size_t>(row)];
    std::size_t i = r.begin;
    for (std::size_t third = 0; third < r.ends.size(); ++third)
      for (; i < r.ends[third]; ++i) each(third, reference_[i], present_[i]);
  }

  std::size_t bytes() const {
    return reference_.capacity() + present_.capacity() + rows_.capacity() * sizeof(Row);
  }

 private:
  struct Row {  // indices of its samples, and where its thirds end
    std::size_t begin = 0;
    std::array<std::size_t, 3> ends{};
  };

  int height_ = 0;
  std::vector<std::uint8_t> reference_, present_;
  std::vector<Row> rows_;
};

}  // namespace cerberus::vision
