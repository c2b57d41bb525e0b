// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motionregions
 *
 * Turns the moving area into regions of interest: cleans the mask, labels it, joins one person's fragments, parts two
 * people side by side, and attaches every region that passes `zones` and the limits of size as a
 * #GstVideoRegionOfInterestMeta of type `motion` (see #CerberusRegion). The frame goes
 * through untouched. Stages that are missing upstream are done here with their defaults. No
 * region is published until three frames of a scene were seen. Limits of size that contradict
 * each other or the frame, and zones that leave no part of the picture, are warned of.
 *
 * `zones` in degrees (`exclude world -12,4 -5,4 -5,-6 -12,-6`: pan to the right, tilt up) stay where they are in the world
 * while the camera turns. They need `horizontal-fov` (or a head that reports its zoom) and the pose of the head at each
 * frame's own time. Without them nothing is hidden: a polygon that excludes excludes nothing, one that includes includes
 * everything, and a warning says so.
 *
 * A limit in metres judges only what has a distance: `horizontal-fov` and `mounting-height` are known, and the feet are
 * in the picture and below the horizon. The rest passes, for what cannot be measured may be a person; limits in pixels
 * and zones are for what flies and shines up there.
 *
 * The record of the stages is taken off the frame once it is read, so that frames waiting in queues hold none, unless an
 * element downstream (motionview) asks for it. `keep-planes` says otherwise: `always` leaves it there, and with `never`
 * an element that asks is not answered. Where `motiontrack` follows, the record stays on as far as there, whatever
 * `keep-planes` says.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! \
 *     motionregions zones="include 0,0 1,0 1,0.5 0,0.5" ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// The paper calls this step "post treatment" (II.B) and leaves it open. Ours: see lib/vision/detection/regions.h.
// Limits in metres use the body width of 48 cm (III) and count only while `horizontal-fov` is known.
#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(motionregions_debug);
#define GST_CAT_DEFAULT motionregions_debug

namespace cerberus::plugin {
namespace {

constexpr AnalysisInfo kInfo{"CerberusMotionRegions", "Motion regions",
                             "Regions of interest from the moving area"};

}  // namespace

GType motionregions_get_type() {
  return analysis_type<StageElement<vision::Stage::regions>, kRegionsProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motionregions, GST_RANK_NONE, cerberus::plugin::motionregions, motionregions_debug,
                          "regions of interest from the moving area")
