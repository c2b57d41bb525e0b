// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenCV's pedestrian detector of 48x96 pixels: histograms of oriented gradients and a linear SVM that was trained on the Daimler
// pedestrian data set (Enzweiler and Gavrila 2009). The weights are compiled into OpenCV: no model file is needed.
#pragma once

#include <memory>

#include "vision/verification/person_detector.h"

namespace cerberus::plugin {

// Shares of a box above the head and below the feet of persons who were followed with this detector's boxes. Measured:
// medians of head and foot, -.026 and +.028 on PETS09-S2L1, -.035 and 0 on TUD-Campus, -.028 and +.035 on TUD-Stadtmitte.
constexpr double kAboveHead = 0.03, kBelowFeet = 0.02;

// threshold: of the SVM's score, below which windows are no hits.
std::unique_ptr<vision::PersonDetector> make_daimler_detector(double threshold);

}  // namespace cerberus::plugin
