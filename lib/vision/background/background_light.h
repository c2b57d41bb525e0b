// SPDX-License-Identifier: LGPL-2.1-or-later
// The background image under the light of the frame that it is compared with, and the model's adaptation when the light
// has changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "vision/background/background_kernels.h"
#include "vision/background/mosaic.h"
#include "vision/change/light.h"
#include "vision/change/light_samples.h"
#include "vision/components/components.h"  // kRelearn
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class BackgroundLight {
 public:
  void preallocate(Size picture);
  // The model starts anew, under the frame's light.
  void reset() {
    brighter_ = 0;
    change_.clear();
  }

  // The model's mean in 8 bits, as it is compared; borders are repeated by one pixel, and 16 columns beyond are
  // readable.
  MutableGrayView background();
  // background() := the mean, under the light in which it was learnt.
  void load(View<const std::uint16_t> mean);

  // Whether the last frame's light was too different for alignment, which does not model light.
  bool is_different() const;
  // A row of the frame under the model's light, as it is learnt: the row itself, or a buffer that is valid until the next
  // call.
  const std::uint8_t* in_background_light(int y, const std::uint8_t* frame);
  // Brings the model and the mosaic under the light that was measured last. Pixels that this leaves undetermined (white,
  // under less light) get age 0. Where background() has been relit for the visible frame, they take its value and are
  // learnt anew.
  void adopt(const BackgroundPixels& pixels, Mosaic& mosaic, std::span<const RowSpan> visible = {});

  // Brings background(), as loaded, under the light of `frame` row by row, for their alignment.
  void relight_rows(GrayView frame, std::span<const RowSpan> visible);
  // Brings background(), as loaded, under the light of `frame`. If that explains too few pixels the scene is another one
  // and ages become 0. A lasting change is adopted. Returns true if the light changed in a step since the last frame.
  bool compensate(const BackgroundPixels& pixels, Mosaic& mosaic, GrayView frame,
                  std::span<const RowSpan> visible, bool still);
  // After a step of the light every pixel has moved (D(k) does not model light), and pixels that were or are clipped, or
  // where the sensor's curve is not a line, differ from the relit background. Where there was no foreground one frame
  // ago, clears `moved` and replaces wrong pixels of the model (age at most kRelearn). sigma: noise by brightness.
  void suppress_step(const BackgroundPixels& pixels, GrayView frame, BitView foreground,
                     const std::array<double, kBrightness>& sigma, MutableBitView moved);

  std::size_t bytes() const {
    return background_.bytes() + row_.bytes() + samples_.bytes() + change_.bytes();
  }

 private:
  void estimate(GrayView frame, std::span<const RowSpan> visible, bool still);
  void relight(GrayView frame);
  void repeat_borders();

  // Columns beside the image, so that kernels may read beyond the border.
  static constexpr int kMargin = 16;
  Image<std::uint8_t, kMargin> background_;  // with margins
  Image<std::uint8_t> row_;                  // of the frame under the model's light
  LightSamples samples_;
  LightChange change_;  // from the model to the frame
  // Grey levels by which the last frame was brighter than the model, in the middle of the scale.
  double brighter_ = 0;
};

}  // namespace cerberus::vision
