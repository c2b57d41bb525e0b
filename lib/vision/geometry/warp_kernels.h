// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of Warp, chosen for the processor at run time.
#pragma once

#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

// out[i] = (start + i * step) >> shift for i < count.
void step_positions(std::int32_t start, std::int32_t step, int shift, int count, std::int32_t* out);

// Positions in 1/128 pixel of the pixels (x0 + i, y), i < count, under the homography m (row-major), rounded and kept
// within [0, right] and [0, low].
void project_positions(const float (&m)[9], int x0, int y, int count, std::int32_t right, std::int32_t low,
                       std::int32_t* x, std::int32_t* y_out);

// out[i] = source at (x[i] / 128, y[i] / 128), bilinear, rounded to nearest, for i < count.
// 0 <= x[i] <= 128 (width - 1), the same for y; the source is at least 2 x 2.
void sample_bilinear(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                     std::uint8_t* out);
// The same of the nearest pixel; the source may be of any size.
void sample_nearest(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                    std::uint8_t* out);

}  // namespace cerberus::vision
