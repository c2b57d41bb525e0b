// SPDX-License-Identifier: LGPL-2.1-or-later
#include "detector_use.hpp"

#include <utility>

#include "hog_detector.hpp"

namespace cerberus::plugin {

namespace {

// Threshold: swept on TUD-Campus, TUD-Stadtmitte and PETS09-S2L1 (1.7 finds more things that are none, 2.1 loses a tenth of
// the people). Margins: medians of head and foot, -.026 and +.028 on PETS09-S2L1, -.035 and 0 on TUD-Campus, -.028 and +.035
// on TUD-Stadtmitte.
constexpr DetectorUse kDaimler{
    .threshold = 1.9, .certain = 4, .followed = {0.66, 0.86}, .above_head = 0.03, .below_feet = 0.02};
// Measured: quartiles of the score 1.7 to 3.1 of a person before the camera, .3 to 1.8 of smaller ones, -.1 to .6 of what is
// none. The part is as much larger than the body as Daimler's, and the enlargement is the ratio of the bodies' heights.
constexpr DetectorUse kHog{.threshold = 0.5,
                           .certain = 2,
                           .least = -0.2,
                           .followed = {0.61, 0.8},
                           .enlargement = 1.24,
                           .above_head = 0.03,
                           .below_feet = 0.02};
constexpr DetectorUse kModel{.threshold = 0.4, .certain = 1, .least = 0.1, .followed = {}};  // probabilities

// The scan of a look, which shows a region with a margin around it. Chosen: scales nearer to each other than a scan of the
// whole frame affords.
constexpr double kLookScaleStep = 1.05;

HogWeights weights_of(DetectorKind kind) {
  return kind == DetectorKind::hog ? HogWeights::inria : HogWeights::daimler;
}

}  // namespace

const DetectorUse& use_of(DetectorKind kind) {
  return kind == DetectorKind::model ? kModel : kind == DetectorKind::hog ? kHog : kDaimler;
}

std::unique_ptr<vision::PersonDetector> make_look_detector(DetectorKind kind, double least,
                                                           ModelSettings model, std::string& wrong) {
  if (kind == DetectorKind::model) {
    model.threshold = least;
    return make_model_detector(model, wrong);
  }
  const DetectorUse& use = use_of(kind);
  return make_hog_detector(weights_of(kind), {.threshold = least,
                                              .scale_step = kLookScaleStep,
                                              .padding = 0,
                                              .enlargement = use.enlargement,
                                              .share = use.followed});
}

std::unique_ptr<vision::WholeFrameDetector> make_whole_frame_detector(DetectorKind kind, ModelSettings model,
                                                                      std::string& wrong, int lines) {
  const double least = use_of(kind).least;
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
