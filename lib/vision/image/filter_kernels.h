// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of blur3() and Pyramid, chosen for the processor at run time.
#pragma once

#include <cstdint>

namespace cerberus::vision {

// out[x] = rounded mean of the 3 x 3 neighbourhood; end pixels repeated outwards.
void blur3_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
               std::uint8_t* out);

// out[x] = (upper[2x] + upper[2x+1] + lower[2x] + lower[2x+1] + 2) / 4 for x < width.
void halve_rows(const std::uint8_t* upper, const std::uint8_t* lower, int width, std::uint8_t* out);

}  // namespace cerberus::vision
