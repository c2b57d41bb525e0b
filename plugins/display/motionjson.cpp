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
 *  "vy":0.4,"confidence":0.93,"bearing":-12.25,"distance":null}]}
 * ]|
 *
 * - `pts`: nanoseconds, of the buffer; null where it has none. `frame`: counts input buffers from 0 since start.
 * - `width`, `height`: of the frame, pixels.
 * - `threshold`: grey levels; null while there is none (no `fuzzythreshold` upstream, or fewer than three frames
 *   of the scene).
 * - `camera`: where the picture went from the previous frame to this one, a homography in row-major order, in
 *   pixels of this frame; `confidence`: 0 to 1. Both are null where no element upstream measured it.
 * - `objects`: null where no detector ran upstream, [] where one found nothing. `id` is the track's identity, null for a region without a tracker; `type` is `motion`
 *   (`person` is reserved: nothing verifies that yet); `kind` is `person-like`, `group`, `part` or `thing`, by
 *   its size and the people of the scene; `state` is `seen`, `coasted` or `stopped`; `x`, `y`, `w`, `h`:
 *   pixels of the frame; `vx`, `vy`: pixels a second, camera motion taken out (of a stream without time stamps and
 *   frame rate: at 25 frames a second); `bearing`: degrees from the camera's axis, whatever the head's pose, positive to
 *   the right; `distance`: metres.
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
 *   rules `camera`, `sector`, `overlap`, `return`, `zero`, `stopped`), `action` (`track`,
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

#include <algorithm>
#include <limits>

#include "cerberus/private/element.hpp"
#include "cerberus/private/text.hpp"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/properties.hpp"
#include "shared/record.hpp"
#include "shared/stamps.hpp"
#include "text/json_line.h"
#include "text/utc.h"

namespace {

GST_DEBUG_CATEGORY_STATIC(motionjson_debug);
#define GST_CAT_DEFAULT motionjson_debug

// Nothing of the picture is touched: every format, every memory, interlaced too.
GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_JSON_LINES_CAPS));

constexpr int kPixelDecimals = 2;
constexpr int kShareDecimals = 3;
constexpr int kCameraDigits = 9;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Settings {
  std::string camera_name;
};

const cerberus::plugin::Property<Settings> kProperties[] = {
    cerberus::plugin::property("camera-name", &Settings::camera_name, cerberus::plugin::kCameraNameBlurb),
};

struct State {  // streaming thread only
  int width = 0, height = 0;
  guint64 frame = 0;
  cerberus::plugin::Stamps stamps;
  cerberus::plugin::Complaint complaint;  // about the caps
  cerberus::text::JsonLine line;
};

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusMotionJson, cerberus_motion_json, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

void write_object(cerberus::text::JsonLine& line, const CerberusRegion& region) {
  line.open('{').key("id");
  if (region.tracked)
    line.integer(region.id);
  else
    line.null();
  line.key("type").string(region.person ? "person" : "motion");
  line.key("kind").string(cerberus_region_kind_get_nick(region.kind));
  line.key("state").string(cerberus_region_state_get_nick(region.state));
  line.key("x").fixed(region.x, kPixelDecimals).key("y").fixed(region.y, kPixelDecimals);
  line.key("w").fixed(region.width, kPixelDecimals).key("h").fixed(region.height, kPixelDecimals);
  line.key("vx").fixed(region.vx, kPixelDecimals).key("vy").fixed(region.vy, kPixelDecimals);
  line.key("confidence").fixed(region.confidence, kShareDecimals);
  line.key("bearing").fixed(region.bearing, kPixelDecimals);
  line.key("distance").fixed(region.distance, kPixelDecimals).close('}');
}

// Writes the fields of a system with a head and sensors.
void write_system(cerberus::text::JsonLine& line, GstBuffer* buffer, GstClockTime time) {
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(buffer)) {
    const auto look =
        cerberus::plugin::look_of(*pose, time).value_or(cerberus::motion::PanTilt{kUnknown, kUnknown});
    line.key("pose").open('{').key("pan").fixed(cerberus::sensing::degrees(look.pan), kPixelDecimals);
    line.key("tilt").fixed(cerberus::sensing::degrees(look.tilt), kPixelDecimals);
    line.key("moving").boolean(pose->moving != FALSE).close('}');
  }
  if (const CerberusBase* base = cerberus_buffer_peek_base(buffer))
    line.key("base").open('{').key("yaw-rate").fixed(base->yaw_rate, kPixelDecimals).close('}');
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
  if (!fusion) return;
  line.key("pir").open('[');
  for (guint i = 0; i < std::min<guint>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS); ++i)
    line.integer(fusion->sensors[i]);
  line.close(']').key("fusion").open('{').key("rule").integer(fusion->rule);
  line.key("name").text(cerberus::printable(fusion->rule_name ? fusion->rule_name : ""));
  line.key("action").string(cerberus_fusion_action_get_nick(fusion->action)).key("target");
  if (fusion->target)
    line.integer(fusion->target);
  else
    line.null();
  line.close('}');
}

