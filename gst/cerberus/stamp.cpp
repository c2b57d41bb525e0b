// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/stamp.h>

#include "cerberus/private/define.hpp"
#include "cerberus/private/text.hpp"

namespace {

void unknown(CerberusStamp& stamp) {
  stamp.running_time = stamp.utc = GST_CLOCK_TIME_NONE;
}

CerberusStamp sane(CerberusStamp stamp) {
  if (!cerberus::is_one_of(CERBERUS_TYPE_UTC_SOURCE, &stamp.utc_source))
    stamp.utc_source = CERBERUS_UTC_UNKNOWN;
  return stamp;
}

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusStamp& stamp) {
  archive(cerberus::publish::Moment{stamp.running_time}, stamp.utc, stamp.utc_source, stamp.camera_name);
  stamp = sane(stamp);
}

CERBERUS_DEFINE_BOXED(CerberusStamp, cerberus_stamp, unknown)
CERBERUS_DEFINE_ENUM(CerberusUtcSource, cerberus_utc_source,
                     {CERBERUS_UTC_UNKNOWN, "CERBERUS_UTC_UNKNOWN", "unknown"},
                     {CERBERUS_UTC_REFERENCE_TIMESTAMP, "CERBERUS_UTC_REFERENCE_TIMESTAMP",
                      "reference-timestamp"},
                     {CERBERUS_UTC_CLOCK, "CERBERUS_UTC_CLOCK", "clock"})
CERBERUS_DEFINE_META(CerberusStamp, stamp, sane, nullptr)

void cerberus_stamp_set_camera_name(CerberusStamp* stamp, const gchar* name) {
  g_return_if_fail(stamp);
  stamp->camera_name = name && *name ? g_intern_string(name) : nullptr;
}

GstStructure* cerberus::stamped(const char* name, const CerberusStamp* stamp) {
  GstStructure* to = gst_structure_new(name, "running-time", G_TYPE_UINT64,
                                       stamp ? stamp->running_time : GST_CLOCK_TIME_NONE, nullptr);
  if (stamp && GST_CLOCK_TIME_IS_VALID(stamp->utc))
    gst_structure_set(to, "utc", G_TYPE_UINT64, stamp->utc, "utc-source", G_TYPE_STRING,
                      cerberus_utc_source_get_nick(stamp->utc_source), nullptr);
  if (stamp && stamp->camera_name)
    gst_structure_set(to, "camera-name", G_TYPE_STRING, printable(stamp->camera_name).c_str(), nullptr);
  return to;
}

CerberusStamp* cerberus_message_parse_stamp(GstMessage* message) {
  g_return_val_if_fail(GST_IS_MESSAGE(message), nullptr);
  const GstStructure* from = gst_message_get_structure(message);
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ELEMENT || !from ||
      !g_str_has_prefix(gst_structure_get_name(from), "cerberus-") || !cerberus::has_running_time(from))
    return nullptr;
  CerberusStamp* stamp = cerberus_stamp_new();
  gst_structure_get_uint64(from, "running-time", &stamp->running_time);
  constexpr cerberus::Field kUtc[] = {{"utc", cerberus::Field::Type::time, offsetof(CerberusStamp, utc)},
                                      {"utc-source", cerberus::Field::Type::nick,
                                       offsetof(CerberusStamp, utc_source), cerberus_utc_source_get_type}};
  if (!cerberus::read_fields(from, kUtc, stamp)) {
    stamp->utc = GST_CLOCK_TIME_NONE;
    stamp->utc_source = CERBERUS_UTC_UNKNOWN;
  }
  cerberus_stamp_set_camera_name(stamp, gst_structure_get_string(from, "camera-name"));
  return stamp;
}
