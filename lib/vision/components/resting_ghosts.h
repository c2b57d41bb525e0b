// SPDX-License-Identifier: LGPL-2.1-or-later
// Ghosts that people pass. The place of somebody who stood there when the scene began stays foreground after he has left,
// and while others walk past it both are one component, which moves. What rests within the foreground is therefore judged
// by itself: where it borders on the background, the edge of a ghost is in the background model and not in the frame.
#pragma once

#include <cstddef>

#include "vision/components/visible_columns.h"
#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class RestingGhosts {
 public:
  struct Pictures {
    GrayView frame, background;  // blurred alike, under the same light
    GrayView quiet;              // ticks since a pixel moved
    GrayView age;                // frames for which the model has learnt a pixel; empty: it has learnt all
    VisibleColumns visible;
  };

  void preallocate(Size picture) { places_.resize(bit_mask_size(picture)); }
  // Takes the ghosts from `mask`, the foreground, and adds them to `absorb`, the pixels that the background model takes
  // over. rested: ticks without motion, at least one, from which on a pixel rests. labeller: scratch memory.
  void remove(const Pictures& pictures, int rested, Labeller& labeller, MutableBitView mask,
              MutableBitView absorb);
  std::size_t bytes() const { return places_.bytes(); }

 private:
  BitMask places_;  // where a ghost may be
};

}  // namespace cerberus::vision
