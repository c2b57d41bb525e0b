// SPDX-License-Identifier: LGPL-2.1-or-later
// The detectors that the element offers.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "model_detector.hpp"
#include "vision/persons/body_boxes.h"
#include "vision/persons/detector_use.h"
#include "vision/persons/person_detector.h"
#include "vision/persons/whole_frame_detector.h"

namespace cerberus::plugin {

enum class DetectorKind { daimler, hog, model };

const vision::DetectorUse& use_of(DetectorKind kind);

// Lines of a whole frame that a detector with a window scans. Chosen: 45 to 70 ms a look; 720 lines take a core at 4 looks a
// second.
constexpr int kWholeFrameLines = 480;
// A detector of whole frames, with one box a body, down to use_of(kind).least, or to `threshold` where that is lower. model:
// of DetectorKind::model, with any threshold. lines: of a detector with a window. Where the detector cannot be used, returns
// nullptr, and in `wrong` a sentence that says why.
std::unique_ptr<vision::WholeFrameDetector> make_whole_frame_detector(
    DetectorKind kind, ModelSettings model, std::string& wrong, int lines = kWholeFrameLines,
    double threshold = std::numeric_limits<double>::infinity());

}  // namespace cerberus::plugin
