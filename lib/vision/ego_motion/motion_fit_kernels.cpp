// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/motion_fit_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/ego_motion/motion_fit_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR || !HWY_HAVE_FLOAT64
void agree(const SampleRows& samples, const Transform& motion, Agreement& out) {
  out = agreement_with_reference(samples, motion);
}
void add_normal(const SampleRows& samples, const Transform& motion, float gate, const MotionScale& scale,
                bool perspective, MotionNormal& out) {
  out = sum_normal_reference(samples, motion, gate, scale, perspective);
}
#else

// The elements of a motion in every lane, and the distance of samples from it.
template <typename D, bool kAffine>
struct Motion {
  using V = hn::Vec<D>;
  V m[9];

  HWY_INLINE explicit Motion(const Transform& t) {
    for (int i = 0; i < 9; ++i) m[i] = hn::Set(D(), static_cast<float>(t.m[i]));
  }
  HWY_INLINE void measure(const SampleRows::Row& s, int lane, V& dx, V& dy, V& distance) const {
    const D d;
    const V x = hn::Load(d, s.x + lane), y = hn::Load(d, s.y + lane);
    V u = hn::MulAdd(m[0], x, hn::MulAdd(m[1], y, m[2])), v = hn::MulAdd(m[3], x, hn::MulAdd(m[4], y, m[5]));
    if constexpr (!kAffine) {
      const V per_w = hn::Div(hn::Set(d, 1.0f), hn::MulAdd(m[6], x, hn::MulAdd(m[7], y, m[8])));
      u = hn::Mul(u, per_w), v = hn::Mul(v, per_w);
    }
    dx = hn::Sub(hn::Load(d, s.u + lane), u), dy = hn::Sub(hn::Load(d, s.v + lane), v);
    const V xy = hn::Mul(hn::Load(d, s.wxy + lane), hn::Add(dy, dy));
    distance = hn::Add(hn::Mul(hn::MulAdd(hn::Load(d, s.wxx + lane), dx, xy), dx),
                       hn::Mul(hn::Mul(hn::Load(d, s.wyy + lane), dy), dy));
  }
};

template <bool kAffine>
HWY_INLINE void agree_with(const SampleRows& samples, const Transform& t, Agreement& out) {
  const hn::CappedTag<float, SampleRows::kLanes> d;
  using V = hn::Vec<decltype(d)>;
  const Motion<hn::CappedTag<float, SampleRows::kLanes>, kAffine> motion(t);
  const V gate = hn::Set(d, kGate), per_gate = hn::Set(d, 1 / kGate), one = hn::Set(d, 1.0f);
  V cost = hn::Zero(d), agreeing = hn::Zero(d), squares = hn::Zero(d);
  // Returns the evidence that the samples add to their regions.
  const auto add = [&](int row, int lane) {
    const SampleRows::Row& s = samples.row[row];
    V dx, dy, distance;
    motion.measure(s, lane, dx, dy, distance);
    const V evidence = hn::Load(d, s.evidence + lane);
    const auto inside = hn::And(hn::Le(distance, gate), hn::Gt(evidence, hn::Zero(d)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, inside, bits);
    out.followers.set(row, lane, static_cast<std::uint64_t>(bits[0] | bits[1] << 8));
    cost = hn::MulAdd(evidence, hn::Min(distance, gate), cost);
    const V within = hn::IfThenElseZero(inside, evidence);
    agreeing = hn::Add(agreeing, within);
    squares =
        hn::Add(squares, hn::IfThenElseZero(inside, hn::Mul(evidence, hn::MulAdd(dx, dx, hn::Mul(dy, dy)))));
    return hn::IfThenElseZero(inside, hn::Mul(evidence, hn::NegMulAdd(distance, per_gate, one)));
  };
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < SampleRows::kLanes; lane += lanes) {
    V sum = hn::Zero(d);
    for (int row = 0; row < samples.deep; ++row) sum = hn::Add(sum, add(row, lane));
    hn::Store(sum, d, out.of_region.data() + lane);
  }
  for (int row = samples.deep; row < samples.count; ++row)
    for (int lane = 0; lane < SampleRows::kLanes; lane += lanes) {
      alignas(64) float part[SampleRows::kLanes];
      hn::Store(add(row, lane), d, part);
      for (int i = 0; i < lanes; ++i) out.of_region[samples.region[row - samples.deep][lane + i]] += part[i];
    }
  out.cost = hn::GetLane(hn::SumOfLanes(d, cost));
  out.agreeing = hn::GetLane(hn::SumOfLanes(d, agreeing));
  out.squares = hn::GetLane(hn::SumOfLanes(d, squares));
}

