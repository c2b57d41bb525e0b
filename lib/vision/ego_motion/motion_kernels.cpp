// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/motion_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/ego_motion/motion_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kPatch>;

HWY_INLINE hn::Vec<Floats> load_bytes(Floats d, const std::uint8_t* p) {
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const hn::Rebind<std::int32_t, Floats> ints;
  return hn::ConvertTo(d, hn::PromoteTo(ints, hn::LoadU(bytes, p)));
}

HWY_INLINE float total(Floats d, hn::Vec<Floats> v) {
  return hn::GetLane(hn::SumOfLanes(d, v));
}

void make_template(GrayView picture, int x, int y, PatchTemplate& patch) {
  const Floats d;
  constexpr int kPixels = kPatch * kPatch;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5f);
  auto sum_v = hn::Zero(d), sum_x = hn::Zero(d), sum_y = hn::Zero(d);
  for (int j = 0; j < kPatch; ++j)
    for (int i = 0; i < kPatch; i += lanes) {
      const std::uint8_t* p = &picture.at(x + i, y + j);
      const auto v = load_bytes(d, p);
      const auto gx = hn::Mul(half, hn::Sub(load_bytes(d, p + 1), load_bytes(d, p - 1)));
      const auto gy =
          hn::Mul(half, hn::Sub(load_bytes(d, p + picture.stride), load_bytes(d, p - picture.stride)));
      hn::Store(v, d, patch.value + j * kPatch + i);
      hn::Store(gx, d, patch.gx + j * kPatch + i);
      hn::Store(gy, d, patch.gy + j * kPatch + i);
      sum_v = hn::Add(sum_v, v), sum_x = hn::Add(sum_x, gx), sum_y = hn::Add(sum_y, gy);
    }
  const auto mean_v = hn::Set(d, total(d, sum_v) / kPixels);
  const auto mean_x = hn::Set(d, total(d, sum_x) / kPixels);
  const auto mean_y = hn::Set(d, total(d, sum_y) / kPixels);
  auto xx = hn::Zero(d), xy = hn::Zero(d), yy = hn::Zero(d), xv = hn::Zero(d), yv = hn::Zero(d),
       vv = hn::Zero(d);
  for (int i = 0; i < kPixels; i += lanes) {
    const auto v = hn::Sub(hn::Load(d, patch.value + i), mean_v);
    const auto gx = hn::Sub(hn::Load(d, patch.gx + i), mean_x);
    const auto gy = hn::Sub(hn::Load(d, patch.gy + i), mean_y);
    hn::Store(v, d, patch.value + i);
    hn::Store(gx, d, patch.gx + i);
    hn::Store(gy, d, patch.gy + i);
    xx = hn::MulAdd(gx, gx, xx), xy = hn::MulAdd(gx, gy, xy), yy = hn::MulAdd(gy, gy, yy);
    xv = hn::MulAdd(gx, v, xv), yv = hn::MulAdd(gy, v, yv), vv = hn::MulAdd(v, v, vv);
  }
  patch.xx = total(d, xx), patch.xy = total(d, xy), patch.yy = total(d, yy);
  patch.xv = total(d, xv), patch.yv = total(d, yv), patch.vv = total(d, vv);
}

PatchProducts match_patch(GrayView picture, float x, float y, const PatchTemplate& patch) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const auto fx = hn::Set(d, x - ix), fy = hn::Set(d, y - iy);
  auto with_x = hn::Zero(d), with_y = hn::Zero(d), with_v = hn::Zero(d), sum = hn::Zero(d),
       squares = hn::Zero(d);
  for (int i = 0; i < kPatch; i += lanes) {
    const std::uint8_t* p = &picture.at(ix + i, iy);
    const auto across = [&](const std::uint8_t* q) {
      const auto left = load_bytes(d, q);
      return hn::MulAdd(hn::Sub(load_bytes(d, q + 1), left), fx, left);
    };
    auto upper = across(p);
    for (int j = 0; j < kPatch; ++j) {
      p += picture.stride;
      const auto lower = across(p);
      const auto v = hn::MulAdd(hn::Sub(lower, upper), fy, upper);
      upper = lower;
      const int k = j * kPatch + i;
      with_x = hn::MulAdd(v, hn::Load(d, patch.gx + k), with_x);
      with_y = hn::MulAdd(v, hn::Load(d, patch.gy + k), with_y);
      with_v = hn::MulAdd(v, hn::Load(d, patch.value + k), with_v);
      sum = hn::Add(sum, v);
      squares = hn::MulAdd(v, v, squares);
    }
  }
  return {total(d, with_x), total(d, with_y), total(d, with_v), total(d, sum), total(d, squares)};
}

