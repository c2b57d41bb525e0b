// SPDX-License-Identifier: LGPL-2.1-or-later
// The edge by which blurred pictures widen whatever moves in them.
#pragma once

#include <algorithm>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct BoxEdgeParameters {
  // Analysed pixels on each side. derived: the mean of three pixels reaches half a pixel to one beyond an edge, and a
  // threshold cuts a part of that off. swept: 0 to .5. Guard: widths on PETS09-S2L1 (bench-development).
  double blur = 0.4;
  double most = 0.1;  // share of an extent that is taken off on each side, at most: for boxes of a few pixels
};

// The box without that edge; where the frame cuts the box off there is none. pixel: size of an analysed pixel, in the
// frame's pixels, as `box`.
inline Box without_edge(const Box& box, double pixel, Size frame, const BoxEdgeParameters& parameters = {}) {
  const auto trim = [&](double& from, double& extent, int side) {
    const double by = std::min(parameters.blur * pixel, parameters.most * extent);
    const double low = from > 0 ? by : 0, high = from + extent < side ? by : 0;
    from += low, extent -= low + high;
  };
  Box trimmed = box;
  trim(trimmed.x, trimmed.width, frame.width);
  trim(trimmed.y, trimmed.height, frame.height);
  return trimmed;
}

}  // namespace cerberus::vision