void agree(const SampleRows& samples, const Transform& motion, Agreement& out) {
  if (motion.is_affine())
    agree_with<true>(samples, motion, out);
  else
    agree_with<false>(samples, motion, out);
}

// The distinct sums that the equations are made of, with (a b; b c) = W, (gx, gy) = W d, (ex, ey) = W (U, V).
enum Sum {
  kA = 0,             // a times 1, X, Y, XX, XY, YY
  kB = 6,             // the same of b
  kC = 12,            // of c
  kGx = 18,           // gx times 1, X, Y
  kGy = 21,           // of gy
  kLinearSums = 24,   //
  kEx = kLinearSums,  // ex times X, Y, XX, XY, YY
  kEy = 29,           // of ey
  kUe = 34,           // U ex + V ey times XX, XY, YY
  kUg = 37,           // U gx + V gy times X, Y
  kAllSums = 39
};

template <bool kAffine, bool kPerspective>
HWY_INLINE void sum_up(const SampleRows& samples, const Transform& t, float gate, const MotionScale& scale,
                       double* sums) {
  const hn::CappedTag<double, SampleRows::kLanes> d;
  using Floats = hn::Rebind<float, decltype(d)>;
  const Floats f;
  using V = hn::Vec<decltype(d)>;
  constexpr int kSums = kPerspective ? kAllSums : kLinearSums;
  const Motion<Floats, kAffine> motion(t);
  const auto per_gate = hn::Set(f, 1 / gate), one = hn::Set(f, 1.0f), nothing = hn::Zero(f);
  const V cx = hn::Set(d, scale.cx), cy = hn::Set(d, scale.cy), per_scale = hn::Set(d, scale.per_scale);
  V sum[kSums];
  for (V& s : sum) s = hn::Zero(d);
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int row = 0; row < samples.count; ++row)
    for (int lane = 0; lane < SampleRows::kLanes; lane += lanes) {
      const SampleRows::Row& s = samples.row[row];
      hn::Vec<Floats> rx, ry, distance;
      motion.measure(s, lane, rx, ry, distance);
      const auto inside = hn::NegMulAdd(distance, per_gate, one);
      const auto tukey = hn::IfThenElseZero(hn::Gt(inside, nothing), hn::Mul(inside, inside));
      const V weight = hn::PromoteTo(d, tukey);
      const auto wide = [&](const float* p) { return hn::PromoteTo(d, hn::Load(f, p + lane)); };
      const V a = hn::Mul(weight, wide(s.wxx)), b = hn::Mul(weight, wide(s.wxy)),
              c = hn::Mul(weight, wide(s.wyy));
      const V x = wide(s.x), y = wide(s.y), u = wide(s.u), v = wide(s.v);
      const V X = hn::Mul(hn::Sub(x, cx), per_scale), Y = hn::Mul(hn::Sub(y, cy), per_scale);
      const V XX = hn::Mul(X, X), XY = hn::Mul(X, Y), YY = hn::Mul(Y, Y);
      const V dx = hn::Sub(u, x), dy = hn::Sub(v, y);
      const auto add = [&](int i, V p, V q) { sum[i] = hn::MulAdd(p, q, sum[i]); };
      const auto add_to_square = [&](int i, V w) {
        sum[i] = hn::Add(sum[i], w);
        add(i + 1, w, X), add(i + 2, w, Y), add(i + 3, w, XX), add(i + 4, w, XY), add(i + 5, w, YY);
      };
      add_to_square(kA, a), add_to_square(kB, b), add_to_square(kC, c);
      const V gx = hn::MulAdd(a, dx, hn::Mul(b, dy)), gy = hn::MulAdd(b, dx, hn::Mul(c, dy));
      sum[kGx] = hn::Add(sum[kGx], gx), add(kGx + 1, gx, X), add(kGx + 2, gx, Y);
      sum[kGy] = hn::Add(sum[kGy], gy), add(kGy + 1, gy, X), add(kGy + 2, gy, Y);
      if constexpr (kPerspective) {
        const V U = hn::Mul(hn::Sub(u, cx), per_scale), W = hn::Mul(hn::Sub(v, cy), per_scale);
        const V ex = hn::MulAdd(a, U, hn::Mul(b, W)), ey = hn::MulAdd(b, U, hn::Mul(c, W));
        add(kEx, ex, X), add(kEx + 1, ex, Y), add(kEx + 2, ex, XX), add(kEx + 3, ex, XY),
            add(kEx + 4, ex, YY);
        add(kEy, ey, X), add(kEy + 1, ey, Y), add(kEy + 2, ey, XX), add(kEy + 3, ey, XY),
            add(kEy + 4, ey, YY);
        const V ue = hn::MulAdd(U, ex, hn::Mul(W, ey)), ug = hn::MulAdd(U, gx, hn::Mul(W, gy));
        add(kUe, ue, XX), add(kUe + 1, ue, XY), add(kUe + 2, ue, YY), add(kUg, ug, X), add(kUg + 1, ug, Y);
      }
    }
  for (int i = 0; i < kSums; ++i) sums[i] = hn::GetLane(hn::SumOfLanes(d, sum[i]));
}

