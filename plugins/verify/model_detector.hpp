// SPDX-License-Identifier: LGPL-2.1-or-later
// A neural network of the user's that detects objects: an ONNX file, run by OpenCV.
#pragma once

#include <memory>
#include <string>

#include "vision/persons/person_detector.h"

namespace cerberus::plugin {

// model: an ONNX file with outputs that vision::NetworkReader reads. labels: a file with the name of a class in each
// line, of which one is `person`; empty: the first class is. threshold: of the score, 0 to 1. Where it cannot be used,
// returns nullptr, and in `wrong` a sentence that says why.
std::unique_ptr<vision::PersonDetector> make_model_detector(const std::string& model,
                                                            const std::string& labels, double threshold,
                                                            std::string& wrong);

}  // namespace cerberus::plugin
