// SPDX-License-Identifier: LGPL-2.1-or-later
// A region of interest: what RegionFinder finds and the tracker associates.
#pragma once

#include "vision/geometry/box.h"

namespace cerberus::vision {

// What a region is, as far as its size and the people of the scene say.
enum class RegionKind {
  person_like,  // one whole person, whose extent can be trusted
  group,  // as high as a person and wider: several people, or one with something; before people's height is
          // known: explained by several bodies whose heads are not seen
  part,   // too low for a person: a piece of one
  thing,  // neither: much larger, solid, or what shows no head before people's height is known
};

struct Region {
  // Analysis pixels. In the first 60 frames of a scene the box of a region that is not recognised as a person is two
  // pixels (of 320) larger on every side: the moving edge lies between the object and the place that it uncovers.
  Box box;
  double area = 0;        // moving pixels inside, of the cleaned mask
  double confidence = 0;  // that this is one whole object, 0..1
  int label = 0;          // value in the label picture (several regions may share one after a split)
  RegionKind kind = RegionKind::thing;
};

inline bool is_person_like(const Region& region) {
  return region.kind == RegionKind::person_like;
}

}  // namespace cerberus::vision
