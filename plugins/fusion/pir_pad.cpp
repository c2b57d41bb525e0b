// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pir_pad.hpp"

#include <limits>

#include "sensing/angles.h"

namespace cerberus::plugin {
namespace {

CERBERUS_DEFINE_TYPE(CerberusPirPad, cerberus_pir_pad, GstPad, GST_TYPE_PAD, PirPad)
void cerberus_pir_pad_init(CerberusPirPad*) {}
void cerberus_pir_pad_class_init(CerberusPirPadClass*) {}

}  // namespace

GstPad* pir_pad_new(const char* name, GstPadTemplate* pad_template) {
  return GST_PAD(g_object_new(cerberus_pir_pad_get_type(), "name", name, "direction", GST_PAD_SINK,
                              "template", pad_template, nullptr));
}

void PirPad::reset() {
  history = {};
  sensors = 0;
  given_up = complained = refused = false;
  live.reset();
  gst_segment_init(&segment, GST_FORMAT_UNDEFINED);
  cerberus_pir_info_init(&info);
  info.sensors = 0;
}

std::optional<Time> running_time(const GstSegment& segment, GstClockTime position) {
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(position)) return std::nullopt;
  guint64 time = 0;
  const gint sign = gst_segment_to_running_time_full(&segment, GST_FORMAT_TIME, position, &time);
  if (sign == 0) return std::nullopt;
  // The last nanoseconds of 292 years are left for "just after".
  constexpr auto latest = static_cast<guint64>(std::numeric_limits<Time::rep>::max() / 2);
  return Time(sign < 0 ? 0 : static_cast<Time::rep>(MIN(time, latest)));
}

std::shared_ptr<const SensorArray> sensor_array(const CerberusPirInfo& info) {
  auto array = std::make_shared<SensorArray>();
  array->count = static_cast<int>(info.sensors);
  array->field_of_view = sensing::radians(info.field_of_view);
  for (guint i = 0; i < info.sensors; ++i) array->bearings[i] = sensing::radians(info.bearings[i]);
  return array;
}

bool is_live(GstPad* sinkpad) {
  gboolean live = FALSE;
  GstQuery* query = gst_query_new_latency();
  if (gst_pad_peer_query(sinkpad, query)) gst_query_parse_latency(query, &live, nullptr, nullptr);
  gst_query_unref(query);
  return live;
}

}  // namespace cerberus::plugin
