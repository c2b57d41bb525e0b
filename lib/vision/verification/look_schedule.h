// SPDX-License-Identifier: LGPL-2.1-or-later
// Which part of the frame the detector is to see next.
#pragma once

#include <optional>
#include <span>

#include "vision/geometry/box.h"
#include "vision/image/image.h"
#include "vision/verification/verification_parameters.h"

namespace cerberus::vision {

struct LookTarget {
  Box box;            // frame pixels
  double doubt = 0;   // the larger, the sooner; 0: no look is needed
  double height = 0;  // frame pixels: of a person in it, as far as it is known
};

struct LookRegion {
  int x = 0, y = 0, width = 0, height = 0;  // frame pixels, within the frame
  double scale = 1;                         // by which the detector enlarges it
};

// Returns the region around the most doubtful target, and around further targets of similar height as far as the area
// of a look allows, those with the most doubt for their area first. nullopt: no target has any doubt, or is high
// enough.
std::optional<LookRegion> choose_look(std::span<const LookTarget> targets, Size frame,
                                      const VerificationParameters& p);

}  // namespace cerberus::vision
