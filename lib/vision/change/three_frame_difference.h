// SPDX-License-Identifier: LGPL-2.1-or-later
// Registered differences of three consecutive frames (paper Eq. 1 and 2), both in frame k's coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

using Histogram = std::array<std::uint32_t, 256>;

struct DifferenceOptions {
  int blur = 3;                  // side of the box blur before differencing: 1 (off) or 3
  bool compensate_light = true;  // compensate a global change of gain and offset before differencing
};

struct DifferenceResult {
  // Frames of this scene that the differences span: 1 none yet (both zero), 2 only |F(k)-F(k-1)|, 3 both.
  int frames = 0;
  bool previous = false;    // D(k-1) is available; else it is zero
  std::uint32_t valid = 0;  // pixels valid in all frames used; the histogram's sum
  double gain = 1;          // light change compensated: F(k-1) is compared as gain * F(k-1) + offset
  double offset = 0;
};

// Keeps the two previous pictures. Each is warped once a frame, and no difference is warped. Of the older one only the
// valid area is tracked while D(k-1) is not requested.
class ThreeFrameDifference {
 public:
  ThreeFrameDifference();
  ~ThreeFrameDifference();
  ThreeFrameDifference(ThreeFrameDifference&&) noexcept;
  ThreeFrameDifference& operator=(ThreeFrameDifference&&) noexcept;

  void set_options(const DifferenceOptions& options);
  void reset();
  // picture: F(k). motion: frame k-1 to k, analysis pixels. current := D(k) = |F(k) - F(k-1)|, previous :=
  // D(k-1) = |F(k-1) - F(k-2)| (Eq. 2, whose printed elements are one index late), both in frame k's
  // coordinates; pixels not valid in all three frames are 0 in both. histogram: of `current` over the valid
  // pixels. Sizes of the three views must agree; a new size resets. `previous` may be empty: D(k-1) is not computed
  // then, and is unavailable in the first frame that requests it again. tolerant := how far F(k) is outside the levels of
  // the 3 x 3 pixels of F(k-1), which a displacement of a pixel does not explain; it may be empty as well.
  DifferenceResult update(GrayView picture, const Transform& motion, MutableGrayView current,
                          MutableGrayView previous, MutableGrayView tolerant, Histogram& histogram);
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
