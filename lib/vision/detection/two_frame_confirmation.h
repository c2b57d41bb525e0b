// SPDX-License-Identifier: LGPL-2.1-or-later
// What is seen for the first time in a scene that nobody knows yet: an error of registration, the last of somebody who
// has just left, a change of the light make a region in one frame; what moves is still there in the next one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/detection/regions.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

class TwoFrameConfirmation {
 public:
  void preallocate();
  void reset() { last_.clear(); }
  // Takes out of `regions` what is small and was not there one frame ago, in the first 25 frames of a scene: before
  // a standing camera, and of what comes in at the picture's edge, in the first 12. And what is too small to
  // tell, unless somebody has said how small it may be (minimum_area > 0). frames: of the scene, this one included;
  // motion: frame k-1 to k.
  void hold_back(std::vector<Region>& regions, int frames, double minimum_area, const Transform& motion,
                 Size picture);
  std::size_t bytes() const { return last_.capacity() * sizeof(Place); }

 private:
  // To the pixel: it is looked for around it.
  struct Place {
    std::int16_t x, y, width, height;
  };
  bool was_there(const Box& box, std::size_t before, const Transform& motion, double slack) const;

  std::vector<Place> last_;  // of the frame before, also those that were held back; then those of this frame
};

}  // namespace cerberus::vision
