// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motionjson
 * @title: motionjson
 * @short_description: one line of JSON for every video frame
 * @see_also: motiondetect, motionoverlay, motionview
 *
 * Turns what the stages upstream attached to each video buffer into one line of JSON: exactly one for every
 * input buffer, from the first on, whether anything moves or not. The picture itself is not read, so that any
 * raw video will do, in any memory.
 *
 * Pads: `sink` takes raw video, `src` gives `application/x-json-lines`, one object and a line feed a buffer,
 * with the time stamps and the duration of the frame.
 *
 * A line (in one row):
 * |[
 * {"pts":1966666666,"frame":59,"width":320,"height":240,"threshold":14,"camera":[1,0,-3.25,0,1,0,0,0,1],
 *  "confidence":0.871,"objects":[{"id":4,"type":"motion","kind":"person-like","state":"seen","x":101.5,"y":60,"w":22,"h":58.5,"vx":-31.2,
 *  "vy":0.4,"confidence":0.93,"bearing":-12.25,"distance":null,"witnesses":["motion"]}]}
 * ]|
 *
 * - `pts`: nanoseconds, of the buffer; null where it has none. `frame`: counts input buffers from 0 since start.
 * - `width`, `height`: of the frame, pixels.
 * - `threshold`: grey levels; null while there is none (no `fuzzythreshold` upstream, or fewer than three frames
 *   of the scene).
 * - `camera`: where the picture went from the previous frame to this one, a homography in row-major order, in
 *   pixels of this frame; `confidence`: 0 to 1. Both are null where no element upstream measured it.
 * - `objects`: null where no detector ran upstream, [] where one found nothing. `id` is the track's identity, null for a region without a tracker; `type` is `motion`
 *   (`person` while looks of a person detector show it); `kind` is `person-like`, `group`, `part` or `thing`, by
 *   its size and the people of the scene; `state` is `seen`, `coasted` or `stopped`; `x`, `y`, `w`, `h`:
 *   pixels of the frame; `vx`, `vy`: pixels a second, camera motion taken out (of a stream without time stamps and
 *   frame rate: at 25 frames a second); `bearing`: degrees from the camera's axis, whatever the head's pose, positive to
 *   the right; `distance`: metres; `witnesses`: `motion` where a track of what moves has its place, or has had it within
 *   the last second, `person` while looks of a person detector show it.
 *
 * Keys that are there only where their values are known, after `frame`:
 * - `utc`: wall-clock time of the frame, ISO 8601; `utc-source`: `reference-timestamp` (the buffer carries one, as of
 *   rtspsrc's `add-reference-timestamp-meta`) or `clock` (live: the system's clock when the frame arrived).
 * - `camera-name`: the property of this name, here or upstream.
 *
 * Keys that are there only where the frame carries the value, after `objects`:
 * - `pose`: of the head when the frame was taken (`pantiltsink`, `virtualptz`): `pan`, `tilt` in degrees,
 *   `moving` true or false.
 * - `base`: `yaw-rate`, how fast the body turned that carries the camera (a robot), degrees a second, positive to the
 *   right (`cameramotion` with `horizontal-fov`, or the application).
 * - `pir`: the sensors' readings, 0 nothing, 1 detection, 2 invalid; and `fusion`: the
 *   decision of `pirfusion`: `rule` (number, 0 for one without), `name` (the rule's: of the default
 *   rules `camera`, `sector`, `overlap`, `return`, `zero`, `stopped`, `chosen`), `action` (`track`,
 *   `turn-left`, `turn-right`, `search`, `zero`, `hold`), `target` (a track's identity or null).
 *
 * Numbers have a point whatever the locale. Pixels, speeds, degrees and metres are rounded to 2 decimals,
 * confidences to 3, `camera` to 9 significant digits. What is unknown, not a number or infinite is null.
 * Readers ignore keys that they do not know.
 *
 * Reads the camera-motion, threshold and region metas of motiondetect's
 * stages, the pose, base and fusion metas. Posts no messages.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 ! motiondetect ! motionjson ! fdsink
 * gst-launch-1.0 -q filesrc location=vtest.avi ! decodebin ! motiondetect ! motionjson ! \
 *     filesink location=objects.jsonl
 * gst-launch-1.0 filesrc location=vtest.avi ! decodebin ! motiondetect ! tee name=t \
 *     t. ! queue ! motionjson ! filesink location=objects.jsonl \
 *     t. ! queue ! motionoverlay ! videoconvert ! autovideosink
 * ]|
 *
 * Since: 0.1
 */

#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>

#include "cerberus/private/element.hpp"
#include "shared/frame_line.hpp"
#include "shared/frame_text.hpp"
#include "shared/properties.hpp"

namespace {

GST_DEBUG_CATEGORY_STATIC(motionjson_debug);
#define GST_CAT_DEFAULT motionjson_debug

// Nothing of the picture is touched: every format, every memory, interlaced too.
GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_JSON_LINES_CAPS));

struct Settings {
  std::string camera_name;
};

const cerberus::plugin::Property<Settings> kProperties[] = {
    cerberus::plugin::property("camera-name", &Settings::camera_name, cerberus::plugin::kCameraNameBlurb),
};

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  cerberus::plugin::TextStream stream;
  cerberus::text::JsonLine line;

  std::string camera_name() const { return settings.snapshot().camera_name; }
  std::string_view write(GstBuffer* buffer, const CerberusStamp& stamp) {
    return cerberus::plugin::write_frame_line(line, buffer, stamp,
                                              {stream.frame, stream.width, stream.height});
  }
};

CERBERUS_DEFINE_TYPE(CerberusMotionJson, cerberus_motion_json, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

using Text = cerberus::plugin::FrameText<cerberus_motion_json_self>;

void cerberus_motion_json_init(CerberusMotionJson* self) {
  Text::init(GST_BASE_TRANSFORM(self));
}

void cerberus_motion_json_class_init(CerberusMotionJsonClass* klass) {
  cerberus::plugin::install_properties<CerberusMotionJson, kProperties>(G_OBJECT_CLASS(klass));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(
      element, "Motion to JSON lines", "Filter/Analyzer/Video",
      "Writes one line of JSON for every video frame: objects, camera motion, threshold",
      "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  Text::install(GST_BASE_TRANSFORM_CLASS(klass));
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(motionjson, GST_RANK_NONE, cerberus_motion_json, motionjson_debug,
                          "motion to JSON lines")
