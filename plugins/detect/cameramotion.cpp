// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-cameramotion
 *
 * Measures how the camera itself moved since the previous frame, from the picture alone, and attaches the result: a
 * #CerberusCameraMotion (transform, confidence, residual, scene age) and the small luma plane that the following
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
#include <cerberus/cerberus.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>

#include "analysis_element.hpp"
#include "elements.hpp"
#include "head_motion_monitor.hpp"
#include "shared/camera_mount.hpp"
#include "shared/camera_path.hpp"
#include "shared/enums.hpp"
#include "shared/stages.hpp"
#include "vision/ego_motion/camera_motion.h"
#include "vision/geometry/lens.h"

GST_DEBUG_CATEGORY_STATIC(cameramotion_debug);
#define GST_CAT_DEFAULT cameramotion_debug

namespace cerberus::plugin {
namespace {

struct Settings {
  int model = static_cast<int>(vision::CameraMotionOptions{}.model);
  double horizontal_fov = 0;
  std::string head = "head";
};

const Property<Settings> kProperties[] = {
    property("model", &Settings::model, motion_model_type,
             "How the camera may have moved between two frames: a richer model follows more kinds of motion "
             "and needs a "
             "picture with more structure; none = it stands still"),
    property("horizontal-fov", &Settings::horizontal_fov, 0, kMaximumFieldOfView,
             "Angle in degrees that the lens sees over the frame's whole width: with it a head's turn is the "
             "first guess; "
             "0 = not known"),
    property("head", &Settings::head, "Name of the head whose pose counts; empty = any"),
};

struct State {
  LumaStage luma;
  vision::CameraMotion motion;
  Settings settings;
};

struct Private final : StatefulAnalyser<Settings, State> {
  HeadMotionMonitor carrier;
  CameraPath path;

  bool measures_camera() const override { return true; }
  bool start() override {
    carrier.forget();
    return StatefulAnalyser::start();
  }
  bool analyse(Frame& frame) override;
  void upstream_event(GstEvent* event) override { carrier.hear(event, settings.snapshot().head); }
};

bool Private::analyse(Frame& frame) {
  if (const auto changed = settings.changes()) {
    state->motion.set_options({static_cast<vision::MotionModel>(changed->model)});
    state->settings = *changed;
    carrier.begin_comparison();
  }
  state->luma.set_analysis_width(cerberus_analysis_width(base));
  const MappedPlane picture = state->luma.make(frame);
  if (!picture) return false;
  if (frame.fresh) state->motion.reset();
  const vision::Lens lens(radians(state->settings.horizontal_fov), frame.size());
  std::optional<vision::Transform> prior = carrier.look(GST_ELEMENT(base), frame, state->settings.head, lens);
  if (prior) prior = prior->rescaled(frame.size(), picture.size());
  const vision::CameraMotionResult result = state->motion.update(picture.view<std::uint8_t>(), prior);

  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  const vision::Transform transform =
      result.still ? vision::Transform{} : result.transform.rescaled(picture.size(), frame.size());
  std::copy(transform.m.begin(), transform.m.end(), std::begin(motion.matrix));
  motion.from = result.scene_age > 1 ? frame.previous : GST_CLOCK_TIME_NONE;
  motion.confidence = result.confidence;
  motion.residual = result.residual * frame.size().width / picture.width();
  motion.still = result.still;
  motion.scene_age = static_cast<guint>(std::max(result.scene_age, 1));
  path.extend(motion, frame.size());
  cerberus_buffer_add_camera_motion_meta(frame.buffer, &motion);
  GST_LOG_OBJECT(base, "scene age %u, still %d, confidence %.2f, shift %.2f %.2f", motion.scene_age,
                 motion.still, motion.confidence, motion.matrix[2], motion.matrix[5]);
  carrier.compare(GST_ELEMENT(base), frame, lens, transform, result.scene_age > 1 ? result.confidence : 0);
  return true;
}

constexpr AnalysisInfo kInfo{"CerberusCameraMotionElement", "Camera motion",
                             "Measures how the camera itself moved since the previous frame"};

}  // namespace

GType cameramotion_get_type() {
  return analysis_type<Private, kProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(cameramotion, GST_RANK_NONE, cerberus::plugin::cameramotion, cameramotion_debug,
                          "the camera's own motion")
