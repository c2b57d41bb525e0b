// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of the motion fit, chosen for the processor at run time. Each has a scalar reference.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "vision/ego_motion/motion_fit.h"

namespace cerberus::vision {

// Samples in rows with one sample of each region, so that sums over regions are sums over lanes. Surplus samples of a
// region are stored in additional rows of mixed regions. Places without a sample have evidence and weights of 0.
struct SampleRows {
  static constexpr int kLanes = MotionSamples::kRegions;
  // Samples of one region: as many as the picture's grid of patches gives, and some more.
  static constexpr int kDeep = 16;
  static constexpr int kMixed = MotionSamples::kMax / kLanes;
  static constexpr int kMost = kDeep + kMixed;
  struct Row {
    alignas(64) float x[kLanes], y[kLanes], u[kLanes], v[kLanes], wxx[kLanes], wxy[kLanes], wyy[kLanes],
        evidence[kLanes];
  };

  explicit SampleRows(const MotionSamples& samples);

  int deep = 0, count = 0;                                      // rows with a lane for each region; all rows
  std::array<std::array<std::uint8_t, kLanes>, kMixed> region;  // in the rows beyond `deep`
  std::array<Row, kMost> row;
};

// The set of samples within the gate of a motion, by their places in the same SampleRows.
class Followers {
 public:
  void set(int row, int lane, std::uint64_t bits) {
    words_[static_cast<std::size_t>(row / 4)] |= bits << (16 * (row % 4) + lane);
  }
  int count() const { return common(*this); }
  int common(const Followers& other) const {
    int sum = 0;
    for (std::size_t i = 0; i < words_.size(); ++i)  // most need three words or fewer
      if (const std::uint64_t both = words_[i] & other.words_[i]) sum += std::popcount(both);
    return sum;
  }
  bool operator==(const Followers&) const = default;

 private:
  std::array<std::uint64_t, (SampleRows::kMost + 3) / 4> words_{};
};

// The agreement of samples with a motion. MotionFit documents the sums.
struct Agreement {
  // Evidence of the samples within the gate, weighted by a factor that falls to 0 at the gate.
  alignas(64) std::array<float, MotionSamples::kRegions> of_region{};
  // squares: evidence times squared distance, of the samples within the gate.
  float cost = 0, agreeing = 0, squares = 0;
  Followers followers;
};
Agreement agreement_with(const SampleRows& samples, const Transform& motion);
Agreement agreement_with_reference(const SampleRows& samples, const Transform& motion);

// Normal equations A p = b, A = sum J^T W J, b = sum J^T W d, of the displacements d = (u - x, v - y) in pixels, where
// W is a sample's inverse covariance times Tukey's weight, and J of a homography's unknowns to first order:
//   (1, 0, X, Y, 0, 0, -X U, -Y U), (0, 1, 0, 0, X, Y, -X V, -Y V).
// Every simpler motion's equations are combinations of rows and columns of these.
struct MotionNormal {
  static constexpr int kUnknowns = 8, kLinear = 6;           // kLinear: without perspective
  std::array<std::array<double, kUnknowns>, kUnknowns> a{};  // upper triangle
  std::array<double, kUnknowns> b{};
};
// X = (x - cx) * per_scale and so on.
struct MotionScale {
  double cx, cy, per_scale;
};
// Weights are (1 - distance / gate)^2 with the squared Mahalanobis distance from `motion`, 0 beyond the gate. Without
// `perspective`, the last two rows and columns stay 0.
MotionNormal sum_normal(const SampleRows& samples, const Transform& motion, float gate,
                        const MotionScale& scale, bool perspective);
MotionNormal sum_normal_reference(const SampleRows& samples, const Transform& motion, float gate,
                                  const MotionScale& scale, bool perspective);

}  // namespace cerberus::vision
