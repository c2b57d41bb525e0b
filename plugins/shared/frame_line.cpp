// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shared/frame_line.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <limits>

#include "cerberus/private/text.hpp"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/record.hpp"
#include "text/utc.h"

namespace cerberus::plugin {

namespace {

constexpr int kPixelDecimals = 2;
constexpr int kShareDecimals = 3;
constexpr int kCameraDigits = 9;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

void write_object(text::JsonLine& line, const CerberusRegion& region) {
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
  line.key("distance").fixed(region.distance, kPixelDecimals);
  line.key("witnesses").open('[');
  if (region.motion) line.string("motion");
  if (region.person) line.string("person");
  line.close(']').close('}');
}

// Writes the fields of a system with a head and sensors.
void write_system(text::JsonLine& line, GstBuffer* buffer, GstClockTime time) {
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(buffer)) {
    const auto look = look_of(*pose, time).value_or(motion::PanTilt{kUnknown, kUnknown});
    line.key("pose").open('{').key("pan").fixed(sensing::degrees(look.pan), kPixelDecimals);
    line.key("tilt").fixed(sensing::degrees(look.tilt), kPixelDecimals);
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
  line.key("name").text(printable(fusion->rule_name ? fusion->rule_name : ""));
  line.key("action").string(cerberus_fusion_action_get_nick(fusion->action)).key("target");
  if (fusion->target)
    line.integer(fusion->target);
  else
    line.null();
  line.close('}');
}

void write_stamp(text::JsonLine& line, const CerberusStamp& stamp) {
  if (GST_CLOCK_TIME_IS_VALID(stamp.utc)) {
    line.key("utc").string(text::Utc(time_of(stamp.utc)));
    line.key("utc-source").string(cerberus_utc_source_get_nick(stamp.utc_source));
  }
  if (stamp.camera_name) line.key("camera-name").text(printable(stamp.camera_name));
}

}  // namespace

std::string_view write_frame_line(text::JsonLine& line, GstBuffer* buffer, const CerberusStamp& stamp,
                                  const FrameFacts& frame) {
  line.clear();
  line.open('{').key("pts");
  if (GST_BUFFER_PTS_IS_VALID(buffer))
    line.integer(GST_BUFFER_PTS(buffer));
  else
    line.null();
  line.key("frame").integer(frame.number);
  write_stamp(line, stamp);
  line.key("width").integer(frame.width).key("height").integer(frame.height);

  line.key("threshold");
  const auto* facts = threshold_facts_of(buffer);
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

}  // namespace cerberus::plugin
