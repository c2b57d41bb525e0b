// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/mask_kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/image/mask_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Bits of a mask are loaded and stored as bytes.
static_assert(std::endian::native == std::endian::little);

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
void binarise_row(const std::uint8_t* row, int width, std::uint8_t limit, std::uint64_t* bits) {
  for (int begin = 0; begin < width; begin += 64) {
    std::uint64_t word = 0;
    for (int i = 0; i < std::min(width - begin, 64); ++i) word |= std::uint64_t{row[begin + i] > limit} << i;
    bits[begin / 64] = word;
  }
}

void unpack_row(const std::uint64_t* bits, int width, std::uint8_t* row) {
  for (int x = 0; x < width; ++x) row[x] = bits[x / 64] >> (x % 64) & 1 ? 255 : 0;
}
#else

using Pixels = hn::CappedTag<std::uint8_t, 64>;  // 8 at least

void binarise_row(const std::uint8_t* row, int width, std::uint8_t limit, std::uint64_t* bits) {
  const Pixels d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto above = hn::Set(d, limit);
  auto* bytes = reinterpret_cast<std::uint8_t*>(bits);
  const auto store = [&](const std::uint8_t* from, int x) {
    hn::StoreMaskBits(d, hn::Gt(hn::LoadU(d, from), above), bytes + x / 8);
  };
  int x = 0;
  for (; x + lanes <= width; x += lanes) store(row + x, x);
  const int end = (width + 63) / 64 * 64;
  if (x == end) return;
  std::uint8_t rest[64] = {};  // the padding 0 exceeds no limit
  std::memcpy(rest, row + x, static_cast<std::size_t>(width - x));
  for (const int begin = x; x < end; x += lanes) store(rest + (x - begin), x);
}

void unpack_row(const std::uint64_t* bits, int width, std::uint8_t* row) {
  const Pixels d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(bits);
  const auto load = [&](int x) { return hn::VecFromMask(d, hn::LoadMaskBits(d, bytes + x / 8)); };
  int x = 0;
  for (; x + lanes <= width; x += lanes) hn::StoreU(load(x), d, row + x);
  if (x == width) return;
  std::uint8_t rest[64];
  hn::StoreU(load(x), d, rest);
  std::memcpy(row + x, rest, static_cast<std::size_t>(width - x));
}
#endif

using Words = hn::ScalableTag<std::uint64_t>;

void unite_with_later(std::uint64_t* words, std::size_t count, std::size_t distance) {
  const Words d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes)
    hn::StoreU(hn::Or(hn::LoadU(d, words + k), hn::LoadU(d, words + k + distance)), d, words + k);
  for (; k < count; ++k) words[k] |= words[k + distance];
}

void unite_with_earlier(std::uint64_t* words, std::size_t count, std::size_t distance) {
  const Words d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = count;
  for (; k >= lanes; k -= lanes) {
    std::uint64_t* to = words + distance + k - lanes;
    hn::StoreU(hn::Or(hn::LoadU(d, to), hn::LoadU(d, to - distance)), d, to);
  }
  for (; k > 0; --k) words[distance + k - 1] |= words[k - 1];
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(binarise_row);
HWY_EXPORT(unpack_row);
HWY_EXPORT(unite_with_later);
HWY_EXPORT(unite_with_earlier);

void binarise_row(const std::uint8_t* row, int width, std::uint8_t limit, std::uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(binarise_row)(row, width, limit, bits);
}
void unpack_row(const std::uint64_t* bits, int width, std::uint8_t* row) {
  HWY_DYNAMIC_DISPATCH(unpack_row)(bits, width, row);
}
void unite_with_later(std::uint64_t* words, std::size_t count, std::size_t distance) {
  HWY_DYNAMIC_DISPATCH(unite_with_later)(words, count, distance);
}
void unite_with_earlier(std::uint64_t* words, std::size_t count, std::size_t distance) {
  HWY_DYNAMIC_DISPATCH(unite_with_earlier)(words, count, distance);
}

}  // namespace cerberus::vision
#endif
