// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenCV's pedestrian detectors: histograms of oriented gradients and a linear SVM (Dalal and Triggs, CVPR 2005). The
// weights are compiled into OpenCV: no file is needed.
#pragma once

#include <memory>

#include "vision/persons/body_boxes.h"
#include "vision/persons/person_detector.h"

namespace cerberus::plugin {

enum class HogWeights {
  daimler,  // window of 48x96 pixels, trained on the Daimler pedestrian data set (Enzweiler and Gavrila 2009)
  inria,    // OpenCV's default people detector: 64x128 pixels, trained on INRIA's persons
};

// How the picture is scanned.
struct HogScan {
  double threshold = 0;  // score of the SVM, below which a window is no hit
  // From one scale of the pyramid to the next. swept: bench-persons, mean average precision with 1.05, 1.07 and 1.1 of hog
  // .632, .605 and .602 at 73, 52 and 37 ms a look, of Daimler .620 and .632 with the first two at 61 and 45 ms.
  double scale_step = 1.07;
  // Pixels around the picture that windows reach, a multiple of 8: a window is wider and higher than the person in it.
  int padding = 16;
};

std::unique_ptr<vision::PersonDetector> make_hog_detector(HogWeights weights, const HogScan& scan);

// Of a window: bodies of 79 (Daimler) and 97 lines fill the window of the smallest scale. Heights: geometry of the training
// windows; measured alike on all sequences (the default detector's bodies: .73 to .79 high). The default detector's width:
// measured; with .48 the boxes of the sequences in which windows decide are .11 to .26 wider than the truth.
constexpr vision::BodyShare body_share(HogWeights weights) {
  return weights == HogWeights::daimler ? vision::BodyShare{0.52, 0.82} : vision::BodyShare{0.43, 0.76};
}

}  // namespace cerberus::plugin
