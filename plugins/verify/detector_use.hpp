// SPDX-License-Identifier: LGPL-2.1-or-later
// The detectors that the element offers, for looks at parts of a frame and at whole frames.
#pragma once

#include <memory>
#include <string>

#include "model_detector.hpp"
#include "vision/persons/body_boxes.h"
#include "vision/persons/person_detector.h"
#include "vision/persons/whole_frame_detector.h"

namespace cerberus::plugin {

enum class DetectorKind { daimler, hog, model };

struct DetectorUse {
  double threshold = 0, certain = 0;  // scores: by default the least, and what counts as certain
  double least = 0;                   // score down to which boxes of a whole frame are of use to a tracker
  vision::BodyShare followed;         // part of a window by which persons are followed
  double enlargement = 1;             // as HogScan
  // Shares of that part above the head and below the feet.
  double above_head = 0, below_feet = 0;
};
const DetectorUse& use_of(DetectorKind kind);

// least: score below which hits are of no use. model: of DetectorKind::model, with any threshold. Where the detector cannot
// be used, returns nullptr, and in `wrong` a sentence that says why.
std::unique_ptr<vision::PersonDetector> make_look_detector(DetectorKind kind, double least,
                                                           ModelSettings model, std::string& wrong);

// Lines of a whole frame that a detector with a window scans. Chosen: 45 to 70 ms a look; 720 lines take a core at 4 looks a
// second.
constexpr int kWholeFrameLines = 480;
// The same for whole frames, with one box a body, down to use_of(kind).least. lines: of a detector with a window.
std::unique_ptr<vision::WholeFrameDetector> make_whole_frame_detector(DetectorKind kind, ModelSettings model,
                                                                      std::string& wrong,
                                                                      int lines = kWholeFrameLines);

}  // namespace cerberus::plugin
