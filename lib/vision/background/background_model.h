// SPDX-License-Identifier: LGPL-2.1-or-later
// A registered background model that needs no training: the static scene behind the moving objects, pixel by pixel.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "vision/background/mechanisms.h"
#include "vision/geometry/box.h"
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
  // Analysis pixels of frame k that show no scene (burnt_in.h): they are no foreground and are not learnt.
  std::span<const Box> excluded{};
  ForegroundMechanisms mechanisms{};
};

// A pixel takes 5 bytes: mean (8.8 fixed point), spread, age (frames learnt) and quiet (time since it moved). The
// model has coordinates of its own. They follow the frame's by whole pixels, which is a copy; interpolation in every
// frame would blur the model. The remaining transform is fitted to the model's content in every frame, and the frame
// is warped by it. What leaves the picture is kept coarsely in a mosaic (mosaic.h) for a camera that turns back.
//
// A frame is compared with the model and its pixels are classified (foreground_classification.h). Foreground is never
// learnt. Components that do not move are absorbed as a whole: ghosts at once, undecided components when they
// have been there longer than what they replaced, objects that stopped after ten seconds (components.h).
class BackgroundModel {
 public:
  BackgroundModel();
  ~BackgroundModel();
  BackgroundModel(BackgroundModel&&) noexcept;
  BackgroundModel& operator=(BackgroundModel&&) noexcept;

  void reset();
  // mask := 0 or 255 a pixel, not closed: region finding needs the gaps between people and closes the mask itself. The
  // mask also serves as scratch memory.
  void update(const BackgroundInput& input, MutableGrayView mask);
  // What the model showed before the last frame, under that frame's light, in the frame's pixels; empty: the camera moves.
  // Lives until the next call.
  GrayView background() const;
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
