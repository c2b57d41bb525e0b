// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/fusion.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "private/meta.hpp"
#include "private/structure.hpp"

namespace {

constexpr GEnumValue kActions[] = {
    {CERBERUS_FUSION_TRACK, "CERBERUS_FUSION_TRACK", "track"},
    {CERBERUS_FUSION_TURN_LEFT, "CERBERUS_FUSION_TURN_LEFT", "turn-left"},
    {CERBERUS_FUSION_TURN_RIGHT, "CERBERUS_FUSION_TURN_RIGHT", "turn-right"},
    {CERBERUS_FUSION_SEARCH, "CERBERUS_FUSION_SEARCH", "search"},
    {CERBERUS_FUSION_ZERO, "CERBERUS_FUSION_ZERO", "zero"},
    {CERBERUS_FUSION_HOLD, "CERBERUS_FUSION_HOLD", "hold"},
    {0, nullptr, nullptr},
};

constexpr guint8 kInvalid = 2;

struct FusionMeta {
  GstMeta meta;
  CerberusFusion fusion;
};

const GstMetaInfo* meta_info();
using Carried = cerberus::ValueMeta<&FusionMeta::fusion, cerberus_fusion_init, meta_info>;

const GstMetaInfo* meta_info() {
  static const GstMetaInfo* const info =
      Carried::register_as(CERBERUS_FUSION_META_API_TYPE, "CerberusFusionMeta");
  return info;
}

bool is_action(int number) {
  return std::ranges::any_of(kActions,
                             [=](const GEnumValue& a) { return a.value_name && a.value == number; });
}

// What stands there, and be it no action: as that it must not be read.
int number_of(const CerberusFusionAction& action) {
  static_assert(sizeof action == sizeof(int));
  int number = 0;
  std::memcpy(&number, &action, sizeof number);
  return number;
}

// An application may have left anything in it: a number that is
// no action moves nobody, no reading that is none says somebody.
CerberusFusion sane(CerberusFusion fusion) {
  if (!is_action(number_of(fusion.action))) fusion.action = CERBERUS_FUSION_HOLD;
  if (!fusion.rule_name) fusion.rule_name = g_intern_static_string("none");
  fusion.n_sensors = std::min<guint>(fusion.n_sensors, CERBERUS_PIR_MAX_SENSORS);
  for (guint i = 0; i < fusion.n_sensors; ++i) {
    fusion.sensors[i] = std::min(fusion.sensors[i], kInvalid);
    if (!std::isfinite(fusion.bearings[i])) fusion.bearings[i] = 0;
  }
  return fusion;
}

// What messages and events say of a decision.
GstStructure* structure_of(const gchar* name, GstClockTime running_time, const CerberusFusion& given) {
  const CerberusFusion fusion = sane(given);
  GstStructure* structure = gst_structure_new(
      name, "running-time", G_TYPE_UINT64, static_cast<guint64>(running_time), "rule", G_TYPE_INT,
      fusion.rule, "rule-name", G_TYPE_STRING, fusion.rule_name, "action", CERBERUS_TYPE_FUSION_ACTION,
      fusion.action, "target", G_TYPE_UINT, fusion.target, "pan", G_TYPE_DOUBLE, fusion.pan, "sector-from",
      G_TYPE_DOUBLE, fusion.sector_from, "sector-to", G_TYPE_DOUBLE, fusion.sector_to, "limited",
      G_TYPE_BOOLEAN, fusion.limited, "camera-found", G_TYPE_BOOLEAN, fusion.camera_found, "doubtful",
      G_TYPE_UINT, fusion.doubtful, nullptr);
  cerberus::set_array(structure, "sensors", G_TYPE_INT, g_value_set_int, fusion.n_sensors, fusion.sensors);
  cerberus::set_array(structure, "bearings", G_TYPE_DOUBLE, g_value_set_double, fusion.n_sensors,
                      fusion.bearings);
  return structure;
}

bool read_structure(const GstStructure* s, GstClockTime& time, CerberusFusion& fusion) {
  cerberus_fusion_init(&fusion);
  gint action = 0;
  const gchar* rule_name = gst_structure_get_string(s, "rule-name");
  const GValue* sensors = gst_structure_get_value(s, "sensors");
  const GValue* bearings = gst_structure_get_value(s, "bearings");
  if (!rule_name || !sensors || !GST_VALUE_HOLDS_ARRAY(sensors) || !bearings ||
      !GST_VALUE_HOLDS_ARRAY(bearings) || !gst_structure_get_uint64(s, "running-time", &time) ||
      !gst_structure_get_int(s, "rule", &fusion.rule) ||
      !gst_structure_get_enum(s, "action", CERBERUS_TYPE_FUSION_ACTION, &action) ||
      !gst_structure_get_uint(s, "target", &fusion.target) ||
      !gst_structure_get_double(s, "pan", &fusion.pan) ||
      !gst_structure_get_double(s, "sector-from", &fusion.sector_from) ||
      !gst_structure_get_double(s, "sector-to", &fusion.sector_to) ||
      !gst_structure_get_boolean(s, "limited", &fusion.limited) ||
      !gst_structure_get_boolean(s, "camera-found", &fusion.camera_found) ||
      !gst_structure_get_uint(s, "doubtful", &fusion.doubtful))
    return false;
  if (!is_action(action)) return false;
  fusion.n_sensors = gst_value_array_get_size(sensors);
  if (fusion.n_sensors > CERBERUS_PIR_MAX_SENSORS || gst_value_array_get_size(bearings) != fusion.n_sensors)
    return false;
  for (guint i = 0; i < fusion.n_sensors; ++i) {
    const GValue* reading = gst_value_array_get_value(sensors, i);
    const GValue* bearing = gst_value_array_get_value(bearings, i);
    if (!G_VALUE_HOLDS_INT(reading) || !G_VALUE_HOLDS_DOUBLE(bearing)) return false;
    const int said = g_value_get_int(reading);
    fusion.sensors[i] = said == 0 || said == 1 ? static_cast<guint8>(said) : kInvalid;
    fusion.bearings[i] = g_value_get_double(bearing);
    if (!std::isfinite(fusion.bearings[i])) return false;
  }
  fusion.rule_name = g_intern_string(rule_name);
  fusion.action = static_cast<CerberusFusionAction>(action);
  return true;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusFusion, cerberus_fusion, cerberus_fusion_copy, cerberus_fusion_free)

GType cerberus_fusion_action_get_type(void) {
  static const GType type = g_enum_register_static("CerberusFusionAction", kActions);
  return type;
}

GType cerberus_fusion_meta_api_get_type(void) {
  static const GType type = cerberus::register_meta_api("CerberusFusionMetaAPI");
  return type;
}

const gchar* cerberus_fusion_action_get_nick(CerberusFusionAction action) {
  for (const GEnumValue& value : kActions)
    if (value.value_nick && value.value == static_cast<gint>(action)) return value.value_nick;
  g_return_val_if_reached("hold");
}

void cerberus_fusion_init(CerberusFusion* fusion) {
  g_return_if_fail(fusion);
  *fusion = {};
  fusion->rule_name = g_intern_static_string("none");
  fusion->action = CERBERUS_FUSION_HOLD;
  fusion->pan = fusion->sector_from = fusion->sector_to = NAN;
  fusion->decided = GST_CLOCK_TIME_NONE;
}

CerberusFusion* cerberus_fusion_new(void) {
  auto* fusion = g_new(CerberusFusion, 1);
  cerberus_fusion_init(fusion);
  return fusion;
}

CerberusFusion* cerberus_fusion_copy(const CerberusFusion* fusion) {
  return static_cast<CerberusFusion*>(g_memdup2(fusion, sizeof *fusion));
}

void cerberus_fusion_free(CerberusFusion* fusion) {
  g_free(fusion);
}

GBytes* cerberus_fusion_get_sensors(const CerberusFusion* fusion) {
  g_return_val_if_fail(fusion, nullptr);
  return g_bytes_new(fusion->sensors, std::min<guint>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS));
}

