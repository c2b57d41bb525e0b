// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/mask.h"

#include <algorithm>

#include "vision/image/mask_kernels.h"

namespace cerberus::vision {

namespace {

template <typename Operation>
void combine(BitView a, BitView b, MutableBitView out, Operation&& operation) {
  for (int y = 0; y < out.height; ++y) {
    const std::uint64_t *p = a.row(y), *q = b.row(y);
    std::uint64_t* o = out.row(y);
    for (int x = 0; x < out.width; ++x) o[x] = operation(p[x], q[x]);
  }
}

}  // namespace

void binarise(GrayView picture, int threshold, MutableBitView bits) {
  const auto limit = static_cast<std::uint8_t>(std::clamp(threshold, 0, 255));
  for (int y = 0; y < picture.height; ++y) binarise_row(picture.row(y), picture.width, limit, bits.row(y));
}

void pack(GrayView mask, MutableBitView bits) {
  binarise(mask, 0, bits);
}

void unpack(BitView bits, MutableGrayView mask) {
  for (int y = 0; y < mask.height; ++y) unpack_row(bits.row(y), mask.width, mask.row(y));
}

void intersect(BitView a, BitView b, MutableBitView out) {
  combine(a, b, out, [](std::uint64_t p, std::uint64_t q) { return p & q; });
}

void unite(BitView a, BitView b, MutableBitView out) {
  combine(a, b, out, [](std::uint64_t p, std::uint64_t q) { return p | q; });
}

void subtract(BitView a, BitView b, MutableBitView out) {
  combine(a, b, out, [](std::uint64_t p, std::uint64_t q) { return p & ~q; });
}

}  // namespace cerberus::vision
