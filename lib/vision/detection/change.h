// SPDX-License-Identifier: LGPL-2.1-or-later
// The difference to the frame before, as detection reads it.
#pragma once

#include "vision/image/image.h"

namespace cerberus::vision {

// Where the picture differs from the frame before.
struct Change {
  GrayView difference{};  // D(k), of the mask's size; else not known: all foreground counts as changed
  int threshold = 0;      // Th: D(k) > Th has changed (paper, Eq. 3)
  bool at(int x, int y) const { return difference.empty() || difference.at(x, y) > threshold; }
};

}  // namespace cerberus::vision