gboolean cerberus_buffer_set_fusion(GstBuffer* buffer, const CerberusFusion* fusion) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  if (!fusion) return Carried::set(buffer, nullptr);
  const CerberusFusion carried = sane(*fusion);
  return Carried::set(buffer, &carried);
}

const CerberusFusion* cerberus_buffer_peek_fusion(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return Carried::peek(buffer);
}

CerberusFusion* cerberus_buffer_get_fusion(GstBuffer* buffer) {
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
  return fusion ? cerberus_fusion_copy(fusion) : nullptr;
}

GstMessage* cerberus_message_new_fusion(GstObject* src, GstClockTime running_time,
                                        const CerberusFusion* fusion) {
  g_return_val_if_fail(!src || GST_IS_OBJECT(src), nullptr);
  g_return_val_if_fail(fusion, nullptr);
  return gst_message_new_element(src, structure_of(CERBERUS_MESSAGE_FUSION, running_time, *fusion));
}

CerberusFusion* cerberus_message_parse_fusion(GstMessage* message, GstClockTime* running_time) {
  g_return_val_if_fail(GST_IS_MESSAGE(message), nullptr);
  const GstStructure* structure = cerberus::element_structure(message, CERBERUS_MESSAGE_FUSION);
  CerberusFusion fusion;
  GstClockTime time = 0;
  if (!structure || !read_structure(structure, time, fusion)) return nullptr;
  if (running_time) *running_time = time;
  return cerberus_fusion_copy(&fusion);
}

GstEvent* cerberus_event_new_fusion(const gchar* head, const CerberusFusion* fusion) {
  g_return_val_if_fail(fusion && GST_CLOCK_TIME_IS_VALID(fusion->decided), nullptr);
  GstStructure* structure = structure_of(CERBERUS_EVENT_FUSION, fusion->decided, *fusion);
  gst_structure_set(structure, "head", G_TYPE_STRING, head ? head : "", nullptr);
  return gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_OOB, structure);
}

CerberusFusion* cerberus_event_parse_fusion(GstEvent* event, const gchar** head) {
  g_return_val_if_fail(GST_IS_EVENT(event), nullptr);
  if (GST_EVENT_TYPE(event) != GST_EVENT_CUSTOM_DOWNSTREAM_OOB ||
      !gst_event_has_name(event, CERBERUS_EVENT_FUSION))
    return nullptr;
  const GstStructure* s = gst_event_get_structure(event);
  CerberusFusion fusion;
  const gchar* named = gst_structure_get_string(s, "head");
  GstClockTime time = 0;
  if (!named || !read_structure(s, time, fusion) || !GST_CLOCK_TIME_IS_VALID(time)) return nullptr;
  fusion.decided = time;
  if (head) *head = named;
  return cerberus_fusion_copy(&fusion);
}
