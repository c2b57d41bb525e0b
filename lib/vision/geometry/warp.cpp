// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/warp.h"

#include <algorithm>
#include <cmath>

#include "vision/geometry/warp_kernels.h"

namespace cerberus::vision {

namespace {

// Affine positions run along a row in steps of 1/65536 pixel and are rounded to 1/128.
constexpr int kStepBits = 16, kPositionBits = 7;
constexpr int kRoundShift = kStepBits - kPositionBits;
constexpr std::int64_t kHalf = 1 << (kRoundShift - 1);

// Converts to fixed point. The value is limited to 1e9 pixels, far outside any picture, so that it does not overflow.
std::int64_t fixed(double v) {
  return static_cast<std::int64_t>(std::floor(std::clamp(v, -1e9, 1e9) * (1 << kStepBits) + 0.5));
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - ((a % b != 0) && ((a < 0) != (b < 0)));
}

// Narrows [begin, end) to those x with low <= start + step * x <= high.
void narrow(RowSpan& span, std::int64_t start, std::int64_t step, std::int64_t low, std::int64_t high) {
  std::int64_t begin = span.begin, end = span.end;
  if (step == 0) {
    if (start < low || start > high) end = begin;
  } else {
    if (step < 0) {  // mirrored: -high <= -start - step x <= -low
      start = -start, step = -step;
      std::swap(low, high);
      low = -low, high = -high;
    }
    begin = std::max(begin, -floor_div(start - low, step));
    end = std::min(end, floor_div(high - start, step) + 1);
  }
  if (begin >= end) begin = end = span.begin;
  span = {static_cast<int>(begin), static_cast<int>(end)};
}

double bilinear_at(GrayView source, double x, double y) {
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const int jx = std::min(ix + 1, source.width - 1), jy = std::min(iy + 1, source.height - 1);
  const double fx = x - ix, fy = y - iy;
  return (source.at(ix, iy) * (1 - fx) + source.at(jx, iy) * fx) * (1 - fy) +
         (source.at(ix, jy) * (1 - fx) + source.at(jx, jy) * fx) * fy;
}

}  // namespace

bool Warp::prepare(const Transform& motion, Size size) {
  if (size_ != size) {
    spans_.resize({size.height, 1});
    positions_.resize({size.width, 2});
    size_ = size;  // assigned last: after a failed allocation the next call tries again
  }
  kind_ = Kind::nothing;
  for (int y = 0; y < size.height; ++y) spans_.view().at(y, 0) = {};
  if (size.width <= 0 || size.height <= 0 || !motion.is_sane(size)) return false;
  inverse_ = motion.inverse();
  const auto& m = inverse_.m;
  const auto whole = [](double v) { return std::abs(v - std::round(v)) < 1.0 / 256 && std::abs(v) < 1e6; };
  if (motion.is_identity()) {
    kind_ = Kind::identity;
    dx_ = dy_ = 0;
  } else if (motion.is_affine() && m[0] == 1 && m[1] == 0 && m[3] == 0 && m[4] == 1 && whole(m[2]) &&
             whole(m[5])) {
    kind_ = Kind::shift;
    dx_ = -static_cast<int>(std::lround(m[2]));
    dy_ = -static_cast<int>(std::lround(m[5]));
  } else if (motion.is_affine()) {
    kind_ = Kind::affine;
  } else {
    kind_ = Kind::projective;
    // The scale of a Transform may have either sign; here the third coordinate is made positive inside the picture.
    const Point centre = motion.apply({0.5 * (size.width - 1), 0.5 * (size.height - 1)});
    if (m[6] * centre.x + m[7] * centre.y + m[8] < 0)
      for (double& v : inverse_.m) v = -v;
  }
  RowSpan span;
  for (int y = 0; y < size.height; ++y) {
    span = kind_ == Kind::affine       ? affine_span(y)
           : kind_ == Kind::projective ? projective_span(y, span)
                                       : shift_span(y);
    spans_.view().at(y, 0) = span;
  }
  return true;
}

RowSpan Warp::shift_span(int y) const {
  if (y - dy_ < 0 || y - dy_ >= size_.height) return {};
  RowSpan span{std::max(0, dx_), std::min(size_.width, size_.width + dx_)};
  return span.begin < span.end ? span : RowSpan{};
}

RowSpan Warp::affine_span(int y) const {
  const auto& m = inverse_.m;
  RowSpan span{0, size_.width};
  const auto limit = [](int n) { return (std::int64_t{n - 1} << kStepBits) + kHalf - 1; };
  narrow(span, fixed(m[1] * y + m[2]), fixed(m[0]), -kHalf, limit(size_.width));
  narrow(span, fixed(m[4] * y + m[5]), fixed(m[3]), -kHalf, limit(size_.height));
  return span.begin < span.end ? span : RowSpan{};
}

bool Warp::projective_position(int x, int y, std::int32_t& u, std::int32_t& v) const {
  const auto& m = inverse_.m;
  const double w = m[6] * x + m[7] * y + m[8];
  if (!(w > 1e-9)) return false;
  const double scale = (1 << kPositionBits) / w;
  const double pu = (m[0] * x + m[1] * y + m[2]) * scale + 0.5,
               pv = (m[3] * x + m[4] * y + m[5]) * scale + 0.5;
  const double right = static_cast<double>(size_.width - 1) * (1 << kPositionBits);
  const double low = static_cast<double>(size_.height - 1) * (1 << kPositionBits);
  if (!(pu >= 0 && pv >= 0 && pu < right + 1 && pv < low + 1)) return false;
  u = static_cast<std::int32_t>(pu);
  v = static_cast<std::int32_t>(pv);
  return true;
}

// The valid pixels of a row are one span, which begins and ends near where that of the row above does.
RowSpan Warp::projective_span(int y, RowSpan above) const {
  std::int32_t u, v;
  const auto valid = [&](int x) { return projective_position(x, y, u, v); };
  for (RowSpan span : {above, RowSpan{0, size_.width}}) {
    while (span.begin < span.end && !valid(span.begin)) ++span.begin;
    while (span.begin < span.end && !valid(span.end - 1)) --span.end;
    if (span.begin == span.end) continue;
    while (span.begin > 0 && valid(span.begin - 1)) --span.begin;
    while (span.end < size_.width && valid(span.end)) ++span.end;
    return span;
  }
  return {};
}

void Warp::find_positions(int y) {
  const RowSpan span = spans_.view().at(y, 0);
  std::int32_t* u = positions_.view().row(0);
  std::int32_t* v = positions_.view().row(1);
  const auto& m = inverse_.m;
  const int count = span.end - span.begin;
  if (kind_ == Kind::affine) {
    // Inside the span the positions lie inside the picture and fit in 32 bits.
    const std::int64_t du = fixed(m[0]), dv = fixed(m[3]);
    const std::int64_t u0 = fixed(m[1] * y + m[2]) + du * span.begin + kHalf;
    const std::int64_t v0 = fixed(m[4] * y + m[5]) + dv * span.begin + kHalf;
    step_positions(static_cast<std::int32_t>(u0), static_cast<std::int32_t>(du), kRoundShift, count, u);
    step_positions(static_cast<std::int32_t>(v0), static_cast<std::int32_t>(dv), kRoundShift, count, v);
  } else {
    float single[9];
    std::copy(m.begin(), m.end(), single);
    const int one = 1 << kPositionBits;
    project_positions(single, span.begin, y, count, one * (size_.width - 1), one * (size_.height - 1), u, v);
  }
}

template <typename Sample>
void Warp::draw(GrayView source, MutableGrayView target, std::uint8_t fill, Sample&& sample) {
  for (int y = 0; y < size_.height; ++y) {
    const RowSpan span = spans_.view().at(y, 0);
    std::uint8_t* out = target.row(y);
    std::fill(out, out + span.begin, fill);
    std::fill(out + span.end, out + size_.width, fill);
    if (span.begin == span.end) continue;
    if (kind_ == Kind::identity || kind_ == Kind::shift) {
      std::memcpy(out + span.begin, source.row(y - dy_) + span.begin - dx_, span.end - span.begin);
    } else {
      find_positions(y);
      sample(positions_.view().row(0), positions_.view().row(1), span.end - span.begin, out + span.begin);
    }
  }
}

namespace {

auto bilinear_sampler(GrayView source) {
  return [source](const std::int32_t* u, const std::int32_t* v, int count, std::uint8_t* out) {
    if (source.width >= 2 && source.height >= 2) return sample_bilinear(source, u, v, count, out);
    // The source is a single row or column: interpolate along it only.
    const int one = 1 << kPositionBits;
    for (int i = 0; i < count; ++i) {
      const int x = u[i] / one, y = v[i] / one, f = u[i] % one + v[i] % one;
      const int next = source.at(std::min(x + (u[i] % one != 0), source.width - 1),
                                 std::min(y + (v[i] % one != 0), source.height - 1));
      out[i] = static_cast<std::uint8_t>((source.at(x, y) * (one - f) + next * f + one / 2) / one);
    }
  };
}

}  // namespace

void Warp::bilinear(GrayView source, MutableGrayView target, std::uint8_t fill) {
  draw(source, target, fill, bilinear_sampler(source));
}

void Warp::nearest(GrayView source, MutableGrayView target, std::uint8_t fill) {
  draw(source, target, fill,
       [source](const std::int32_t* u, const std::int32_t* v, int count, std::uint8_t* out) {
         sample_nearest(source, u, v, count, out);
       });
}

void warp_bilinear_reference(const Transform& motion, GrayView source, MutableGrayView target,
                             std::uint8_t fill) {
  const bool sane = motion.is_sane(source.size());
  const Transform inverse = motion.inverse();
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const Point p = inverse.apply({static_cast<double>(x), static_cast<double>(y)});
      const double u = std::floor(p.x * 128 + 0.5) / 128, v = std::floor(p.y * 128 + 0.5) / 128;
      const bool inside = sane && u >= 0 && v >= 0 && u <= source.width - 1 && v <= source.height - 1;
      target.at(x, y) = inside ? static_cast<std::uint8_t>(bilinear_at(source, u, v) + 0.5) : fill;
    }
}

}  // namespace cerberus::vision
