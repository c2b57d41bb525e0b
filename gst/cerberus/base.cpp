// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/base.h>

#include <cmath>

#include "private/event.hpp"
#include "private/meta.hpp"

namespace {

struct BaseMeta {
  GstMeta meta;
  CerberusBase base;
};

const GstMetaInfo* meta_info();
using Carried = cerberus::ValueMeta<&BaseMeta::base, cerberus_base_init, meta_info>;

const GstMetaInfo* meta_info() {
  static const GstMetaInfo* const info =
      Carried::register_as(CERBERUS_BASE_META_API_TYPE, "CerberusBaseMeta");
  return info;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusBase, cerberus_base, cerberus_base_copy, cerberus_base_free)

GType cerberus_base_meta_api_get_type(void) {
  static const GType type = cerberus::register_meta_api("CerberusBaseMetaAPI");
  return type;
}

void cerberus_base_init(CerberusBase* base) {
  g_return_if_fail(base);
  *base = {};
}

CerberusBase* cerberus_base_new(void) {
  return g_new0(CerberusBase, 1);
}

CerberusBase* cerberus_base_copy(const CerberusBase* base) {
  return static_cast<CerberusBase*>(g_memdup2(base, sizeof *base));
}

void cerberus_base_free(CerberusBase* base) {
  g_free(base);
}

GstEvent* cerberus_event_new_base(gdouble yaw_rate, GstClockTime running_time) {
  return gst_event_new_custom(
      GST_EVENT_CUSTOM_UPSTREAM,
      gst_structure_new(CERBERUS_EVENT_BASE, "yaw-rate", G_TYPE_DOUBLE, yaw_rate, "running-time",
                        G_TYPE_UINT64, static_cast<guint64>(running_time), nullptr));
}

gboolean cerberus_event_parse_base(GstEvent* event, gdouble* yaw_rate, GstClockTime* running_time) {
  g_return_val_if_fail(GST_IS_EVENT(event), FALSE);
  if (!cerberus::is_custom_upstream(event, CERBERUS_EVENT_BASE)) return FALSE;
  const GstStructure* structure = gst_event_get_structure(event);
  gdouble rate = 0;
  guint64 time = 0;
  // NaN is no rate either.
  if (!gst_structure_get_double(structure, "yaw-rate", &rate) || !(std::fabs(rate) <= cerberus::kMostDegrees))
    return FALSE;
  if (!gst_structure_get_uint64(structure, "running-time", &time) || !GST_CLOCK_TIME_IS_VALID(time))
    return FALSE;
  if (yaw_rate) *yaw_rate = rate;
  if (running_time) *running_time = time;
  return TRUE;
}

gboolean cerberus_buffer_set_base(GstBuffer* buffer, const CerberusBase* base) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  return Carried::set(buffer, base);
}

const CerberusBase* cerberus_buffer_peek_base(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return Carried::peek(buffer);
}

CerberusBase* cerberus_buffer_get_base(GstBuffer* buffer) {
  const CerberusBase* base = cerberus_buffer_peek_base(buffer);
  return base ? cerberus_base_copy(base) : nullptr;
}
