// SPDX-License-Identifier: LGPL-2.1-or-later
// What the scene behind the moving objects looks like: a registered memory that needs no training.
#pragma once

#include <cstdint>
#include <memory>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct BackgroundInput {
  GrayView picture;     // F(k), analysis pixels, not blurred
  GrayView difference;  // D(k) in frame k
  int threshold = 0;    // Th: D(k) > Th has moved (Eq. 3)
  double sigma = 0;     // noise of D(k)
  Transform motion;     // frame k-1 to k
  bool still = false;   // the camera stands
  double seconds = 0;   // since frame k-1; 0: unknown
};

// Per pixel 5 bytes: mean (8.8 fixed point), spread, age, frames since it moved. The memory has coordinates of its own,
// which follow the frame's by whole pixels (a copy, not an interpolation: interpolating it every frame would blur it);
// the rest, to_frame, is fitted to the memory's own content every frame, and the frame is warped, never the memory.
// What leaves the picture is kept coarsely beyond it (scene_surroundings.h), for a camera that turns back.
//
// A pixel is foreground by confidence:
// - it differs from the memory by more than noise (known by brightness: sensor noise grows with it), its own spread,
//   and what an error of registration would make of the edge under it (|gradient| x error; the error is measured around
//   it, one pixel at least);
// - where the memory is too young to say anything, it is foreground if D(k) says so;
// - a connected part stays only if enough of it has really moved lately, or if, the camera standing, its outline is an
//   edge of the frame (something that stopped) and not one of the memory (a ghost: something that left).
// Foreground is never learnt; parts that do not move are taken over as one: ghosts at once, things of unclear origin
// when they have been there longer than what they replaced, things that stopped after ten seconds (scene_parts.h).
class BackgroundModel {
 public:
  BackgroundModel();
  ~BackgroundModel();
  BackgroundModel(BackgroundModel&&) noexcept;
  BackgroundModel& operator=(BackgroundModel&&) noexcept;

  void reset();
  // mask := 0 or 255 a pixel, not closed: who makes regions of it closes it, and needs the gaps between people before
  // that. (Used as scratch first.)
  void update(const BackgroundInput& input, MutableGrayView mask);
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