void write_stamp(cerberus::text::JsonLine& line, const CerberusStamp& stamp) {
  if (GST_CLOCK_TIME_IS_VALID(stamp.utc)) {
    line.key("utc").string(cerberus::text::Utc(cerberus::plugin::time_of(stamp.utc)));
    line.key("utc-source").string(cerberus_utc_source_get_nick(stamp.utc_source));
  }
  if (stamp.camera_name) line.key("camera-name").text(cerberus::printable(stamp.camera_name));
}

std::string_view write_line(State& state, GstBuffer* buffer, const CerberusStamp& stamp) {
  cerberus::text::JsonLine& line = state.line;
  line.clear();
  line.open('{').key("pts");
  if (GST_BUFFER_PTS_IS_VALID(buffer))
    line.integer(GST_BUFFER_PTS(buffer));
  else
    line.null();
  line.key("frame").integer(state.frame);
  write_stamp(line, stamp);
  line.key("width").integer(state.width).key("height").integer(state.height);

  line.key("threshold");
  const auto* facts = cerberus::plugin::threshold_facts_of(buffer);
  if (facts && facts->result.ready)
    line.integer(facts->result.threshold);
  else
    line.null();

  line.key("camera");
  if (const auto* camera = cerberus_buffer_peek_camera_motion(buffer)) {
    line.open('[');
    for (const double n : camera->matrix) line.significant(n, kCameraDigits);
    line.close(']').key("confidence").fixed(camera->confidence, kShareDecimals);
  } else {
    line.null().key("confidence").null();
  }

  line.key("objects");
  if (cerberus_buffer_regions_known(buffer)) {
    line.open('[');
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < regions->len; ++i)
      write_object(line, *static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i)));
    line.close(']');
  } else {
    line.null();
  }
  write_system(line, buffer, stamp.running_time);
  return line.close('}').finish();
}

gboolean cerberus_motion_json_start(GstBaseTransform* transform) {
  State& state = cerberus_motion_json_self(transform)->priv->state;
  state.frame = 0;
  state.width = state.height = 0;
  state.complaint.forget();
  state.stamps.reset();
  return TRUE;
}

GstCaps* cerberus_motion_json_transform_caps(GstBaseTransform*, GstPadDirection direction, GstCaps*,
                                             GstCaps* filter) {
  GstCaps* caps =
      gst_static_pad_template_get_caps(direction == GST_PAD_SINK ? &src_template : &sink_template);
  if (!filter) return caps;
  GstCaps* common = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return common;
}

gboolean cerberus_motion_json_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
  // By hand: GstVideoInfo does not know the formats of every memory.
  State& state = cerberus_motion_json_self(transform)->priv->state;
  const GstStructure* structure = gst_caps_get_structure(in, 0);
  const bool known = gst_structure_get_int(structure, "width", &state.width) &&
                     gst_structure_get_int(structure, "height", &state.height);
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    const std::string wrong = known ? "" : "The video has no size.";
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
    return known;
  });
}

// The frame ends here and is only looked at: any stride will do.
gboolean cerberus_motion_json_propose_allocation(GstBaseTransform*, GstQuery*, GstQuery* query) {
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return TRUE;
}

GstFlowReturn cerberus_motion_json_generate_output(GstBaseTransform* transform, GstBuffer** out) {
  *out = nullptr;
  GstBuffer* in = std::exchange(transform->queued_buf, nullptr);
  if (!in) return GST_FLOW_OK;  // asked again after each line
  const GstFlowReturn flow = cerberus::guarded(transform, GST_FLOW_ERROR, [&] {
    Private& priv = *cerberus_motion_json_self(transform)->priv;
    State& state = priv.state;
    const CerberusStamp stamp = state.stamps.frame(GST_BASE_TRANSFORM_SINK_PAD(transform), in,
                                                   cerberus::plugin::running_time_of(transform->segment, in),
                                                   priv.settings.snapshot().camera_name);
    const std::string_view line = write_line(state, in, stamp);
    *out = gst_buffer_new_memdup(line.data(), line.size());
    gst_buffer_copy_into(*out, in, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
    GST_BUFFER_OFFSET(*out) = state.frame;
    GST_BUFFER_OFFSET_END(*out) = ++state.frame;
    return GST_FLOW_OK;
  });
  gst_buffer_unref(in);
  return flow;
}

void cerberus_motion_json_init(CerberusMotionJson* self) {
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
  gst_base_transform_set_qos_enabled(GST_BASE_TRANSFORM(self), FALSE);  // one line a buffer, however late
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

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_motion_json_start;
  transform->transform_caps = cerberus_motion_json_transform_caps;
  transform->set_caps = cerberus_motion_json_set_caps;
  transform->propose_allocation = cerberus_motion_json_propose_allocation;
  transform->generate_output = cerberus_motion_json_generate_output;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(motionjson, GST_RANK_NONE, cerberus_motion_json, motionjson_debug,
                          "motion to JSON lines")
