// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a track that only motion supports moves by itself. Where the camera's motion does not explain the scene (see
// SceneCalm), parallax and blur leave edges over everywhere; a track is then believed once much more is left over inside its
// box than around it, or once the scene has been calm, and as long as it is more.
#pragma once

#include <cstdint>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::vision {

class OwnMotionEvidence {
 public:
  // Forgets all tracks.
  void reset() { tracks_.clear(); }
  // difference: registered, as Differences::tolerant, or D(k) where the camera stands; empty: none is known, and every track is
  // believed. calm: SceneCalm::share(). seconds: since the frame before (<= 0: unknown, the last known distance is used). The
  // view lives until the next call.
  void begin_frame(GrayView difference, double calm, double seconds);
  // Returns whether the track is believed in this frame; called once a frame for each track. box: pixels of the difference.
  // seen: it has a region; without one its evidence stays.
  bool supports(std::uint32_t id, const Box& box, bool seen);

 private:
  struct Evidence {
    std::uint32_t id;
    bool present;  // in this frame
    bool believed = false;
    double contrast = 0;  // running mean: logarithm of the mean difference inside to that around
  };
  Evidence& of(std::uint32_t id);

  std::vector<Evidence> tracks_;
  GrayView difference_;
  bool calm_ = true;
  double step_ = 0.04;  // seconds between frames, until a distance is known
};

}  // namespace cerberus::vision