void add_normal(const SampleRows& samples, const Transform& motion, float gate, const MotionScale& scale,
                bool perspective, MotionNormal& out) {
  double s[kAllSums] = {};
  const bool affine = motion.is_affine();
  if (affine && !perspective)
    sum_up<true, false>(samples, motion, gate, scale, s);
  else if (!perspective)
    sum_up<false, false>(samples, motion, gate, scale, s);
  else if (affine)
    sum_up<true, true>(samples, motion, gate, scale, s);
  else
    sum_up<false, true>(samples, motion, gate, scale, s);
  const double *a = s + kA, *b = s + kB, *c = s + kC, *ex = s + kEx, *ey = s + kEy, *ue = s + kUe;
  out.a = {{{a[0], b[0], a[1], a[2], b[1], b[2], -ex[0], -ex[1]},
            {0, c[0], b[1], b[2], c[1], c[2], -ey[0], -ey[1]},
            {0, 0, a[3], a[4], b[3], b[4], -ex[2], -ex[3]},
            {0, 0, 0, a[5], b[4], b[5], -ex[3], -ex[4]},
            {0, 0, 0, 0, c[3], c[4], -ey[2], -ey[3]},
            {0, 0, 0, 0, 0, c[5], -ey[3], -ey[4]},
            {0, 0, 0, 0, 0, 0, ue[0], ue[1]},
            {0, 0, 0, 0, 0, 0, 0, ue[2]}}};
  out.b = {s[kGx], s[kGy], s[kGx + 1], s[kGx + 2], s[kGy + 1], s[kGy + 2], -s[kUg], -s[kUg + 1]};
}
#endif

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(agree);
HWY_EXPORT(add_normal);

Agreement agreement_with(const SampleRows& samples, const Transform& motion) {
  Agreement agreement;
  HWY_DYNAMIC_DISPATCH(agree)(samples, motion, agreement);
  return agreement;
}

MotionNormal sum_normal(const SampleRows& samples, const Transform& motion, float gate,
                        const MotionScale& scale, bool perspective) {
  MotionNormal normal;
  HWY_DYNAMIC_DISPATCH(add_normal)(samples, motion, gate, scale, perspective, normal);
  return normal;
}

