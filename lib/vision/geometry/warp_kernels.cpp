// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/warp_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/geometry/warp_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void step_positions(std::int32_t start, std::int32_t step, int shift, int count, std::int32_t* out) {
  const hn::ScalableTag<std::int32_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto position = hn::Add(hn::Set(d, start), hn::Mul(hn::Iota(d, 0), hn::Set(d, step)));
  const auto stride = hn::Set(d, step * lanes);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(hn::ShiftRightSame(position, shift), d, out + i);
    position = hn::Add(position, stride);
  }
  for (; i < count; ++i) out[i] = (start + i * step) >> shift;
}

void project_positions(const float (&m)[9], int x0, int y, int count, std::int32_t right, std::int32_t low,
                       std::int32_t* x, std::int32_t* y_out) {
  const float row = static_cast<float>(y);
  const auto run = [&](auto d, int begin, int end) {
    const hn::RebindToSigned<decltype(d)> ints;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const auto along_x = hn::Set(d, m[0]), along_y = hn::Set(d, m[3]), along_w = hn::Set(d, m[6]);
    const auto at_x = hn::Set(d, m[1] * row + m[2]), at_y = hn::Set(d, m[4] * row + m[5]),
               at_w = hn::Set(d, m[7] * row + m[8]);
    const auto most_x = hn::Set(d, static_cast<float>(right)), most_y = hn::Set(d, static_cast<float>(low));
    const auto one = hn::Set(d, 128.0f), half = hn::Set(d, 0.5f),
               step = hn::Set(d, static_cast<float>(lanes));
    auto column = hn::Add(hn::Iota(d, 0), hn::Set(d, static_cast<float>(x0 + begin)));
    for (int i = begin; i < end; i += lanes) {
      const auto scale = hn::Div(one, hn::MulAdd(column, along_w, at_w));
      // Kept in range before the conversion: a row's end may lie beyond by rounding.
      const auto u = hn::MulAdd(hn::MulAdd(column, along_x, at_x), scale, half);
      const auto v = hn::MulAdd(hn::MulAdd(column, along_y, at_y), scale, half);
      hn::StoreU(hn::ConvertTo(ints, hn::Min(hn::Max(u, hn::Zero(d)), most_x)), ints, x + i);
      hn::StoreU(hn::ConvertTo(ints, hn::Min(hn::Max(v, hn::Zero(d)), most_y)), ints, y_out + i);
      column = hn::Add(column, step);
    }
  };
  const hn::ScalableTag<float> d;
  const int lanes = static_cast<int>(hn::Lanes(d)), whole = count / lanes * lanes;
  run(d, 0, whole);
  if (whole == count) return;
  if (whole > 0) return run(d, count - lanes, count);  // overlaps the one before
  run(hn::CappedTag<float, 1>(), 0, count);
}

// (p00 (128 - fx) + p01 fx) (128 - fy) + (p10 (128 - fx) + p11 fx) fy, rounded: at most 255 * 2^14.
template <class D>
HWY_INLINE hn::Vec<D> blend(D, hn::Vec<D> p00, hn::Vec<D> p01, hn::Vec<D> p10, hn::Vec<D> p11, hn::Vec<D> fx,
                            hn::Vec<D> fy) {
  const auto top = hn::Add(hn::ShiftLeft<7>(p00), hn::Mul(hn::Sub(p01, p00), fx));
  const auto bottom = hn::Add(hn::ShiftLeft<7>(p10), hn::Mul(hn::Sub(p11, p10), fx));
  const auto sum = hn::Add(hn::ShiftLeft<7>(top), hn::Mul(hn::Sub(bottom, top), fy));
  return hn::ShiftRight<14>(hn::Add(sum, hn::Set(D(), 1 << 13)));
}

