// SPDX-License-Identifier: LGPL-2.1-or-later
// Selection and matching of patches: small parts of the picture with enough texture to be found again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "vision/ego_motion/motion_fit.h"
#include "vision/ego_motion/motion_kernels.h"
#include "vision/geometry/box.h"
#include "vision/image/image.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

struct PatchSite {
  float x, y;           // centre, pixels of level 0
  std::uint8_t region;  // of MotionSamples::kRegions, 4 x 4 over the picture
};

// The result of matching one patch.
struct PatchMatch {
  float dx = 0, dy = 0;  // displacement, pixels of the level; of its centre (x, y) on that level
  float x = 0, y = 0;
  float correlation = 0;            // of the two patches, -1..1; 0 where the patch left the picture
  bool inside = false;              // the searched place lies in the later picture
  float noise2 = 0;                 // variance of the residual, grey levels^2
  float hxx = 0, hxy = 0, hyy = 0;  // gradient information, gain taken out, grey levels^2 / pixel^2
};

// Matches one patch on one level by inverse compositional Gauss-Newton (Baker and Matthews, IJCV 56(3), 2004) with gain
// and offset as further unknowns, so that the light may change. Template and gradients come from the earlier picture
// and are computed once for all places of the search.
class PatchFollower {
 public:
  static constexpr int kSide =
      kPatch + 2;  // side of the pixels that are read: the patch and a pixel around it
  struct Corner {
    int x, y;  // upper left pixel of the patch
  };
  // Returns the patch's corner on a level of that size; nullopt if the level is too small for it.
  static std::optional<Corner> corner_on(Size size, int level, const PatchSite& site);

  PatchFollower(GrayView earlier, int level, const PatchSite& site);
  // The same from a part of the earlier picture, kSide x kSide pixels, with the patch in its middle.
  PatchFollower(GrayView part, const Corner& corner) { begin(part, corner); }
  // Searches from displacement (dx, dy), pixels of the level, for at most `rounds` steps; 0 only rates the given place.
  PatchMatch follow(GrayView later, float dx, float dy, int rounds) const;

 private:
  void begin(GrayView part, const Corner& corner);

  PatchTemplate patch_;
  PatchMatch match_;  // the fields that do not depend on the later picture
  int corner_x_ = 0, corner_y_ = 0;
  float per_value_ = 0;
  float gain_x_ = 0, gain_y_ = 0;      // share of the gradients that a change of gain explains
  float ixx_ = 0, ixy_ = 0, iyy_ = 0;  // inverse of the stiffened gradient information
  bool textured_ = false;
};

// The patch with the best texture of every cell of a grid of at most 16 x 12 cells; cells without texture have none.
struct PatchSites {
  int count = 0;
  std::array<PatchSite, MotionSamples::kMax> site;

  // noise: standard deviation of a pixel of level 0, grey levels; the texture of a patch must exceed it. Allocates only
  // when the size changes. excluded: pixels of level 0 that show no scene (burnt_in.h); no patch touches them.
  void choose(const Pyramid& pyramid, double noise, Image<std::int32_t>& scratch,
              std::span<const Box> excluded = {});
  // Drops the patches that touch `excluded`.
  void exclude(std::span<const Box> excluded);
  // Returns the follower on level 0. The pixels that it needs were copied: the picture may be gone.
  PatchFollower follower(int i) const;
  std::size_t bytes() const { return kept_.bytes(); }  // beside the object itself

 private:
  Size size_;
  Image<std::uint8_t, 1> kept_;  // a row for each site
};

}  // namespace cerberus::vision
