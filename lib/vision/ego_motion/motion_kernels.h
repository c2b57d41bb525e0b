// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of the camera motion estimate, chosen for the processor at run time.
#pragma once

#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

constexpr int kPatch = 8;  // side of a patch, pixels of its pyramid level

// A patch of the earlier picture with its gradients, each with its mean removed, and their inner products.
struct PatchTemplate {
  alignas(64) float value[kPatch * kPatch];
  alignas(64) float gx[kPatch * kPatch];  // (I(x+1) - I(x-1)) / 2
  alignas(64) float gy[kPatch * kPatch];
  float xx, xy, yy, xv, yv,
      vv;  // sums over the patch of gx gx, gx gy, gy gy, gx value, gy value, value value
};
// Makes the template of the patch whose top left corner is (x, y); reads one more pixel on every side.
void make_template(GrayView picture, int x, int y, PatchTemplate& patch);

// Inner products of the template with the later picture's patch at (x, y), bilinear.
struct PatchProducts {
  float x, y, value;   // with gx, gy, value
  float sum, squares;  // of the later picture's patch itself
};
// Needs 0 <= x <= width - kPatch - 1, the same for y.
PatchProducts match_patch(GrayView picture, float x, float y, const PatchTemplate& patch);

// Products of central differences (over two pixels, not halved) summed over blocks of 4 x 4 pixels from (x, y) to the
// right: xx[b] = sum of gx gx, xy of gx gy, yy of gy gy. Reads one pixel around the blocks.
void sum_gradient_blocks(GrayView picture, int x, int y, int blocks, std::int32_t* xx, std::int32_t* xy,
                         std::int32_t* yy);

// Sum over `rows` rows of `count` bytes of min(|a - b|, limit). count a multiple of 16, strides in bytes.
std::uint32_t truncated_difference(const std::uint8_t* a, int stride_a, const std::uint8_t* b, int stride_b,
                                   int count, int rows, std::uint8_t limit);

}  // namespace cerberus::vision
