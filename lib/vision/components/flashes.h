// SPDX-License-Identifier: LGPL-2.1-or-later
// Components that differ from the background in one frame only, each time elsewhere: rain, snow, insects near the lens. An
// object goes on from where it was a frame ago. A fast one may be ahead of itself, so new components are flashes only where
// every frame has several. For a camera that stands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class Flashes {
 public:
  void preallocate(Size picture, std::size_t components);
  // The scene is new, or the camera has moved.
  void reset();
  // mask: where the frame, of this size, differs from the background, and its components. seconds: from frame to frame.
  void find(Size picture, BitView mask, std::span<const Component> components, std::span<const Run> runs,
            double seconds);
  // Whether the component of this index, of the last find(), is one: less than half of it lies where, or beside where, one
  // was that had gone on itself. By chance a streak covers half of another one's place, but seldom twice.
  bool is_flash(std::size_t index, const Component& component) const;
  std::size_t bytes() const {
    return before_.bytes() + goes_on_.bytes() + covered_.capacity() * sizeof(Covered);
  }

 private:
  struct Covered {  // pixels of a component
    std::uint32_t before = 0, goes_on = 0;
  };
  void count(BitView mask, double seconds);
  static bool is_new(std::uint32_t covered, const Component& component);

  BitMask before_;      // the mask one frame ago,
  BitMask goes_on_;     // and its components that were not new
  int fresh_ = 0;       // new components of the last frame
  double flashes_ = 0;  // a frame: mean of the scene's first second, then of about the last one
  double seconds_ = 0;  // of the scene
  std::vector<Covered> covered_;
};

}  // namespace cerberus::vision
