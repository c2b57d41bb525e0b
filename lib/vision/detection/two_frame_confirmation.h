// SPDX-License-Identifier: LGPL-2.1-or-later
// Confirmation over two frames in a young scene: an error of registration, the remains of an object that has just left
// and a change of the light make a region in one frame only; an object is still there in the next one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/detection/region.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

class TwoFrameConfirmation {
 public:
  // Where no origin stands the value was chosen by hand. Guard: tests/unit/two_frame_confirmation, bench-steady.
  struct Parameters {
    int frames = 25;       // of a scene in which small regions are confirmed
    int first = 3;         // up to this frame a standing camera's regions pass: there is no frame before them
    double small = 0.015;  // of the picture's area: a larger region passes at once
    double speck =
        1 / 1280.0;       // of the picture's area: a smaller one is dropped where the caller sets no minimum
    double common = 0.5;  // of the box that lies where a region was a frame before
    double reach = 0.25;  // of that region's smaller side by which it may have moved,
    double slack = 4;     // pixels at 320 columns, or grown
  };
  static constexpr std::size_t kMost = 64;  // regions a frame that are remembered

  TwoFrameConfirmation() = default;
  explicit TwoFrameConfirmation(const Parameters& parameters) : parameters_(parameters) {}

  void preallocate();
  void reset() { last_.clear(); }
  // Removes from `regions` what is small and was not there one frame ago, in the first Parameters::frames frames of a
  // scene; before a standing camera, and at the picture's edge, in the first kUnsettledFrames only. Removes specks
  // unless minimum_area > 0. frames: of the scene, this one included; motion: frame k-1 to k; picture: analysis pixels.
  void filter(std::vector<Region>& regions, int frames, double minimum_area, const Transform& motion,
              Size picture);
  std::size_t bytes() const { return last_.capacity() * sizeof(Place); }

 private:
  struct Place {  // pixels
    std::int16_t x, y, width, height;
  };
  bool was_there(const Box& box, std::size_t before, const Transform& motion, double slack) const;

  Parameters parameters_;
  std::vector<Place> last_;  // of the frame before, removed ones too; then those of this frame
};

}  // namespace cerberus::vision
