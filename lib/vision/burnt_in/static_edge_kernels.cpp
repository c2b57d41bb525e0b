// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/static_edge_kernels.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/burnt_in/static_edge_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Bits are stored as bytes.
static_assert(std::endian::native == std::endian::little);

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
EdgeBits compare_edges(EdgeSides now, EdgeSides then, int count, std::uint8_t edge, std::uint8_t same) {
  return compare_edges_reference(now, then, count, edge, same);
}
#else

constexpr int kMost = 64;
using Pixels = hn::CappedTag<std::uint8_t, kMost>;  // 8 at least

EdgeBits compare_whole_word(EdgeSides now, EdgeSides then, std::uint8_t edge, std::uint8_t same) {
  const Pixels d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto least = hn::Set(d, edge), most = hn::Set(d, same);
  const auto difference = [](auto a, auto b) { return hn::Sub(hn::Max(a, b), hn::Min(a, b)); };
  EdgeBits out;
  auto* edges = reinterpret_cast<std::uint8_t*>(&out.edges);
  auto* fixed = reinterpret_cast<std::uint8_t*>(&out.fixed);
  for (int i = 0; i < kMost; i += lanes) {
    const auto first = hn::LoadU(d, now.first + i), second = hn::LoadU(d, now.second + i);
    const auto step = difference(first, second);
    const auto is_edge = hn::Eq(hn::Max(step, least), step);
    const auto moved = hn::Max(difference(first, hn::LoadU(d, then.first + i)),
                               difference(second, hn::LoadU(d, then.second + i)));
    hn::StoreMaskBits(d, is_edge, edges + i / 8);
    hn::StoreMaskBits(d, hn::And(is_edge, hn::Eq(hn::Max(moved, most), most)), fixed + i / 8);
  }
  return out;
}

EdgeBits compare_edges(EdgeSides now, EdgeSides then, int count, std::uint8_t edge, std::uint8_t same) {
  if (count == kMost) return compare_whole_word(now, then, edge, same);
  std::uint8_t rows[4][kMost] = {};
  const std::uint8_t* from[] = {now.first, now.second, then.first, then.second};
  for (int i = 0; i < 4; ++i) std::memcpy(rows[i], from[i], static_cast<std::size_t>(count));
  EdgeBits out = compare_whole_word({rows[0], rows[1]}, {rows[2], rows[3]}, edge, same);
  const std::uint64_t ones = (std::uint64_t{1} << count) - 1;  // with edge 0 the padding has edges, too
  return {out.edges & ones, out.fixed & ones};
}
#endif

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(compare_edges);

EdgeBits compare_edges(EdgeSides now, EdgeSides then, int count, std::uint8_t edge, std::uint8_t same) {
  return HWY_DYNAMIC_DISPATCH(compare_edges)(now, then, std::clamp(count, 0, 64), edge, same);
}

EdgeBits compare_edges_reference(EdgeSides now, EdgeSides then, int count, std::uint8_t edge,
                                 std::uint8_t same) {
  EdgeBits out;
  for (int i = 0; i < count; ++i) {
    const bool is_edge = std::abs(now.second[i] - now.first[i]) >= edge;
    const bool is_fixed =
        std::abs(now.first[i] - then.first[i]) <= same && std::abs(now.second[i] - then.second[i]) <= same;
    out.edges |= std::uint64_t{is_edge} << i;
    out.fixed |= std::uint64_t{is_edge && is_fixed} << i;
  }
  return out;
}

}  // namespace cerberus::vision
#endif
