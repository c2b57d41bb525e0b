// SPDX-License-Identifier: LGPL-2.1-or-later
// The approximate shift of the whole picture: the first guess for pans too fast to match patches without one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

// A small picture (at most 64 pixels a side) normalised for brightness and contrast: the difference of each pixel from
// its 5 x 5 neighbourhood, scaled to a common mean.
class Relief {
 public:
  static constexpr int kMaxSide = 64;

  void build(GrayView picture);
  Size size() const { return values_.size(); }
  double contrast() const { return contrast_; }  // mean difference from the neighbourhood, grey levels
  std::size_t bytes() const { return values_.bytes(); }

 private:
  friend struct ShiftSearch;
  double contrast_ = 0;
  Image<std::uint8_t> values_;  // rows padded with 0
};

struct Shift {
  double dx = 0, dy = 0;  // earlier to later, pixels of the small picture
  double difference = 1;  // mean difference over the overlap, 0 (equal) to about 1 (unrelated)
};

// Finds the best shift of up to a quarter of the picture in each direction, to a fraction of a pixel, and the best
// other one that is not adjacent to it.
struct ShiftSearch {
  std::array<Shift, 2> run(const Relief& earlier, const Relief& later);
};

}  // namespace cerberus::vision
