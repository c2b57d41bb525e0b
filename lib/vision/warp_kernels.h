// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loop of Warp, chosen for the processor at run time.
#pragma once

#include <cstdint>

#include "vision/image.h"

namespace cerberus::vision {

// out[i] = source at (x[i] / 128, y[i] / 128), bilinear, rounded to nearest, for i < count.
// 0 <= x[i] <= 128 (width - 1), the same for y; the source is at least 2 x 2.
void sample_bilinear(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                     std::uint8_t* out);
void sample_bilinear(View<const std::uint16_t> source, const std::int32_t* x, const std::int32_t* y,
                     int count, std::uint16_t* out);

}  // namespace cerberus::vision
