// SPDX-License-Identifier: LGPL-2.1-or-later
// vision::Detector as motiondetect uses it, but for its tuned numbers (parameters.h) and mechanisms (mechanisms.h).
#pragma once

#include <gst/gst.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "mechanisms.h"
#include "parameters.h"
#include "people_sequences.h"
#include "vision/detector.h"
#include "vision/detector_parameters.h"
#include "vision/frame_history.h"

namespace cerberus::bench {

// Frames that repeat a picture, and times that are missing or go backwards, are treated as motiondetect treats them.
class SetDetector {
 public:
  using View = std::function<vision::GrayView(vision::GrayView)>;

  // analysis_width: that property of motiondetect; all others have their defaults.
  explicit SetDetector(const vision::DetectorParameters& numbers,
                       int analysis_width = vision::DetectorOptions{}.analysis_width);
  SetDetector(const DetectorSettings& settings, int analysis_width);

  // What is found on an I420 frame, or in what `view` makes of its luma plane; nothing where it cannot be read.
  std::vector<Found> find(GstSample* sample, const View& view = {});
  // How calm the scene was in the last picture: CameraMotionResult::calm.
  double calm() const { return calm_; }

 private:
  std::vector<Found> found() const;

  vision::DetectorOptions options_;
  bool camera_motion_;
  vision::Detector detector_;
  vision::FrameHistory history_;
  std::vector<vision::Track> tracks_;  // of the last picture
  std::uint64_t number_ = 0;
  double calm_ = 1;
};

// Reads `--set STAGE.NAME=VALUE`, any number of times, from the arguments behind the program's name. Prints what is wrong
// and returns false.
bool parse_numbers(int argc, char** argv, vision::DetectorParameters& numbers);

}  // namespace cerberus::bench
