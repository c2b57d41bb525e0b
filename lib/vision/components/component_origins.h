// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a difference from the background model began inside the picture or came from outside. An object from outside
// is not in the model; the model may show an object that starts to move in the middle of the picture.
#pragma once

#include <cstddef>

#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Two bits a pixel: it differed one frame ago; its difference began inside the picture. For a camera that stands.
class ComponentOrigins {
 public:
  void preallocate(Size picture);
  // No pixel has differed yet.
  void reset();

  // Pixels in and beside a component that differed one frame ago, and those of them that began inside.
  struct Overlap {
    int differed = 0, inside = 0;
  };
  void add_overlap(const Run& run, Overlap& overlap) const;

  // The origin of a run's component: its new pixels take it over.
  enum class Origin { outside, inside };
  void record(const Run& run, Origin origin);
  // Ends the frame. differs: all recorded pixels; gone: those that do not differ any more from now on.
  void step(BitView differs, BitView gone);
  // More pixels that do not differ any more.
  void forget(BitView gone);

  std::size_t bytes() const { return differed_.bytes() + inside_.bytes(); }

 private:
  BitMask differed_, inside_;
};

}  // namespace cerberus::vision
