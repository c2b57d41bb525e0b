// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pir.h>

#include <algorithm>
#include <cmath>

#include "cerberus/private/define.hpp"

namespace {

constexpr char kSensors[] = "sensors";
constexpr char kBearings[] = "bearings";
constexpr char kFieldOfView[] = "field-of-view";

// Empty when all is well, else what is wrong, for a user.
const char* fault(const CerberusPirInfo& info) {
  if (info.sensors < 1 || info.sensors > CERBERUS_PIR_MAX_SENSORS) return "sensors must be 1 to 16";
  if (!(info.field_of_view > 0 && info.field_of_view <= 360))
    return "field-of-view must be above 0, up to 360 degrees";
  for (guint i = 0; i < info.sensors; ++i)
    if (!std::isfinite(info.bearings[i])) return "bearings must be finite numbers of degrees";
  return nullptr;
}

gboolean refuse(GError** error, const GstCaps* caps, const char* why) {
  g_autofree gchar* text = gst_caps_to_string(caps);
  g_set_error(error, GST_CORE_ERROR, GST_CORE_ERROR_NEGOTIATION, "PIR caps \"%s\" cannot be used: %s.", text,
              why);
  return FALSE;
}

void write(GstStructure* to, const CerberusPir& pir) {
  CerberusPir written = pir;
  cerberus::tidy_sensors(written.n_sensors, written.sensors, written.bearings);
  cerberus::write_sensors(to, written.n_sensors, written.sensors, written.bearings);
  gst_structure_set(to, "doubtful", G_TYPE_UINT, pir.doubtful, nullptr);
}

bool read(const GstStructure* from, CerberusPir& pir) {
  return cerberus::read_sensors(from, pir.n_sensors, pir.sensors, pir.bearings) && pir.n_sensors > 0 &&
         gst_structure_get_uint(from, "doubtful", &pir.doubtful);
}

}  // namespace

CERBERUS_DEFINE_BOXED(CerberusPir, cerberus_pir, cerberus::zero)
CERBERUS_DEFINE_ENUM(CerberusPirFormat, cerberus_pir_format,
                     {CERBERUS_PIR_PRESENCE, "CERBERUS_PIR_PRESENCE", "presence"},
                     {CERBERUS_PIR_LEVEL, "CERBERUS_PIR_LEVEL", "level"})
CERBERUS_DEFINE_MESSAGE(CerberusPir, pir, CERBERUS_MESSAGE_PIR)

void cerberus_pir_info_init(CerberusPirInfo* info) {
  g_return_if_fail(info);
  *info = {CERBERUS_PIR_PRESENCE, 3, {0, -120, 120}, 120};
}

GstCaps* cerberus_pir_info_to_caps(const CerberusPirInfo* info) {
  g_return_val_if_fail(info, nullptr);
  if (fault(*info)) return nullptr;
  GstStructure* structure = gst_structure_new("application/x-pir", "format", G_TYPE_STRING,
                                              cerberus_pir_format_get_nick(info->format), kSensors,
                                              G_TYPE_INT, static_cast<gint>(info->sensors), kFieldOfView,
                                              G_TYPE_DOUBLE, info->field_of_view, nullptr);
  cerberus::set_numbers(structure, kBearings, info->sensors, info->bearings);
  return gst_caps_new_full(structure, nullptr);
}

gboolean cerberus_pir_info_from_caps(CerberusPirInfo* info, const GstCaps* caps, GError** error) {
  g_return_val_if_fail(info, FALSE);
  g_return_val_if_fail(GST_IS_CAPS(caps), FALSE);
  const GstStructure* s = gst_caps_is_fixed(caps) ? gst_caps_get_structure(caps, 0) : nullptr;
  if (!s || !gst_structure_has_name(s, "application/x-pir"))
    return refuse(error, caps, "they are not application/x-pir");
  CerberusPirInfo found{};
  constexpr cerberus::Field kFormat[] = {{"format", cerberus::Field::Type::nick,
                                          offsetof(CerberusPirInfo, format), cerberus_pir_format_get_type}};
  if (!cerberus::read_fields(s, kFormat, &found))
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

GBytes* cerberus_pir_get_sensors(const CerberusPir* pir) {
  g_return_val_if_fail(pir, nullptr);
  return g_bytes_new(pir->sensors, std::min<guint>(pir->n_sensors, CERBERUS_PIR_MAX_SENSORS));
}
