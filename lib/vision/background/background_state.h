// SPDX-License-Identifier: LGPL-2.1-or-later
// What BackgroundModel holds: scene_memory.cpp keeps it where the camera looks, scene_judgement.cpp tells what is not the
// scene.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vision/background/background_kernels.h"
#include "vision/background/background_light.h"
#include "vision/background/background_model.h"
#include "vision/background/components.h"
#include "vision/background/mosaic.h"
#include "vision/background/motion_blur.h"
#include "vision/geometry/warp.h"
#include "vision/image/mask.h"
#include "vision/image/morphology.h"

namespace cerberus::vision {

struct BackgroundModel::State {
  Size size;
  int frames = 0;
  int standing = 0;    // frames the camera has stood while the memory was not in the frame's coordinates
  Transform to_frame;  // memory pixel -> frame pixel
  Image<std::uint16_t> mean;
  Image<std::uint8_t> spread, age, quiet;
  Image<std::uint8_t> present;    // the frame in memory coordinates, blurred
  Image<std::uint8_t> tolerance;  // one row of blocks, per pixel
  BitMask weak, strong, moved, absorb;
  BitMask valid;  // one row
  Morphology morphology;
  ForegroundComponents parts;
  Mosaic surroundings;
  ClassificationWindows windows;
  int unreliable = 0;  // blocks of this frame that the memory does not fit
  double period = 0;   // seconds from frame to frame, smoothed
  Warp warp;
  BackgroundLight light;
  MotionBlur blur;
  int columns = 0, rows = 0;  // of blocks
  std::vector<BlockSums> blocks;
  std::array<double, kBrightness> sigma{};  // of frame - memory by brightness, grey levels

  void prepare(Size to);
  void measure_time(double seconds);
  void follow(const BackgroundInput& in);
  void redraw();
  // The mask before it is closed: who makes regions of it needs the gaps between people. What moved is not needed any
  // more once the frame is compared.
  MutableBitView plain() { return moved.view(); }
  BackgroundPixels pixels() { return {mean.view(), spread.view(), age.view(), quiet.view()}; }
  bool draw_present(const BackgroundInput& in, GrayView blurred);
  void measure_blocks();
  void align(const BackgroundInput& in, GrayView blurred);
  void learn_noise(const BackgroundInput& in);
  void leave_valid(MutableBitView bits) const;
  void compare(const BackgroundInput& in);
  void forgive_blur();
  void decide(const BackgroundInput& in);
  void learn(bool still);
};

}  // namespace cerberus::vision
