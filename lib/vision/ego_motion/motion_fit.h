// SPDX-License-Identifier: LGPL-2.1-or-later
// One motion of the whole picture from many small ones, of which half may belong to moving objects.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "vision/geometry/transform.h"

namespace cerberus::vision {

// What may be found of the camera's motion: a similarity is shift, roll and zoom.
enum class MotionModel { none, translation, similarity, affine, homography };

// Where patches of frame k-1 were found in frame k, with what each is worth.
struct MotionSamples {
  static constexpr int kMax = 192;
  static constexpr int kRegions = 16;

  int count = 0;
  std::array<float, kMax> x, y;           // frame k-1, pixels
  std::array<float, kMax> u, v;           // frame k
  std::array<float, kMax> wxx, wxy, wyy;  // inverse covariance of (u, v), 1 / pixel^2
  std::array<float, kMax> evidence;       // 0..1: how much it says about both directions
  std::array<std::uint8_t, kMax> region;  // which of kRegions parts of the picture it lies in
};

// What is known of the lens of a camera that turns.
struct LensBend {
  double bend = 0;         // (half diagonal of the picture / focal length)^2
  double information = 0;  // 1 / variance of that
  double earned = 0;       // F statistic: how much better the samples are explained with it than without

  // What one more picture says of it. A lens may zoom and a robot drive: what is old counts less, and what is
  // contradicted is forgotten.
  void learn(const LensBend& seen);
};

struct MotionFit {
  Transform transform;
  double support = 0;   // sum over regions of the square root of their evidence that agrees
  double ground = 0;    // the same with what the middle of the picture says counted less
  double cost = 0;      // sum of evidence times the squared Mahalanobis distance, cut off at kGate
  double agreeing = 0;  // evidence of the samples within the gate
  double residual = 0;  // RMS distance of those, pixels
  LensBend lens;        // what these samples say by themselves; of a turn only
  // Another motion that others of the samples follow, with nearly as much support; of fit_motion() only.
  std::optional<Transform> rival;
};

// Squared Mahalanobis distance (two degrees of freedom: 1 % of honest samples are beyond) at which a sample disagrees.
constexpr float kGate = 9.0f;

// Whether sample i lies within the gate of `transform`.
bool follows(const MotionSamples& samples, int i, const Transform& transform);

// How well `transform` explains the samples. Agreement in many parts of the picture counts for more than the same
// number in one: objects are compact, the background is everywhere.
MotionFit rate_motion(const MotionSamples& samples, const Transform& transform);

// Consensus over `hypotheses` random pairs of samples (a fixed sequence: the same input gives the same output), over
// `guesses`, and over as many `turns` through the lens that is `known`, or through lenses of all kinds; then least
// squares with Tukey's weights over what agrees. Where motions with different followers compete, that of the ground is
// taken: who is near stands in the middle, and what surrounds him is the background. The model is reduced where the
// samples cannot carry it. Returns the guess with most support where there are no samples at all (identity without
// guesses). A similarity comes out bent where a turn is the best: fit_turn() says whether it is worth it.
MotionFit fit_motion(const MotionSamples& samples, MotionModel model, Size picture,
                     std::span<const Transform> guesses, int hypotheses, int turns = 0,
                     const LensBend& known = {});

// What a camera that turns adds to a similarity, where the samples show it: the bend of its picture (a lens of 60
// degrees shifts its edges by a third more), and the shear of a rolling shutter. `found`: by fit_motion(). `known`:
// what earlier pictures said of the lens; it needs to earn its place only once.
MotionFit fit_turn(const MotionSamples& samples, Size picture, const MotionFit& found, const LensBend& known);

// Only the least squares part: improves `motion`, returns its support.
double refine_motion(const MotionSamples& samples, MotionModel model, Size picture, Transform& motion);

}  // namespace cerberus::vision
