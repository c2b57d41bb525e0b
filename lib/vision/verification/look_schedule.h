// SPDX-License-Identifier: LGPL-2.1-or-later
// Which parts of the frame the detector is to see next.
#pragma once

#include <array>
#include <cstddef>
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
  Box box() const { return {double(x), double(y), double(width), double(height)}; }
};

// What one look shows to the detector: regions of the frame, each at a scale of its own, since a window of the detector that
// fits somebody near does not see somebody far away, and one that does takes a torso near the camera for a person.
struct LookRegions {
  static constexpr std::size_t kMost = 2;  // a third changes little. swept: docs/quality.md
  std::array<LookRegion, kMost> all;
  std::size_t count = 0;
  std::span<const LookRegion> chosen() const { return {all.data(), count}; }
};

// Returns up to `most` regions (LookRegions::kMost at most), none where no target has any doubt, or is high enough. Each
// is that around the most doubtful target that the earlier ones do not show, and around further targets of similar
// height, those with the most doubt for their area first, as far as the area of a look allows. The doubt of targets that
// are shown becomes 0.
LookRegions choose_look(std::span<LookTarget> targets, Size frame, std::size_t most,
                        const VerificationParameters& p);

// Whether one of the regions holds the box, and enlarges it so much that the detector can see somebody as high as `height`,
// frame pixels.
bool shows(const LookRegions& look, const Box& box, double height, const VerificationParameters& p);

}  // namespace cerberus::vision
