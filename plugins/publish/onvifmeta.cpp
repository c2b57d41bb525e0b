// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-onvifmeta
 * @title: onvifmeta
 * @short_description: an ONVIF metadata document for every video frame
 * @see_also: rtponvifmetapay, motionjson, motiondetect
 *
 * Turns what the elements upstream attached to each video buffer into one XML document as the ONVIF Streaming
 * Specification has it, which video management systems read. The picture itself is not read, so that any raw video will
 * do, in any memory.
 *
 * Pads: `sink` takes raw video, `src` gives `application/x-onvif-metadata`, one document a buffer, with the time stamps
 * and the duration of the frame. `rtponvifmetapay` sends them.
 *
 * A document holds:
 *
 * - `VideoAnalytics/Frame`, where a detector ran upstream: an `Object` for each region, with the identity of its track,
 *   `BoundingBox` and `CenterOfGravity` in normalized coordinates (-1 to 1, right and up), `Class/Type` with the region's
 *   confidence as its likelihood, and `Behaviour`: `Idle` for one that has stopped, `Direction` as seen in the picture
 *   (yaw 0 is to the right, 180 to the left), `Speed` in metres a second across the line of sight, where distance and
 *   `horizontal-fov` are known. The type is `Human` for what is verified to be a person only; else it is the region's kind
 *   (`person-like`, `group`, `part`, `thing`), which readers that want humans only pass over.
 * - `PTZStatus`, where the pose of a head is on the frame (`pantiltsink`, `virtualptz`): in the `Frame`, else in `PTZ`.
 *   `Position` in degrees (space `SphericalPositionSpaceDegrees`), `MoveStatus`, and `FieldOfView` as the head's zoom
 *   says, else as `horizontal-fov` says (square pixels).
 * - `SensorData` of `Type` PIR with `SensorID` pir_0, pir_1, ..., where `pirfusion` has attached its sensors: 1 for a
 *   detection, 0 for none; a sensor without a valid value is left out.
 *
 * All times are the wall-clock time of the frame (see `motionjson`: reference timestamp, or the system's clock where the
 * stream is live). A stream without one, such as a file, counts its running time from 1970-01-01.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! motiondetect ! onvifmeta ! fdsink
 * ]|
 *
 * Since: 0.1
 */
#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "cerberus/private/element.hpp"
#include "onvif_caps.hpp"
#include "publish/onvif_metadata.h"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/complaint.hpp"
#include "shared/properties.hpp"
#include "shared/stamps.hpp"

namespace {

GST_DEBUG_CATEGORY_STATIC(onvifmeta_debug);
#define GST_CAT_DEFAULT onvifmeta_debug

// Nothing of the picture is touched: every format, every memory, interlaced too.
GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));
GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS,
                                                            GST_STATIC_CAPS(cerberus::plugin::kOnvifCaps));

struct Settings {
  double field_of_view = 0;
};

const cerberus::plugin::Property<Settings> kProperties[] = {
    cerberus::plugin::property(
        "horizontal-fov", &Settings::field_of_view, 0, cerberus::plugin::kMaximumFieldOfView,
        "Angle in degrees that the lens sees over the frame's whole width: with it, the "
        "field of view and speeds are published; 0 = unknown"),
};

struct State {  // streaming thread only
  cerberus::publish::MetadataFrame frame;
  std::vector<cerberus::publish::MetadataObject> objects;
  std::vector<std::optional<bool>> sensors;
  cerberus::publish::OnvifMetadata document;
  cerberus::plugin::Stamps stamps;
  cerberus::plugin::Complaint complaint;  // about the caps
};

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  State state;
};

CERBERUS_DEFINE_TYPE(CerberusOnvifMeta, cerberus_onvif_meta, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

cerberus::publish::MetadataObject object_of(const CerberusRegion& region) {
  cerberus::publish::MetadataObject object;
  if (region.tracked) object.id = region.id;
  object.x = region.x, object.y = region.y;
  object.width = region.width, object.height = region.height;
  object.vx = region.vx, object.vy = region.vy;
  object.distance = region.distance;
  object.confidence = region.confidence;
  object.type = region.person ? "Human" : cerberus_region_kind_get_nick(region.kind);
  object.stands = region.state == CERBERUS_REGION_STOPPED;
  return object;
}

void read_results(State& state, GstBuffer* buffer, GstClockTime time) {
  state.objects.clear();
  state.frame.analysed = cerberus_buffer_regions_known(buffer) != FALSE;
  if (state.frame.analysed) {
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < regions->len; ++i)
      state.objects.push_back(object_of(*static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i))));
  }
  state.frame.objects = state.objects;

  state.frame.head.reset();
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(buffer)) {
    state.frame.head.emplace().moves = pose->moving != FALSE;
    if (pose->field_of_view > 0) state.frame.field_of_view = pose->field_of_view;
    if (const auto look = cerberus::plugin::look_of(*pose, time)) {
      state.frame.head->pan = cerberus::sensing::degrees(look->pan);
      state.frame.head->tilt = cerberus::sensing::degrees(look->tilt);
    }
  }

  state.sensors.clear();
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer))
    for (guint i = 0; i < std::min<guint>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS); ++i) {
      auto& detects = state.sensors.emplace_back();
      if (const guint8 reading = fusion->sensors[i]; reading <= 1) detects = reading == 1;  // 2: invalid
    }
  state.frame.sensors = state.sensors;
}

