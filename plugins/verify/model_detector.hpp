// SPDX-License-Identifier: LGPL-2.1-or-later
// A neural network of the user's that detects objects, run by OpenCV.
#pragma once

#include <memory>
#include <string>

#include "vision/persons/person_detector.h"

namespace cerberus::plugin {

// Names of files, and numbers as text: see the element's properties.
struct ModelSettings {
  std::string
      model;  // an ONNX file with outputs that vision::NetworkReader reads, or darknet's weights (.weights)
  std::string config;  // of weights: their .cfg; empty: beside them, of the same name
  std::string
      labels;  // the name of a class in each line, of which one is `person`; empty: the first class is
  std::string mean, scale;  // of the input (vision::NetworkInput); empty: usual for the outputs' layout
  double threshold = 0;     // of the score, 0 to 1
};

// Where the model cannot be used, returns nullptr, and in `wrong` a sentence that says why.
std::unique_ptr<vision::PersonDetector> make_model_detector(const ModelSettings& settings,
                                                            std::string& wrong);

}  // namespace cerberus::plugin
