// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-cameramotion
 *
 * Measures how the camera itself moved since the previous frame, from the picture alone, and attaches the result: a
 * #CerberusCameraMotion (transform, confidence, residual, scene age) and the small luma picture that the following
 * stages analyse. The frame goes through untouched and is never copied. A cut starts a new scene (scene age 1).
 *
 * Where a head's pose is known (its meta on the buffer, else the events `cerberus-pose` that pass upstream), the pose
 * at the frame's own running time is attached too, and with `horizontal-fov` the head's turn is the first guess; a
 * turned picture is bent, which is taken from it too. The events are passed on. In a stream that is not live, events
 * that come through a queue behind this element are ignored, with a warning: each run would use them for other frames.
 *
 * With `horizontal-fov` it tells two more things. How fast the body turns that carries the camera (a robot) is attached
 * as a #CerberusBase: the picture's rotation without the head's. An event `cerberus-base` from the application (it
 * holds for a second), or what the buffer carries already, goes before it. And the picture is compared with the head:
 * where in 20 degrees of travel it does not follow the changes of the commanded speed, a warning says whether the head
 * slips, turns the wrong way, or by another angle (a wrong lens or gear); once for each fault. The message's details:
 * `head`, `axis` (`pan`, `tilt`), `fault` (`slips`, `reversed`, `scale`), `gain`, `travel` (degrees). Poses that came
 * on the frames are not compared: who made the frames knew.
 *
 * Pads: one sink, one src, raw progressive video in system memory, 32x32 to 8192x8192.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! cameramotion model=homography ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// "The camera motion of the input frame is compensated" (paper II.B, first line) leaves the how open: patches of the
// analysis picture are matched between the frames and a transform is fitted that the moving objects cannot bend; see
// lib/vision/ego_motion/camera_motion.h. Standing still is snapped to exactly the identity.
#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(cameramotion_debug);
#define GST_CAT_DEFAULT cameramotion_debug

namespace cerberus::plugin {
namespace {

constexpr AnalysisInfo kInfo{"CerberusCameraMotionElement", "Camera motion",
                             "Measures how the camera itself moved since the previous frame"};

}  // namespace

GType cameramotion_get_type() {
  return analysis_type<StageElement<vision::Stage::camera>, kCameraProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(cameramotion, GST_RANK_NONE, cerberus::plugin::cameramotion, cameramotion_debug,
                          "the camera's own motion")