void sum_gradient_blocks(GrayView picture, int x, int y, int blocks, std::int32_t* xx, std::int32_t* xy,
                         std::int32_t* yy) {
  const hn::CappedTag<std::int32_t, 4> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(bytes, p)); };
  for (int b = 0; b < blocks; ++b) {
    auto sum_xx = hn::Zero(d), sum_xy = hn::Zero(d), sum_yy = hn::Zero(d);
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; i += static_cast<int>(hn::Lanes(d))) {
        const std::uint8_t* p = &picture.at(x + 4 * b + i, y + j);
        const auto gx = hn::Sub(load(p + 1), load(p - 1));
        const auto gy = hn::Sub(load(p + picture.stride), load(p - picture.stride));
        sum_xx = hn::Add(sum_xx, hn::Mul(gx, gx));
        sum_xy = hn::Add(sum_xy, hn::Mul(gx, gy));
        sum_yy = hn::Add(sum_yy, hn::Mul(gy, gy));
      }
    xx[b] = hn::GetLane(hn::SumOfLanes(d, sum_xx));
    xy[b] = hn::GetLane(hn::SumOfLanes(d, sum_xy));
    yy[b] = hn::GetLane(hn::SumOfLanes(d, sum_yy));
  }
}

std::uint32_t truncated_difference(const std::uint8_t* a, int stride_a, const std::uint8_t* b, int stride_b,
                                   int count, int rows, std::uint8_t limit) {
#if HWY_TARGET == HWY_SCALAR
  std::uint32_t sum = 0;
  for (int y = 0; y < rows; ++y, a += stride_a, b += stride_b)
    for (int i = 0; i < count; ++i) {
      const int difference = a[i] > b[i] ? a[i] - b[i] : b[i] - a[i];
      sum += static_cast<std::uint32_t>(difference < limit ? difference : limit);
    }
  return sum;
#else
  const hn::CappedTag<std::uint8_t, 16> d;
  const hn::Repartition<std::uint64_t, decltype(d)> d64;
  const auto most = hn::Set(d, limit);
  auto sum = hn::Zero(d64);
  for (int y = 0; y < rows; ++y, a += stride_a, b += stride_b)
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
      const auto va = hn::LoadU(d, a + i), vb = hn::LoadU(d, b + i);
      const auto difference = hn::Or(hn::SaturatedSub(va, vb), hn::SaturatedSub(vb, va));
      sum = hn::Add(sum, hn::SumsOf8(hn::Min(difference, most)));
    }
  return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(d64, sum)));
#endif
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(make_template);
HWY_EXPORT(match_patch);
HWY_EXPORT(sum_gradient_blocks);
HWY_EXPORT(truncated_difference);

void make_template(GrayView picture, int x, int y, PatchTemplate& patch) {
  HWY_DYNAMIC_DISPATCH(make_template)(picture, x, y, patch);
}

PatchProducts match_patch(GrayView picture, float x, float y, const PatchTemplate& patch) {
  return HWY_DYNAMIC_DISPATCH(match_patch)(picture, x, y, patch);
}

void sum_gradient_blocks(GrayView picture, int x, int y, int blocks, std::int32_t* xx, std::int32_t* xy,
                         std::int32_t* yy) {
  HWY_DYNAMIC_DISPATCH(sum_gradient_blocks)(picture, x, y, blocks, xx, xy, yy);
}

std::uint32_t truncated_difference(const std::uint8_t* a, int stride_a, const std::uint8_t* b, int stride_b,
                                   int count, int rows, std::uint8_t limit) {
  return HWY_DYNAMIC_DISPATCH(truncated_difference)(a, stride_a, b, stride_b, count, rows, limit);
}

}  // namespace cerberus::vision
#endif
