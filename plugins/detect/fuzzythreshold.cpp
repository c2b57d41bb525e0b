// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-fuzzythreshold
 *
 * Chooses the threshold of the registered differences by the indices of fuzziness, binarises both with it and adds the
 * moving area to the frame's record, and the threshold to the frame. The frame goes through untouched. Stages
 * that are missing upstream are done here with their defaults. The mask is empty, and the threshold not `ready`, until
 * three frames of the scene were seen; and for two when `area` is changed from `all` while frames flow, as what the
 * other areas need of the third frame is not kept for `all`.
 *
 * What the camera writes into its own pictures is learnt and left out (`burnt-in`). An info message says where, once for
 * each box, in frame pixels. The private event `cerberus-burnt-in` takes the boxes upstream to `cameramotion`, which
 * measures nothing there from the next frame on, or a few frames later where a queue lies in between.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! threeframediff ! fuzzythreshold area=leading ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// Paper Eq. 3 (d = 1 where the difference is above Th), M(k-1) = D(k) and D(k-1), M(k) = D(k) - M(k-1); Eq. 4 to 10 for
// Th, in the reading of Tobias and Seara (IEEE Trans. Image Processing 11(12), 2002), from where the paper has them:
// Eq. 8 and 9 both print the factor 2 / n^(1/k), which belongs once, and Eq. 8 needs the absolute value. See
// lib/vision/change/fuzzy_threshold.h and background/foreground_mask.h. Deviations of the defaults, each a property: Th is held near the
// measured noise (`noise-floor`), lone bright pixels do not count (`clip`), and a
// registered memory of the scene completes what two neighbouring frames cannot
// see (`memory`, of D(k) alone: M(k) and M(k-1) are sets of the two differences).
#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(fuzzythreshold_debug);
#define GST_CAT_DEFAULT fuzzythreshold_debug

namespace cerberus::plugin {
namespace {

constexpr AnalysisInfo kInfo{"CerberusFuzzyThreshold", "Fuzzy threshold",
                             "Moving area by a threshold that the indices of fuzziness choose"};

}  // namespace

GType fuzzythreshold_get_type() {
  return analysis_type<StageElement<vision::Stage::foreground>, kOwnOfThreshold, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(fuzzythreshold, GST_RANK_NONE, cerberus::plugin::fuzzythreshold,
                          fuzzythreshold_debug, "threshold and moving area")