SampleRows::SampleRows(const MotionSamples& s) {
  std::array<int, kLanes> depth{};
  for (int i = 0; i < s.count; ++i) ++depth[s.region[i]];
  deep = std::min(kDeep, *std::max_element(depth.begin(), depth.end()));
  int surplus = 0;
  for (int& d : depth) surplus += std::max(d - deep, 0), d = 0;
  count = deep + (surplus + kLanes - 1) / kLanes;
  // Fill empty places with the first sample's point: at another place a motion may be undefined.
  for (int r = 0; r < count; ++r) {
    std::fill_n(row[r].x, kLanes, s.x[0]), std::fill_n(row[r].y, kLanes, s.y[0]);
    std::fill_n(row[r].u, kLanes, s.u[0]), std::fill_n(row[r].v, kLanes, s.v[0]);
    for (float* p : {row[r].wxx, row[r].wxy, row[r].wyy, row[r].evidence}) std::fill_n(p, kLanes, 0.0f);
  }
  region = {};
  int next = deep * kLanes;
  for (int i = 0; i < s.count; ++i) {
    const int of = s.region[i];
    const int place = depth[of] < deep ? kLanes * depth[of]++ + of : next++;
    const int r = place / kLanes, lane = place % kLanes;
    if (r >= deep) region[r - deep][lane] = static_cast<std::uint8_t>(of);
    row[r].x[lane] = s.x[i], row[r].y[lane] = s.y[i], row[r].u[lane] = s.u[i], row[r].v[lane] = s.v[i];
    row[r].wxx[lane] = s.wxx[i], row[r].wxy[lane] = s.wxy[i], row[r].wyy[lane] = s.wyy[i];
    row[r].evidence[lane] = s.evidence[i];
  }
}

Agreement agreement_with_reference(const SampleRows& samples, const Transform& motion) {
  Agreement out;
  for (int r = 0; r < samples.count; ++r)
    for (int lane = 0; lane < SampleRows::kLanes; ++lane) {
      const SampleRows::Row& s = samples.row[r];
      if (!(s.evidence[lane] > 0)) continue;
      const Point p = motion.apply({s.x[lane], s.y[lane]});
      const double dx = s.u[lane] - p.x, dy = s.v[lane] - p.y;
      const auto distance =
          static_cast<float>(s.wxx[lane] * dx * dx + 2 * s.wxy[lane] * dx * dy + s.wyy[lane] * dy * dy);
      out.cost += s.evidence[lane] * std::min(distance, kGate);
      if (!(distance <= kGate)) continue;
      const int region = r < samples.deep ? lane : samples.region[r - samples.deep][lane];
      out.of_region[region] += s.evidence[lane] * (1 - distance / kGate);
      out.agreeing += s.evidence[lane];
      out.squares += s.evidence[lane] * static_cast<float>(dx * dx + dy * dy);
      out.followers.set(r, lane, 1);
    }
  return out;
}

MotionNormal sum_normal_reference(const SampleRows& samples, const Transform& motion, float gate,
                                  const MotionScale& scale, bool perspective) {
  constexpr int kAll = MotionNormal::kUnknowns;
  const int unknowns = perspective ? kAll : MotionNormal::kLinear;
  MotionNormal normal;
  for (int r = 0; r < samples.count; ++r)
    for (int lane = 0; lane < SampleRows::kLanes; ++lane) {
      const SampleRows::Row& s = samples.row[r];
      const Point p = motion.apply({s.x[lane], s.y[lane]});
      const double rx = s.u[lane] - p.x, ry = s.v[lane] - p.y;
      const double inside =
          1 - (s.wxx[lane] * rx * rx + 2 * s.wxy[lane] * rx * ry + s.wyy[lane] * ry * ry) / gate;
      if (!(inside > 0)) continue;
      const double weight = inside * inside;
      const double X = (s.x[lane] - scale.cx) * scale.per_scale, Y = (s.y[lane] - scale.cy) * scale.per_scale;
      const double U = (s.u[lane] - scale.cx) * scale.per_scale, V = (s.v[lane] - scale.cy) * scale.per_scale;
      const double jx[kAll]{1, 0, X, Y, 0, 0, -X * U, -Y * U}, jy[kAll]{0, 1, 0, 0, X, Y, -X * V, -Y * V};
      const double dx = double{s.u[lane]} - s.x[lane], dy = double{s.v[lane]} - s.y[lane];
      for (int i = 0; i < unknowns; ++i) {
        const double ex = weight * (jx[i] * s.wxx[lane] + jy[i] * s.wxy[lane]);
        const double ey = weight * (jx[i] * s.wxy[lane] + jy[i] * s.wyy[lane]);
        for (int j = i; j < unknowns; ++j) normal.a[i][j] += ex * jx[j] + ey * jy[j];
        normal.b[i] += ex * dx + ey * dy;
      }
    }
  return normal;
}

}  // namespace cerberus::vision
#endif
