// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-threeframediff
 *
 * Adds to the frame's record what changed between three consecutive frames once the camera's own motion is taken out:
 * the registered differences D(k) and D(k-1), and the histogram of the first. The frame goes through untouched. D(k-1)
 * is made only where an element downstream reads it: `fuzzythreshold` with another `area` than `all`, or `motionview`.
 * Without `cameramotion` upstream the camera stands still and the luma picture is made here. D(k) is zero in the first
 * frame of a scene, D(k-1) in the first two.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! threeframediff ! fuzzythreshold ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// Paper Eq. 1 and 2: D(k) = |F(k) - F(k-1)|, D(k-1) = |F(k-1) - F(k-2)|. The printed elements of Eq. 2 are one index
// late; Eq. 3 has it right. Deviations: both differences stand in frame k's coordinates (F(k-1) and F(k-2) are warped
// there, never an old difference), a 3x3 blur goes before (`blur`), a change of light of the whole picture is taken out
// (`compensate-light`), and what is not visible in all three frames does not move. See
// lib/vision/change/three_frame_difference.h.
#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(threeframediff_debug);
#define GST_CAT_DEFAULT threeframediff_debug

namespace cerberus::plugin {
namespace {

constexpr AnalysisInfo kInfo{"CerberusThreeFrameDiff", "Three-frame difference",
                             "Differences of three consecutive frames with the camera's motion taken out"};

}  // namespace

GType threeframediff_get_type() {
  return analysis_type<StageElement<vision::Stage::differences>, kOwnOfDifferences, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(threeframediff, GST_RANK_NONE, cerberus::plugin::threeframediff,
                          threeframediff_debug, "registered differences of three frames")
