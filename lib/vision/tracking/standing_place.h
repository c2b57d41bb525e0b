// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether an object is still where it stood: its place differs from what was there before it came. It does so whether the
// background model has absorbed the object meanwhile or not, and whoever passes in front.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

class StandingPlace {
 public:
  void forget() { *this = {}; }
  bool known() const { return frames_ > 0; }
  // The box is still that of the object that stands here, which may have stirred.
  bool holds(const Box& box) const {
    return 2 * overlap_area(box, box_) >= std::max(box.area(), box_.area());
  }

  // The object begins to stand in this box. background: as it was learnt without the object. Both in analysis pixels, as
  // all boxes here.
  void begin(const Box& box, GrayView background);
  // The camera moved between the last picture and this one, analysis pixels.
  void carry(const Transform& motion);
  // The object is seen to stand there.
  void learn(GrayView picture);
  // Most of what the object had changed is as before.
  bool left(GrayView picture) const;

 private:
  // Means of cells, so that noise and a background that is slightly blurred count little.
  static constexpr int kCell = 4;  // pixels: side of a cell, at least
  static constexpr int kColumns = 8, kRows = 16;
  using Cells = std::array<std::uint8_t, kColumns * kRows>;

  Cells cells_of(GrayView picture) const;
  double difference(GrayView picture) const;

  Box box_;
  Cells before_{};
  double filled_ = 0;  // mean difference from `before_` while the object was seen there, grey levels
  int frames_ = 0;     // of that mean
};

}  // namespace cerberus::vision
