// SPDX-License-Identifier: LGPL-2.1-or-later
// The scene's memory under the light of the frame it is compared with, and what becomes of it when the light has
// changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "vision/background/background_kernels.h"
#include "vision/background/mosaic.h"
#include "vision/change/light.h"
#include "vision/change/light_samples.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Frames: what is learnt anew because it was wrong, or known from one frame only, counts as if it were this old.
inline constexpr std::uint8_t kRelearn = 4;

class BackgroundLight {
 public:
  void preallocate(Size picture);
  // The memory begins: there is no light but the frame's.
  void begin() {
    brighter_ = 0;
    change_.clear();
  }

  // The memory's mean as it is compared, in 8 bits; borders repeated by one pixel, readable a little beyond.
  MutableGrayView known();
  // known := the mean, under the light it was learnt in.
  void draw(View<const std::uint16_t> mean);

  // Whether the last frame's light was so different that it cannot be aligned with the memory (alignment knows nothing
  // of light).
  bool is_other() const;
  // A row of the present under the memory's light, as it would be remembered: itself, or valid until the next call.
  const std::uint8_t* remembered(int y, const std::uint8_t* present);
  // The memory under the light that was measured last. What nobody knows then (white in less light) has age 0; where
  // known() has been relit for the frame that shows it, it is as that says, and learnt anew.
  void adopt(const BackgroundPixels& pixels, Mosaic& surroundings, std::span<const RowSpan> shown = {});

  // known, as it was drawn, under the light of `present`, by rows, as before a standing camera: to align the two.
  void relight_rows(GrayView present, std::span<const RowSpan> shown);
  // known, as it was drawn, under the light of `present`. Where that explains too little, the scene is another one:
  // ages become 0. A change that is there to stay is adopted. True if the light went in a step since the last frame.
  bool compensate(const BackgroundPixels& pixels, Mosaic& surroundings, GrayView present,
                  std::span<const RowSpan> shown, bool still);
  // A step of the light moves every pixel (D(k) knows nothing of light), and what was clipped before or is now, or what
  // a line cannot say of the sensor's curve, does not come out as the memory expects. Where nothing was in the
  // foreground one frame ago, neither is motion (moved), and where the memory is wrong now it starts anew (kRelearn).
  // sigma: noise by brightness.
  void forgive_step(const BackgroundPixels& pixels, GrayView present, BitView foreground,
                    const std::array<double, kBrightness>& sigma, MutableBitView moved);

  std::size_t bytes() const { return known_.bytes() + row_.bytes() + samples_.bytes() + change_.bytes(); }

 private:
  void estimate(GrayView present, std::span<const RowSpan> shown, bool still);
  void relight(GrayView present);
  void repeat_borders();

  static constexpr int kMargin =
      16;  // columns beside the compared memory, so that kernels may look beyond the border
  Image<std::uint8_t, kMargin> known_;  // with margins
  Image<std::uint8_t> row_;             // of the present under the memory's light
  LightSamples samples_;
  LightChange change_;  // from the memory to the frame
  double brighter_ =
      0;  // grey levels the last frame was brighter than the memory, in the middle of the scale
};

}  // namespace cerberus::vision
