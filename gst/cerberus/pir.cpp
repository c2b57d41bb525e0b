// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pir.h>

#include <cmath>

#include "private/structure.hpp"

namespace {

constexpr char kRunningTime[] = "running-time";
constexpr char kSensors[] = "sensors";
constexpr char kBearings[] = "bearings";
constexpr char kFieldOfView[] = "field-of-view";

const char* format_name(CerberusPirFormat format) {
  return format == CERBERUS_PIR_LEVEL ? "level" : "presence";
}

// Empty when all is well, else what is wrong, for a user.
const char* fault(const CerberusPirInfo& info) {
  if (info.sensors < 1 || info.sensors > CERBERUS_PIR_MAX_SENSORS) return "sensors must be 1 to 16";
  if (!(info.field_of_view > 0 && info.field_of_view <= 360))
    return "field-of-view must be above 0, up to 360 degrees";
  for (guint i = 0; i < info.sensors; ++i)
    if (!std::isfinite(info.bearings[i])) return "bearings must be finite numbers of degrees";
  return nullptr;
}

void set_bearings(GstStructure* structure, const CerberusPirInfo& info) {
  cerberus::set_array(structure, kBearings, G_TYPE_DOUBLE, g_value_set_double, info.sensors, info.bearings);
}

gboolean refuse(GError** error, const GstCaps* caps, const char* why) {
  gchar* text = gst_caps_to_string(caps);
  g_set_error(error, GST_CORE_ERROR, GST_CORE_ERROR_NEGOTIATION, "PIR caps \"%s\" cannot be used: %s.", text,
              why);
  g_free(text);
  return FALSE;
}

}  // namespace

void cerberus_pir_info_init(CerberusPirInfo* info) {
  g_return_if_fail(info);
  *info = {};
  info->format = CERBERUS_PIR_PRESENCE;
  info->sensors = 3;
  info->bearings[0] = 0;
  info->bearings[1] = -120;
  info->bearings[2] = 120;
  info->field_of_view = 120;
}

GstCaps* cerberus_pir_info_to_caps(const CerberusPirInfo* info) {
  g_return_val_if_fail(info, nullptr);
  if (fault(*info)) return nullptr;
  GstStructure* structure = gst_structure_new(
      "application/x-pir", "format", G_TYPE_STRING, format_name(info->format), kSensors, G_TYPE_INT,
      static_cast<gint>(info->sensors), kFieldOfView, G_TYPE_DOUBLE, info->field_of_view, nullptr);
  set_bearings(structure, *info);
  GstCaps* caps = gst_caps_new_empty();
  gst_caps_append_structure(caps, structure);
  return caps;
}

gboolean cerberus_pir_info_from_caps(CerberusPirInfo* info, const GstCaps* caps, GError** error) {
  g_return_val_if_fail(info, FALSE);
  g_return_val_if_fail(GST_IS_CAPS(caps), FALSE);
  const GstStructure* s = gst_caps_is_fixed(caps) ? gst_caps_get_structure(caps, 0) : nullptr;
  if (!s || !gst_structure_has_name(s, "application/x-pir"))
    return refuse(error, caps, "they are not application/x-pir");
  CerberusPirInfo found{};
  const gchar* format = gst_structure_get_string(s, "format");
  if (g_strcmp0(format, "presence") == 0)
    found.format = CERBERUS_PIR_PRESENCE;
  else if (g_strcmp0(format, "level") == 0)
    found.format = CERBERUS_PIR_LEVEL;
  else
    return refuse(error, caps, "format must be presence or level");
  gint sensors = 0;
  if (!gst_structure_get_int(s, kSensors, &sensors) || sensors < 1 || sensors > CERBERUS_PIR_MAX_SENSORS)
    return refuse(error, caps, "sensors must be 1 to 16");
  found.sensors = static_cast<guint>(sensors);
  const GValue* bearings = gst_structure_get_value(s, kBearings);
  if (!bearings || !GST_VALUE_HOLDS_ARRAY(bearings) || gst_value_array_get_size(bearings) != found.sensors)
    return refuse(error, caps, "bearings must name one angle in degrees for each sensor");
  for (guint i = 0; i < found.sensors; ++i) {
    const GValue* value = gst_value_array_get_value(bearings, i);
    if (!G_VALUE_HOLDS_DOUBLE(value)) return refuse(error, caps, "bearings must be of type double");
    found.bearings[i] = g_value_get_double(value);
  }
  if (!gst_structure_get_double(s, kFieldOfView, &found.field_of_view)) found.field_of_view = 0;
  if (const char* why = fault(found)) return refuse(error, caps, why);
  *info = found;
  return TRUE;
}

gsize cerberus_pir_info_buffer_size(const CerberusPirInfo* info) {
  g_return_val_if_fail(info, 0);
  return info->sensors * (info->format == CERBERUS_PIR_LEVEL ? sizeof(gfloat) : 1);
}

GstMessage* cerberus_message_new_pir(GstObject* src, GstClockTime running_time, const CerberusPirInfo* info,
                                     const guint8* sensors) {
  g_return_val_if_fail(!src || GST_IS_OBJECT(src), nullptr);
  g_return_val_if_fail(info && info->sensors <= CERBERUS_PIR_MAX_SENSORS && sensors, nullptr);
  GstStructure* structure = gst_structure_new(CERBERUS_MESSAGE_PIR, kRunningTime, G_TYPE_UINT64,
                                              static_cast<guint64>(running_time), nullptr);
  cerberus::set_array(structure, kSensors, G_TYPE_INT, g_value_set_int, info->sensors, sensors);
  set_bearings(structure, *info);
  return gst_message_new_element(src, structure);
}

GBytes* cerberus_message_parse_pir(GstMessage* message, GstClockTime* running_time) {
  g_return_val_if_fail(GST_IS_MESSAGE(message), nullptr);
  const GstStructure* structure = cerberus::element_structure(message, CERBERUS_MESSAGE_PIR);
  if (!structure) return nullptr;
  const GValue* array = gst_structure_get_value(structure, kSensors);
  guint64 time = 0;
  if (!gst_structure_get_uint64(structure, kRunningTime, &time) || !array || !GST_VALUE_HOLDS_ARRAY(array))
    return nullptr;
  guint8 sensors[CERBERUS_PIR_MAX_SENSORS];
  const guint count = gst_value_array_get_size(array);
  if (count < 1 || count > CERBERUS_PIR_MAX_SENSORS) return nullptr;
  for (guint i = 0; i < count; ++i) {
    const GValue* value = gst_value_array_get_value(array, i);
    if (!G_VALUE_HOLDS_INT(value) || g_value_get_int(value) < 0 || g_value_get_int(value) > 2) return nullptr;
    sensors[i] = static_cast<guint8>(g_value_get_int(value));
  }
  if (running_time) *running_time = time;
  return g_bytes_new(sensors, count);
}
