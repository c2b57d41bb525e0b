// SPDX-License-Identifier: LGPL-2.1-or-later
#include "detector_use.hpp"

#include <algorithm>
#include <utility>

#include "hog_detector.hpp"

namespace cerberus::plugin {

namespace {

// Measured: quartiles of HOG's score 1.7 to 3.1 of a person before the camera, .3 to 1.8 of smaller ones, -.1 to .6 of what is
// none; Daimler's is 1 higher.
constexpr vision::DetectorUse kHog{.threshold = 0.5, .least = -0.2};
constexpr vision::DetectorUse kDaimler{.threshold = 1.5, .least = 0.8};

HogWeights weights_of(DetectorKind kind) {
  return kind == DetectorKind::hog ? HogWeights::inria : HogWeights::daimler;
}

}  // namespace

const vision::DetectorUse& use_of(DetectorKind kind) {
  return kind == DetectorKind::model ? vision::kNetworkUse : kind == DetectorKind::hog ? kHog : kDaimler;
}

std::unique_ptr<vision::WholeFrameDetector> make_whole_frame_detector(DetectorKind kind, ModelSettings model,
                                                                      std::string& wrong, int lines,
                                                                      double threshold) {
  const double least = std::min(use_of(kind).least, threshold);
  if (kind == DetectorKind::model) {
    model.threshold = least;
    auto detector = make_model_detector(model, wrong);
    if (!detector) return nullptr;
    return std::make_unique<vision::WholeFrameDetector>(std::move(detector), 0, vision::BodyShare{});
  }
  const HogWeights weights = weights_of(kind);
  return std::make_unique<vision::WholeFrameDetector>(make_hog_detector(weights, {.threshold = least}), lines,
                                                      body_share(weights));
}

}  // namespace cerberus::plugin
