// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the whole picture went, roughly: the first guess for pans too fast for patches to be followed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

// A small picture (at most 64 pixels a side) freed of brightness and contrast: what a pixel stands out of its 5 x 5
// surroundings, scaled to a common mean.
class Relief {
 public:
  static constexpr int kMaxSide = 64;

  void build(GrayView picture);
  Size size() const { return values_.size(); }
  double contrast() const { return contrast_; }  // mean distance from the surroundings, grey levels
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

// The best shift of up to a quarter of the picture either way, to a fraction of a pixel; and the best one that is
// not next to it.
struct ShiftSearch {
  std::array<Shift, 2> run(const Relief& earlier, const Relief& later);
};

}  // namespace cerberus::vision
