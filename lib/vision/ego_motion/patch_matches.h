// SPDX-License-Identifier: LGPL-2.1-or-later
// The matches of the patches of one picture in another one, from which the camera's motion is estimated.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "vision/ego_motion/patches.h"
#include "vision/ego_motion/scene_calm.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

// The matches of one frame; a large object that is created on the stack for each frame. Transforms and samples are in
// pixels of level 0. Allocates nothing.
class PatchMatches {
 public:
  static constexpr std::size_t kMostGuesses = 5;

  // `sites` must outlive the matches.
  explicit PatchMatches(const PatchSites& sites) : sites_(sites) {}
  int count() const { return sites_.count; }  // number of patches to match

  // Matches every patch on one level, starting at the place given by `guess`. Level 0 of the reference is not read.
  void follow(const Pyramid& reference, const Pyramid& current, int level, const Transform& guess);
  // The same, starting at the best of up to kMostGuesses guesses for the whole picture, or at another guess that fits
  // the patch clearly better: the background must be found even if a large object rates higher, and the consensus
  // decides later. Returns that best guess; in doubt the first one.
  Transform follow(const Pyramid& reference, const Pyramid& current, int level,
                   std::span<const Transform> guesses);
  // The patches that were found, with their weights.
  const MotionSamples& samples() const { return samples_; }

  struct Share {
    double all =
        0;  // of the patches whose place is in the picture: share that was found and follows the motion
    double well = 0;  // the same, each patch weighted by the quality of its match
  };
  Share share_of(const MotionFit& fit) const;
  // Returns the patches whose place is sure, as corners of the scene: those with the lowest variance, whether or not they
  // follow a motion.
  SceneCorners corners(const Transform& motion, Size picture) const;
  // Returns the standard deviation of a pixel in grey levels, from the residuals of the third with the lowest ones;
  // nullopt with too few matches.
  std::optional<double> noise() const;

  static constexpr int kLeast = 8;  // patches: fewer do not determine a motion of the whole picture

 private:
  PatchFollower follower(const Pyramid& reference, int level, int i) const;
  void collect(Size picture, int level);

  const PatchSites& sites_;
  std::array<PatchMatch, MotionSamples::kMax> matches_;
  int looked_for_ = 0;  // patches whose place lies in the current picture
  MotionSamples samples_;
  std::array<float, MotionSamples::kMax> correlations_,
      variances_;  // of the samples; the larger variance by noise
};

}  // namespace cerberus::vision
