// SPDX-License-Identifier: LGPL-2.1-or-later
// Which patches of one picture are found again in another, and where: what the camera's motion is estimated from.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "vision/ego_motion/patches.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

// Of one frame, and large: made for it on the stack. Transforms and samples are in pixels of level 0. Allocates
// nothing.
class PatchMatches {
 public:
  static constexpr std::size_t kMostGuesses = 5;

  // Of these patches, which live as long.
  explicit PatchMatches(const PatchSites& sites) : sites_(sites) {}
  int count() const { return sites_.count; }  // of those to be looked for

  // Looks for every patch on one level, first where `guess` says. Of the reference, level 0 is not looked at.
  void follow(const Pyramid& reference, const Pyramid& current, int level, const Transform& guess);
  // The same, first where the best of up to kMostGuesses guesses for the whole picture says, or where another one fits
  // this patch clearly better: the background must be found even if a large object rates higher, and the consensus
  // decides later. Returns that best guess; when in doubt it is the first one.
  Transform follow(const Pyramid& reference, const Pyramid& current, int level,
                   std::span<const Transform> guesses);
  // Those that were found, with what each is worth.
  const MotionSamples& samples() const { return samples_; }

  struct Share {
    double all = 0;   // of the patches whose place can be seen, those that were found and follow a motion
    double well = 0;  // the same with each counted by how well it was found
  };
  Share share_of(const MotionFit& fit) const;
  // Standard deviation of a pixel, from what the calmer matches leave unexplained; none where they are too few.
  std::optional<double> noise() const;

  static constexpr int kLeast = 8;  // patches: fewer say nothing about the whole picture

 private:
  PatchFollower follower(const Pyramid& reference, int level, int i) const;
  void collect(Size picture, int level);

  const PatchSites& sites_;
  std::array<PatchMatch, MotionSamples::kMax> matches_;
  int looked_for_ = 0;  // patches whose place lies in the current picture
  MotionSamples samples_;
  std::array<float, MotionSamples::kMax> correlations_;  // of the samples
};

}  // namespace cerberus::vision
