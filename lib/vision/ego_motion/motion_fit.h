// SPDX-License-Identifier: LGPL-2.1-or-later
// Fits one motion of the whole picture to many patch displacements, of which half may belong to moving objects.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "vision/geometry/transform.h"

namespace cerberus::vision {

// The models of the camera's motion: a similarity is shift, roll and zoom.
enum class MotionModel { none, translation, similarity, affine, homography };

// The places of matched patches in frame k-1 and in frame k, with their weights.
struct MotionSamples {
  static constexpr int kMax = 192;
  static constexpr int kRegions = 16;

  int count = 0;
  std::array<float, kMax> x, y;           // frame k-1, pixels
  std::array<float, kMax> u, v;           // frame k
  std::array<float, kMax> wxx, wxy, wyy;  // inverse covariance of (u, v), 1 / pixel^2
  std::array<float, kMax> evidence;       // 0..1: how well it determines both directions
  std::array<std::uint8_t, kMax> region;  // index of the part of the picture that it lies in, below kRegions
};

// Estimate of the lens of a turning camera.
struct LensBend {
  double bend = 0;         // (half diagonal of the picture / focal length)^2
  double information = 0;  // 1 / variance of the bend
  double earned = 0;       // F statistic of the fit with the bend against the fit without

  // Updates the estimate with that of one more picture. A lens may zoom and a robot may drive: older estimates weigh
  // less, and a contradicted one is discarded.
  void learn(const LensBend& seen);
};

struct MotionFit {
  Transform transform;
  double support = 0;   // sum over regions of the square root of their evidence within the gate
  double ground = 0;    // the same with a lower weight for the middle of the picture
  double cost = 0;      // sum of evidence times the squared Mahalanobis distance, cut off at kGate
  double agreeing = 0;  // evidence of the samples within the gate
  double residual = 0;  // RMS distance of those, pixels
  LensBend lens;        // the estimate from these samples alone; set for a turn only
  // Another motion, with nearly as much support, that other samples follow; set by fit_motion() only.
  std::optional<Transform> rival;
};

// Validation gate: squared Mahalanobis distance (two degrees of freedom: 1 % of the inliers are beyond) from which a
// sample is an outlier.
constexpr float kGate = 9.0f;

// Returns whether sample i lies within the gate of `transform`.
bool follows(const MotionSamples& samples, int i, const Transform& transform);

// Rates how well `transform` explains the samples. Inliers spread over many parts of the picture give more support than
// the same number in one part, because objects are compact and the background is everywhere.
MotionFit rate_motion(const MotionSamples& samples, const Transform& transform);

// Fits a motion by consensus over `hypotheses` random pairs of samples (a fixed sequence: the same input gives the same
// output), over `guesses`, and over `turns` turns through the `known` lens or, if none is known, through four usual
// lenses; then by least squares with Tukey's weights over the inliers. If motions with different inliers compete, the
// one with the higher `ground` is taken: a near object mostly fills the middle of the picture, and the background
// surrounds it. The model is reduced where the samples do not determine it. Without samples, returns the guess with the
// most support (identity without guesses). Where a turn is the best, the result for a similarity is bent; fit_turn()
// decides whether the bend is kept. picture: size in pixels. Allocates nothing.
MotionFit fit_motion(const MotionSamples& samples, MotionModel model, Size picture,
                     std::span<const Transform> guesses, int hypotheses, int turns = 0,
                     const LensBend& known = {});

// Extends a similarity by the effects of a turning camera if the samples show them: the bend of the picture (a lens of
// 60 degrees shifts the edges by a third more), and the shear of a rolling shutter. `found`: the result of
// fit_motion(). `known`: the estimate of the lens from earlier pictures; a bend that passed the F test once need not
// pass it again.
MotionFit fit_turn(const MotionSamples& samples, Size picture, const MotionFit& found, const LensBend& known);

// The least squares part alone: improves `motion` and returns its support.
double refine_motion(const MotionSamples& samples, MotionModel model, Size picture, Transform& motion);

}  // namespace cerberus::vision