// Samples one vector. A camera turns and zooms little from frame to frame, so that neighbours in the target are nearly
// always neighbours in the source, and whole vectors are read. Where a column or a row is skipped or repeated, or the
// next one begins, the first part of the vector is read at the offset of its first lane and the rest at that of its
// last lane. In all other cases pixels are read one at a time: no gather instruction is needed.
template <class D>
HWY_INLINE void sample_vector(D d, GrayView source, const std::int32_t* x, const std::int32_t* y,
                              std::uint8_t* out) {
  const hn::Rebind<std::uint8_t, D> dt;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
  const auto right = hn::Set(d, source.width - 2), low = hn::Set(d, source.height - 2);
  const auto px = hn::LoadU(d, x), py = hn::LoadU(d, y);
  const auto ix = hn::Min(hn::ShiftRight<7>(px), right), iy = hn::Min(hn::ShiftRight<7>(py), low);
  const auto fx = hn::Sub(px, hn::ShiftLeft<7>(ix)), fy = hn::Sub(py, hn::ShiftLeft<7>(iy));
  const int x0 = hn::GetLane(ix), y0 = hn::GetLane(iy);
  const auto begins =
      hn::And(hn::Eq(ix, hn::Add(hn::Iota(d, 0), hn::Set(d, x0))), hn::Eq(iy, hn::Set(d, y0)));
  const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(dt, p)); };
  const auto read = [&](std::ptrdiff_t offset) {
    const std::uint8_t* p = source.data + offset;
    const std::uint8_t* q = p + source.stride;
    return blend(d, load(p), load(p + 1), load(q), load(q + 1), fx, fy);
  };
  const std::ptrdiff_t first = y0 * source.stride + x0;
  if (hn::AllTrue(d, begins)) {
    hn::StoreU(hn::DemoteTo(dt, read(first)), dt, out);
    return;
  }
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int x1 = std::min(x[lanes - 1] >> 7, source.width - 2),
            y1 = std::min(y[lanes - 1] >> 7, source.height - 2);
  const auto ends =
      hn::And(hn::Eq(ix, hn::Add(hn::Iota(d, 0), hn::Set(d, x1 - lanes + 1))), hn::Eq(iy, hn::Set(d, y1)));
  const std::ptrdiff_t last = y1 * source.stride + x1 - lanes + 1;
  const std::ptrdiff_t room = (source.height - 2) * source.stride + source.width - 1 - lanes;
  if (first <= room && last >= 0 && hn::AllTrue(d, hn::Or(begins, ends))) {
    hn::StoreU(hn::DemoteTo(dt, hn::IfThenElse(begins, read(first), read(last))), dt, out);
    return;
  }
  HWY_ALIGN std::int32_t xs[kLanes], ys[kLanes];
  HWY_ALIGN std::uint8_t p00[kLanes], p01[kLanes], p10[kLanes], p11[kLanes];
  hn::Store(ix, d, xs);
  hn::Store(iy, d, ys);
  for (int i = 0; i < static_cast<int>(hn::Lanes(d)); ++i) {
    const std::uint8_t* p = &source.at(xs[i], ys[i]);
    const std::uint8_t* q = p + source.stride;
    p00[i] = p[0], p01[i] = p[1], p10[i] = q[0], p11[i] = q[1];
  }
  hn::StoreU(hn::DemoteTo(dt, blend(d, load(p00), load(p01), load(p10), load(p11), fx, fy)), dt, out);
}

void sample_bilinear(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                     std::uint8_t* out) {
  const hn::CappedTag<std::int32_t, 16> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes) sample_vector(d, source, x + i, y + i, out + i);
  if (i < count && count >= lanes) {  // the last vector overlaps the one before
    i = count - lanes;
    return sample_vector(d, source, x + i, y + i, out + i);
  }
  const hn::CappedTag<std::int32_t, 1> one;
  for (; i < count; ++i) sample_vector(one, source, x + i, y + i, out + i);
}

void sample_nearest(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                    std::uint8_t* out) {
  const hn::CappedTag<std::int32_t, 16> d;
  const hn::Rebind<std::uint8_t, decltype(d)> dt;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto whole = [&](const std::int32_t* p)
                         HWY_ATTR { return hn::ShiftRight<7>(hn::Add(hn::LoadU(d, p), hn::Set(d, 64))); };
  const auto take = [&](int begin, int end) {
    for (int k = begin; k < end; ++k) out[k] = source.at((x[k] + 64) >> 7, (y[k] + 64) >> 7);
  };
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto ix = whole(x + i), iy = whole(y + i);
    const int x0 = hn::GetLane(ix), y0 = hn::GetLane(iy);
    const auto beside = hn::Eq(ix, hn::Add(hn::Iota(d, 0), hn::Set(d, x0)));
    if (hn::AllTrue(d, hn::And(beside, hn::Eq(iy, hn::Set(d, y0))))) {
      hn::StoreU(hn::LoadU(dt, &source.at(x0, y0)), dt, out + i);
      continue;
    }
    take(i, i + lanes);
  }
  take(i, count);
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(step_positions);
HWY_EXPORT(project_positions);
HWY_EXPORT(sample_bilinear);
HWY_EXPORT(sample_nearest);

void step_positions(std::int32_t start, std::int32_t step, int shift, int count, std::int32_t* out) {
  HWY_DYNAMIC_DISPATCH(step_positions)(start, step, shift, count, out);
}

void project_positions(const float (&m)[9], int x0, int y, int count, std::int32_t right, std::int32_t low,
                       std::int32_t* x, std::int32_t* y_out) {
  HWY_DYNAMIC_DISPATCH(project_positions)(m, x0, y, count, right, low, x, y_out);
}

void sample_bilinear(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                     std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(sample_bilinear)(source, x, y, count, out);
}

void sample_nearest(GrayView source, const std::int32_t* x, const std::int32_t* y, int count,
                    std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(sample_nearest)(source, x, y, count, out);
}

}  // namespace cerberus::vision
#endif
