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
#include <vector>

#include "cerberus/private/element.hpp"
#include "onvif_caps.hpp"
#include "publish/onvif_metadata.h"
#include "shared/camera_mount.hpp"
#include "shared/frame_text.hpp"
#include "shared/properties.hpp"

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

struct Private {
  cerberus::plugin::Adjustable<Settings> settings;
  cerberus::plugin::TextStream stream;  // this and what follows: streaming thread only
  cerberus::publish::MetadataFrame frame;
  std::vector<cerberus::publish::MetadataObject> objects;
  std::vector<std::optional<bool>> sensors;
  cerberus::publish::OnvifMetadata document;

  static std::string camera_name() { return {}; }
  std::string_view write(GstBuffer* buffer, const CerberusStamp& stamp);
  void read_results(GstBuffer* buffer, GstClockTime time);
};

void Private::read_results(GstBuffer* buffer, GstClockTime time) {
  objects.clear();
  frame.analysed = cerberus_buffer_regions_known(buffer) != FALSE;
  if (frame.analysed) {
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < regions->len; ++i)
      objects.push_back(object_of(*static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i))));
  }
  frame.objects = objects;

  frame.head.reset();
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(buffer)) {
    frame.head.emplace().moves = pose->moving != FALSE;
    if (pose->field_of_view > 0) frame.field_of_view = pose->field_of_view;
    if (const auto look = cerberus::plugin::look_of(*pose, time)) {
      frame.head->pan = cerberus::sensing::degrees(look->pan);
      frame.head->tilt = cerberus::sensing::degrees(look->tilt);
    }
  }

  sensors.clear();
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer))
    for (guint i = 0; i < std::min<guint>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS); ++i) {
      auto& detects = sensors.emplace_back();
      if (const guint8 reading = fusion->sensors[i]; reading <= 1) detects = reading == 1;  // 2: invalid
    }
  frame.sensors = sensors;
}

std::string_view Private::write(GstBuffer* buffer, const CerberusStamp& stamp) {
  const GstClockTime utc = GST_CLOCK_TIME_IS_VALID(stamp.utc) ? stamp.utc : stamp.running_time;
  frame.utc = cerberus::plugin::time_of(GST_CLOCK_TIME_IS_VALID(utc) ? utc : 0);
  frame.width = stream.width, frame.height = stream.height;
  frame.field_of_view = settings.snapshot().field_of_view;
  read_results(buffer, stamp.running_time);
  return document.write(frame);
}

CERBERUS_DEFINE_TYPE(CerberusOnvifMeta, cerberus_onvif_meta, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

using Text = cerberus::plugin::FrameText<cerberus_onvif_meta_self>;

void cerberus_onvif_meta_init(CerberusOnvifMeta* self) {
  Text::init(GST_BASE_TRANSFORM(self));
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

  Text::install(GST_BASE_TRANSFORM_CLASS(klass));
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(onvifmeta, GST_RANK_NONE, cerberus_onvif_meta, onvifmeta_debug,
                          "motion to ONVIF metadata")
