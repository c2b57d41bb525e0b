// SPDX-License-Identifier: LGPL-2.1-or-later
// The box of a blob without the shadow that lies beside it: with and without outstretched limbs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vision/detection/person.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

struct Outline {
  Bounds body;   // columns of much foreground: head and trunk
  Bounds whole;  // with the limbs beside them
};

class OutlineFinder {
 public:
  // Lengths in heights of the blob. Guard: tests/unit/regions, tracks on davis_tennis and PETS09-S2L1 (bench-quality).
  struct Parameters {
    // Columns of a body have this share of the foreground of the highest column. By hand on vtest.avi.
    double skirt = 0.3;
    // Limbs are lower columns next to the body, up to this distance. derived: an arm is .44 of a person's height.
    double reach = 0.5;
    // A limb's columns have so much foreground, before closing, above the zone where shadows lie. measured: MOTA on
    // davis_tennis and PETS09-S2L1 is .71 and .72 with a thickness of .08, .83 and .72 with .05, .83 and .72 with .03,
    // where a tape that sways counts as an arm; .86 and .70 with a zone of .3.
    double thickness = 0.05;
    double shadow_zone = 0.4;  // from the ground upwards
    // A leg in stride, beside the body and below that height: it begins at `knee` or above and falls by `slope` rows a
    // column. It ends where it last fell, once it has not fallen for `toes`. In a blob where `thickness` is less than
    // `least_leg` pixels no leg is looked for: it could not be told from a shadow. swept: .1 to .25, .3 to .8,
    // .06 to .15 and 1 to 5. Guard: the width of the player's box on davis_tennis (bench-development).
    double knee = 0.15, slope = 0.5, toes = 0.1;
    int least_leg = 4;
  };

  OutlineFinder() = default;
  explicit OutlineFinder(const Parameters& parameters) : parameters_(parameters) {}

  // Takes the memory for pictures of this width; outline() takes none.
  void preallocate(int width);
  // closed: the component `self` and the runs of all of them, by row. moving: the foreground before closing, of the same
  // picture.
  Outline outline(const Component& component, std::size_t self, std::span<const Run> runs, BitView moving);
  std::size_t bytes() const;

 private:
  Bounds find_body(const Component& component, std::size_t self, std::span<const Run> runs);
  Bounds add_limbs(const Component& component, const Bounds& body, BitView moving);
  int leg(const Component& component, int first, int step, int most, BitView moving) const;

  Parameters parameters_;
  std::vector<int> columns_;  // scratch: foreground of a component in each of its columns
};

}  // namespace cerberus::vision
