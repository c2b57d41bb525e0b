// SPDX-License-Identifier: LGPL-2.1-or-later
// The edge by which the blur before the comparison of pictures widens whatever moves.
#pragma once

#include <algorithm>

#include "vision/geometry/box.h"

namespace cerberus::vision {

struct BoxEdgeParameters {
  // Analysed pixels on each side. derived: the mean of three pixels reaches half a pixel to one beyond an edge, and a
  // threshold cuts a part of that off. swept: docs/quality.md, 0 to .5. Guard: widths on PETS09-S2L1 (bench-fit).
  double blur = 0.4;
  double most = 0.1;  // share of an extent that is taken off on each side, at most: for boxes of a few pixels
};

// The box without that edge. pixel: size of an analysed pixel, in the unit of the box.
inline Box without_edge(const Box& box, double pixel, const BoxEdgeParameters& parameters = {}) {
  const double x = std::min(parameters.blur * pixel, parameters.most * box.width);
  const double y = std::min(parameters.blur * pixel, parameters.most * box.height);
  return {box.x + x, box.y + y, box.width - 2 * x, box.height - 2 * y};
}

}  // namespace cerberus::vision
