// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenCV's pedestrian detector of 48x96 pixels: histograms of oriented gradients and a linear SVM that was trained on the Daimler
// pedestrian data set (Enzweiler and Gavrila 2009). The weights are compiled into OpenCV: no model file is needed.
#pragma once

#include <memory>

#include "vision/verification/person_detector.h"

namespace cerberus::plugin {

// threshold: of the SVM's score, below which windows are no hits.
std::unique_ptr<vision::PersonDetector> make_daimler_detector(double threshold);

}  // namespace cerberus::plugin
