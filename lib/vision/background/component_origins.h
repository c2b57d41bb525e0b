// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether what differs from the scene's memory began to do so in the middle of the picture. Who comes from outside has
// left nothing in the scene; of something that begins to move in the middle of it, the memory may have the picture.
#pragma once

#include <cstddef>

#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Two bits a pixel: differed one frame ago, and began here. For a camera that stands.
class ComponentOrigins {
 public:
  void preallocate(Size picture);
  // Nothing has differed yet.
  void begin();

  // Pixels beside and in a part that differed one frame ago, and those of them that began here.
  struct Before {
    int any = 0, here = 0;
  };
  void add(const Run& run, Before& before) const;

  // What is now known of a run's part: new pixels are as most of it is. found: it is known where all of it began, and
  // no doubt is left.
  enum class Origin { elsewhere, here, found };
  void note(const Run& run, Origin origin);
  // This frame is the one before now. differs: all that was noted; gone: what does not differ any more from now on.
  void step(BitView differs, BitView gone);

  std::size_t bytes() const { return differed_.bytes() + here_.bytes(); }

 private:
  BitMask differed_, here_;
};

}  // namespace cerberus::vision
