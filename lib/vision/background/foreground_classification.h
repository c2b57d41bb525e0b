// SPDX-License-Identifier: LGPL-2.1-or-later
// Which pixels of a frame are foreground: a comparison with the background model pixel by pixel, then a decision for
// each connected component.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "vision/background/background_kernels.h"
#include "vision/background/mechanisms.h"
#include "vision/background/mosaic.h"
#include "vision/background/motion_blur.h"
#include "vision/components/components.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"
#include "vision/image/morphology.h"

namespace cerberus::vision {

// One frame and the model that it is compared with. All planes but `picture` and `difference` are in the model's
// coordinates.
struct ClassificationInput {
  GrayView picture;     // F(k) in the frame's own coordinates, not blurred
  GrayView difference;  // D(k), likewise
  double sigma = 0;     // noise of D(k), grey levels
  bool still = false;   // the camera stands
  int frames = 0;       // of the model, this one included

  GrayView frame;       // F(k), blurred like the background
  GrayView background;  // the model's mean under the frame's light; readable one pixel beyond every side
  BackgroundPixels model;
  std::span<const RowSpan> spans;  // the columns that the frame covers, per row
  std::span<const BlockSums> blocks;
  int columns = 0, rows = 0;  // of blocks
  ForegroundMechanisms mechanisms{};
};

// A pixel is foreground by these rules:
// - It differs from the background by more than noise (measured by brightness, as sensor noise grows with it), its own
//   spread, and what a registration error makes of the edge under it (|gradient| x error; the error is measured around
//   it and is at least one pixel).
// - Where the model is younger than two frames D(k) > Th decides.
// - Its connected component has moved enough lately, or, before a camera that stands, has an outline that is an edge of
//   the frame (an object that stopped) and not one of the background (a ghost: a place that an object left).
class ForegroundClassification {
 public:
  void preallocate(Size picture);
  // The model starts anew.
  void reset();
  // seconds: from frame to frame, > 0.
  void set_period(double seconds) { windows_ = FrameWindows::of(seconds); }

  // mask in: D(k) > Th; out: the foreground, not closed. absorb := pixels that the model shall take over at once.
  // Counts model.quiet up, in ticks (FrameWindows), and limits model.age where the frame does not fit the model.
  void classify(const ClassificationInput& input, MutableBitView mask, MutableBitView absorb);

  // Of the last frame: the pixels that must not be learnt (the closed foreground and a margin), and the standard
  // deviation of frame - background by brightness, grey levels.
  BitView foreground() const { return weak_.view(); }
  const std::array<double, kBrightness>& noise() const { return noise_; }
  int tick() const { return windows_.tick; }  // frames

  std::size_t bytes() const;

 private:
  void measure_noise(const ClassificationInput& input, BitView moved);
  void compare(const ClassificationInput& input, BitView moved);
  void measure_tolerance(const ClassificationInput& input, int block_row);
  void suppress_blur(const ClassificationInput& input);
  void decide(const ClassificationInput& input, MutableBitView mask, MutableBitView absorb);

  std::array<double, kBrightness> noise_{};
  FrameWindows windows_{};
  Image<std::uint8_t> tolerance_;  // registration error in 1/16 pixel, one row of blocks, per pixel
  BitMask weak_, strong_;          // hysteresis: components of `weak` that contain a pixel of `strong` stay
  Morphology morphology_;
  ForegroundComponents components_;
  MotionBlur blur_;
  int unreliable_ = 0;  // blocks of this frame that the model does not fit
};

}  // namespace cerberus::vision
