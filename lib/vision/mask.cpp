// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/mask.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace cerberus::vision {

namespace {

// The top bits of eight bytes, byte 0 first: each 0x80 bit travels to its own place in the highest byte.
inline std::uint64_t gather_top_bits(std::uint64_t bytes) {
  return ((bytes & 0x8080808080808080u) >> 7) * 0x0102040810204080u >> 56;
}

template <typename Test>
void pack_rows(GrayView picture, MutableBitView bits, Test&& test) {
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* in = picture.row(y);
    std::uint64_t* out = bits.row(y);
    for (int word = 0; word < bits.width; ++word) {
      const int begin = word * 64, end = begin + 64 < picture.width ? begin + 64 : picture.width;
      // 0x80 or 0 a pixel (a loop the compiler turns into vectors), then eight pixels at a time into bits.
      std::uint8_t flags[64];
      if (end - begin < 64) std::memset(flags, 0, sizeof flags);
      for (int x = begin; x < end; ++x) flags[x - begin] = test(in[x]) ? 0x80 : 0;
      std::uint64_t value = 0;
      for (int group = 0; group < 8; ++group) {
        std::uint64_t eight = 0;
        if constexpr (std::endian::native == std::endian::little) {
          std::memcpy(&eight, flags + 8 * group, 8);
        } else {
          for (int i = 0; i < 8; ++i) eight |= static_cast<std::uint64_t>(flags[8 * group + i]) << (8 * i);
        }
        value |= gather_top_bits(eight) << (8 * group);
      }
      out[word] = value;
    }
  }
}

// The bits of a byte as eight bytes, 0 or 255, the lowest first.
constexpr auto kSpread = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (unsigned bits = 0; bits < 256; ++bits)
    for (unsigned i = 0; i < 8; ++i) table[bits][i] = bits >> i & 1 ? 255 : 0;
  return table;
}();

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
  if (threshold < 0) threshold = 0;
  if (threshold > 255) threshold = 255;
  const auto limit = static_cast<std::uint8_t>(threshold);
  pack_rows(picture, bits, [limit](std::uint8_t value) { return value > limit; });
}

void pack(GrayView mask, MutableBitView bits) {
  pack_rows(mask, bits, [](std::uint8_t value) { return value != 0; });
}

void unpack(BitView bits, MutableGrayView mask) {
  for (int y = 0; y < mask.height; ++y) {
    const std::uint64_t* in = bits.row(y);
    std::uint8_t* out = mask.row(y);
    for (int begin = 0; begin < mask.width; begin += 64) {
      const std::uint64_t word = in[begin / 64];
      const int count = mask.width - begin < 64 ? mask.width - begin : 64;
      if (word == 0) {
        std::memset(out + begin, 0, static_cast<std::size_t>(count));
      } else {
        for (int i = 0; i < count; i += 8)
          std::memcpy(out + begin + i, kSpread[word >> i & 255].data(), std::min(count - i, 8));
      }
    }
  }
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

long count(BitView bits) {
  long total = 0;
  for (int y = 0; y < bits.height; ++y)
    for (int x = 0; x < bits.width; ++x) total += std::popcount(bits.row(y)[x]);
  return total;
}

}  // namespace cerberus::vision
