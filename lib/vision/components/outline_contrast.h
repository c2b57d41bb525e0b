// SPDX-License-Identifier: LGPL-2.1-or-later
// What the contrast across an outline tells: that of an object is an edge of the frame, that of a ghost, a place that an
// object left, one of the background.
#pragma once

#include "vision/image/image.h"

namespace cerberus::vision {

struct OutlineContrast {
  int pixels = 0;                 // of the outline that could be compared, ...
  int frame = 0, background = 0;  // ... and the sums of their contrasts, grey levels

  // From the pixel `out` of a row to its pixel `in`. Both pictures are blurred alike and under the same light.
  void add(GrayView in_frame, GrayView in_background, int row, int out, int in);

  bool is_object() const;
  bool is_ghost() const;
  // Also of a part of an outline, or of one that ends where the object and the background behind it happen to be alike.
  bool is_certain_ghost() const;
  bool is_certain_object() const;
  // As one of an object's two sides; true also if nothing could be compared.
  bool is_side_of_object() const;
};

}  // namespace cerberus::vision
