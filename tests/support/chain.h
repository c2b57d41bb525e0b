// SPDX-License-Identifier: LGPL-2.1-or-later
// The whole vision chain without GStreamer, stage by stage, with the elements' defaults (no label picture:
// nobody asks for it): for tests and benches of lib.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "vision/background/foreground_mask.h"
#include "vision/change/three_frame_difference.h"
#include "vision/detection/burnt_in.h"
#include "vision/detection/regions.h"
#include "vision/ego_motion/camera_motion.h"
#include "vision/image/luma.h"
#include "vision/tracking/tracker.h"

namespace cerberus::tests {

class Chain {
 public:
  static constexpr std::size_t kStages = 6;
  static const char* stage_name(std::size_t stage);

  // A frame of `seconds` after the one before; then run_stage(0) ... run_stage(kStages - 1), or step() for
  // all.
  void begin(const vision::LumaSource& frame, double seconds);
  void run_stage(std::size_t stage);
  void step(const vision::LumaSource& frame, double seconds);
  // Forget all, as a seek does.
  void reset();
  // Default 320; 0: the frame's own size.
  void set_analysis_width(int width) { analysis_width_ = width; }
  // Whether what the camera writes into its pictures is learnt; default: no.
  void set_burnt_in(bool on) { burnt_in_on_ = on; }

  vision::Size analysis_size() const { return luma_.size(); }
  vision::GrayView mask() const { return mask_.view(); }
  const vision::CameraMotionResult& motion() const { return motion_result_; }
  const vision::ForegroundMaskResult& area() const { return area_result_; }
  std::span<const vision::Box> burnt_in() const { return burnt_in_.boxes(); }  // analysis pixels
  std::span<const vision::Region> regions() const { return scaled_; }          // frame pixels
  std::span<const vision::Track> tracks() const { return tracks_; }
  // Bytes that all stages hold, planes included.
  std::size_t bytes() const;
  // What it needs itself, to hand regions on in frame pixels.
  std::size_t own_bytes() const { return scaled_.capacity() * sizeof(vision::Region); }

 private:
  void forget();

  vision::LumaSource frame_;
  double seconds_ = 0;
  int analysis_width_ = 320;
  bool burnt_in_on_ = false;
  vision::LumaScaler scaler_;
  vision::CameraMotion motion_;
  vision::ThreeFrameDifference difference_;
  vision::ForegroundMask area_;
  vision::BurntIn burnt_in_;
  vision::RegionFinder regions_;
  vision::Tracker tracker_;
  vision::Image<std::uint8_t> luma_, current_, mask_;
  vision::Histogram histogram_{};
  vision::CameraMotionResult motion_result_;
  vision::DifferenceResult difference_result_;
  vision::ForegroundMaskResult area_result_;
  std::vector<vision::Region> scaled_;
  std::span<const vision::Region> found_;
  std::span<const vision::Track> tracks_;
};

}  // namespace cerberus::tests
