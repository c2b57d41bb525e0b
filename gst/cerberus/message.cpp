// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/message.h>

#include "private/structure.hpp"

namespace {

constexpr char kState[] = "state";
constexpr char kStarted[] = "started";
constexpr char kEnded[] = "ended";
constexpr char kRunningTime[] = "running-time";
constexpr char kObjects[] = "objects";

void set_objects(GstStructure* structure, GPtrArray* regions) {
  GValue list = G_VALUE_INIT;
  g_value_init(&list, GST_TYPE_LIST);
  for (guint i = 0; regions && i < regions->len; ++i) {
    GstStructure* object =
        cerberus_region_to_structure(static_cast<CerberusRegion*>(g_ptr_array_index(regions, i)));
    if (!object) continue;
    GValue value = G_VALUE_INIT;
    g_value_init(&value, GST_TYPE_STRUCTURE);
    g_value_take_boxed(&value, object);
    gst_value_list_append_and_take_value(&list, &value);
  }
  gst_structure_take_value(structure, kObjects, &list);
}

GPtrArray* get_objects(const GValue* list) {
  GPtrArray* regions = g_ptr_array_new_with_free_func(reinterpret_cast<GDestroyNotify>(cerberus_region_free));
  for (guint i = 0; i < gst_value_list_get_size(list); ++i) {
    const GValue* value = gst_value_list_get_value(list, i);
    if (!GST_VALUE_HOLDS_STRUCTURE(value)) continue;
    if (CerberusRegion* region = cerberus_region_from_structure(gst_value_get_structure(value)))
      g_ptr_array_add(regions, region);
  }
  return regions;
}

}  // namespace

GstMessage* cerberus_message_new_motion(GstObject* src, gboolean started, GstClockTime running_time,
                                        GPtrArray* regions) {
  g_return_val_if_fail(!src || GST_IS_OBJECT(src), nullptr);
  GstStructure* structure =
      gst_structure_new(CERBERUS_MESSAGE_MOTION, kState, G_TYPE_STRING, started ? kStarted : kEnded,
                        kRunningTime, G_TYPE_UINT64, static_cast<guint64>(running_time), nullptr);
  set_objects(structure, regions);
  return gst_message_new_element(src, structure);
}

gboolean cerberus_message_is_motion(GstMessage* message) {
  g_return_val_if_fail(GST_IS_MESSAGE(message), FALSE);
  return cerberus::element_structure(message, CERBERUS_MESSAGE_MOTION) != nullptr;
}

gboolean cerberus_message_parse_motion(GstMessage* message, gboolean* started, GstClockTime* running_time,
                                       GPtrArray** regions) {
  if (!cerberus_message_is_motion(message)) return FALSE;
  const GstStructure* structure = gst_message_get_structure(message);
  const gchar* state = gst_structure_get_string(structure, kState);
  const GValue* objects = gst_structure_get_value(structure, kObjects);
  guint64 time = 0;
  const bool is_start = g_strcmp0(state, kStarted) == 0;
  if (!is_start && g_strcmp0(state, kEnded) != 0) return FALSE;
  if (!gst_structure_get_uint64(structure, kRunningTime, &time)) return FALSE;
  if (!objects || !GST_VALUE_HOLDS_LIST(objects)) return FALSE;
  if (started) *started = is_start;
  if (running_time) *running_time = time;
  if (regions) *regions = get_objects(objects);
  return TRUE;
}
