// SPDX-License-Identifier: LGPL-2.1-or-later
// A second background of each pixel, before a camera that stands: what the foreground shows there, and in how many frames in
// all (as the candidate model of K. M. Yi et al., "Detection of moving objects with non-stationary cameras in 5.8ms", CVPR
// workshops 2013). Where people pass one after another the place that somebody left never rests, and who passes in clothes
// of his colour confirms the model of him; but between them all it is the same scene that shows. A candidate is kept while
// the pixel is background, and where the model has taken over what it shows; frames of something else wear it down.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "vision/background/background_kernels.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class CandidateBackground {
 public:
  struct Pictures {
    GrayView frame;       // blurred like the background
    BitView foreground;   // where it differs from the background
    GrayView age, quiet;  // frames for which the model has learnt a pixel; since it moved
  };

  // For pictures of this size, in all calls that follow; std::bad_alloc where memory is short.
  void preallocate(Size picture);
  // Forgets all candidates, as when the camera moves.
  void reset();
  // seconds: from frame to frame, > 0.
  void set_period(double seconds);
  // Counts a frame. noise: standard deviation of frame - background by brightness, grey levels.
  void update(const Pictures& pictures, const std::array<double, kBrightness>& noise);

  // Foreground of the last frame that shows its candidate, and whose candidate was seen for .45 s at least and for more than a
  // quarter of the model's age.
  BitView lasting() const { return lasting_.view(); }
  std::size_t bytes() const { return grey_.bytes() + seen_.bytes() + lasting_.bytes(); }

 private:
  Image<std::uint8_t> grey_;
  // Foreground frames that showed it at rest and with an edge, less those that showed something else; 0: no candidate.
  Image<std::uint8_t> seen_;
  BitMask lasting_;
  std::uint8_t least_seen_ = 11;  // frames, as at 25 a second
};

}  // namespace cerberus::vision