gboolean cerberus_onvif_meta_start(GstBaseTransform* transform) {
  State& state = cerberus_onvif_meta_self(transform)->priv->state;
  state.complaint.forget();
  state.stamps.reset();
  return TRUE;
}

GstCaps* cerberus_onvif_meta_transform_caps(GstBaseTransform*, GstPadDirection direction, GstCaps*,
                                            GstCaps* filter) {
  GstCaps* caps =
      gst_static_pad_template_get_caps(direction == GST_PAD_SINK ? &src_template : &sink_template);
  if (!filter) return caps;
  GstCaps* common = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return common;
}

gboolean cerberus_onvif_meta_set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps*) {
  // By hand: GstVideoInfo does not know the formats of every memory.
  State& state = cerberus_onvif_meta_self(transform)->priv->state;
  const GstStructure* structure = gst_caps_get_structure(in, 0);
  int width = 0, height = 0;
  const bool known = gst_structure_get_int(structure, "width", &width) &&
                     gst_structure_get_int(structure, "height", &height);
  state.frame.width = std::max(width, 1);
  state.frame.height = std::max(height, 1);
  return cerberus::guarded(transform, FALSE, [&]() -> gboolean {
    const std::string wrong = known ? "" : "The video has no size.";
    if (state.complaint.is_new(wrong))
      CERBERUS_ELEMENT_ERROR(transform, CORE, NEGOTIATION, (wrong), ("caps %" GST_PTR_FORMAT, in));
    return known;
  });
}

// The frame ends here and is only looked at: any stride will do.
gboolean cerberus_onvif_meta_propose_allocation(GstBaseTransform*, GstQuery*, GstQuery* query) {
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  return TRUE;
}

GstFlowReturn cerberus_onvif_meta_generate_output(GstBaseTransform* transform, GstBuffer** out) {
  *out = nullptr;
  GstBuffer* in = std::exchange(transform->queued_buf, nullptr);
  if (!in) return GST_FLOW_OK;  // asked again after each document
  const GstFlowReturn flow = cerberus::guarded(transform, GST_FLOW_ERROR, [&] {
    Private& priv = *cerberus_onvif_meta_self(transform)->priv;
    State& state = priv.state;
    const GstClockTime time = cerberus::plugin::running_time_of(transform->segment, in);
    const CerberusStamp stamp = state.stamps.frame(GST_BASE_TRANSFORM_SINK_PAD(transform), in, time, {});
    const GstClockTime utc = GST_CLOCK_TIME_IS_VALID(stamp.utc) ? stamp.utc : time;
    state.frame.utc = cerberus::plugin::time_of(GST_CLOCK_TIME_IS_VALID(utc) ? utc : 0);
    state.frame.field_of_view = priv.settings.snapshot().field_of_view;
    read_results(state, in, time);
    const std::string_view text = state.document.write(state.frame);
    *out = gst_buffer_new_memdup(text.data(), text.size());
    gst_buffer_copy_into(*out, in, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
    return GST_FLOW_OK;
  });
  gst_buffer_unref(in);
  return flow;
}

void cerberus_onvif_meta_init(CerberusOnvifMeta* self) {
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), FALSE);
  gst_base_transform_set_qos_enabled(GST_BASE_TRANSFORM(self), FALSE);  // one document a buffer, however late
}

void cerberus_onvif_meta_class_init(CerberusOnvifMetaClass* klass) {
  cerberus::plugin::install_properties<CerberusOnvifMeta, kProperties>(G_OBJECT_CLASS(klass));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(
      element, "Motion to ONVIF metadata", "Filter/Analyzer/Video",
      "Writes an ONVIF metadata document for every video frame: objects, pose of the head, PIR sensors",
      "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_onvif_meta_start;
  transform->transform_caps = cerberus_onvif_meta_transform_caps;
  transform->set_caps = cerberus_onvif_meta_set_caps;
  transform->propose_allocation = cerberus_onvif_meta_propose_allocation;
  transform->generate_output = cerberus_onvif_meta_generate_output;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(onvifmeta, GST_RANK_NONE, cerberus_onvif_meta, onvifmeta_debug,
                          "motion to ONVIF metadata")
