// SPDX-License-Identifier: LGPL-2.1-or-later
// From the foreground mask to regions of interest: closing, labelling, joining the fragments of one person, parting
// people side by side ("post treatment" of the paper).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "vision/detection/change.h"
#include "vision/detection/region.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct DetectionParameters;  // region_parameters.h

struct RegionOptions {
  int closing = 9;     // side of the closing, analysis pixels at 320 wide; scaled with the picture
  bool people = true;  // merge and split by a person's learnt height; off: plain components, to the pixel
  double minimum_area = 0;  // analysis pixels; 0: chosen from the picture's size
};

class RegionFinder {
 public:
  RegionFinder();
  ~RegionFinder();
  RegionFinder(RegionFinder&&) noexcept;
  RegionFinder& operator=(RegionFinder&&) noexcept;

  void set_options(const RegionOptions& options);
  // Begins anew with these numbers, and the options that were set.
  void set_parameters(const DetectionParameters& parameters);
  // Forgets the scene: learnt heights, young-scene rules. Called at a cut.
  void reset();
  // mask: in the moving area (0 / 255), out the cleaned mask that the regions were made from. labels: 0 = background,
  // may be empty. Small regions of a young scene are returned from their second frame on, see TwoFrameConfirmation.
  // motion: frame k-1 to k, analysis pixels, by which the learnt heights move with the camera. change: what rests at the
  // sides of a person who moves is not of his box. While the height of people is not known, what rests is not parted from its
  // neighbours. The span lives until the next
  // call. Memory is bounded and allocated at the first picture of a size; components beyond it are clutter, see Labeller.
  std::span<const Region> update(MutableGrayView mask, View<std::uint16_t> labels, const Transform& motion,
                                 const Change& change = {});
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
