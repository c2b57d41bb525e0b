// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pose.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "private/event.hpp"
#include "private/head.hpp"
#include "private/meta.hpp"

namespace {

struct PoseMeta {
  GstMeta meta;
  CerberusPose pose;
};

const GstMetaInfo* meta_info();
using Carried = cerberus::ValueMeta<&PoseMeta::pose, cerberus_pose_init, meta_info>;

const GstMetaInfo* meta_info() {
  static const GstMetaInfo* const info =
      Carried::register_as(CERBERUS_POSE_META_API_TYPE, "CerberusPoseMeta");
  return info;
}

constexpr std::pair<const char*, double CerberusPose::*> kNumbers[] = {
    {"pan", &CerberusPose::pan},
    {"tilt", &CerberusPose::tilt},
    {"pan-speed", &CerberusPose::pan_speed},
    {"tilt-speed", &CerberusPose::tilt_speed},
    {"pan-acceleration", &CerberusPose::pan_acceleration},
    {"tilt-acceleration", &CerberusPose::tilt_acceleration},
};

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusPose, cerberus_pose, cerberus_pose_copy, cerberus_pose_free)

GType cerberus_pose_source_get_type(void) {
  static const GType type = [] {
    static const GEnumValue values[] = {
        {CERBERUS_POSE_COMMANDED, "CERBERUS_POSE_COMMANDED", "commanded"},
        {CERBERUS_POSE_MEASURED, "CERBERUS_POSE_MEASURED", "measured"},
        {0, nullptr, nullptr},
    };
    return g_enum_register_static("CerberusPoseSource", values);
  }();
  return type;
}

GType cerberus_pose_meta_api_get_type(void) {
  static const GType type = cerberus::register_meta_api("CerberusPoseMetaAPI");
  return type;
}

void cerberus_pose_init(CerberusPose* pose) {
  g_return_if_fail(pose);
  *pose = {};
  pose->head = g_intern_static_string(cerberus::kHead);
  pose->valid_until = GST_CLOCK_TIME_NONE;
  pose->settled = TRUE;
}

CerberusPose* cerberus_pose_new(void) {
  auto* pose = g_new(CerberusPose, 1);
  cerberus_pose_init(pose);
  return pose;
}

void cerberus_pose_set_head(CerberusPose* pose, const gchar* head) {
  g_return_if_fail(pose);
  g_return_if_fail(head);
  pose->head = g_intern_string(head);
}

CerberusPose* cerberus_pose_copy(const CerberusPose* pose) {
  return static_cast<CerberusPose*>(g_memdup2(pose, sizeof *pose));
}

void cerberus_pose_free(CerberusPose* pose) {
  g_free(pose);
}

gboolean cerberus_pose_evaluate(const CerberusPose* pose, GstClockTime running_time, gdouble* pan,
                                gdouble* tilt) {
  g_return_val_if_fail(pose, FALSE);
  GstClockTime when = running_time;
  if (!GST_CLOCK_TIME_IS_VALID(when) || when < pose->valid_from)
    when = pose->valid_from;
  else if (GST_CLOCK_TIME_IS_VALID(pose->valid_until) && when > pose->valid_until)
    when = std::max(pose->valid_from, pose->valid_until);
  const double dt = static_cast<double>(when - pose->valid_from) / GST_SECOND;
  if (pan) *pan = pose->pan + (pose->pan_speed + 0.5 * pose->pan_acceleration * dt) * dt;
  if (tilt) *tilt = pose->tilt + (pose->tilt_speed + 0.5 * pose->tilt_acceleration * dt) * dt;
  return when == running_time;
}

GstEvent* cerberus_event_new_pose(const CerberusPose* pose) {
  g_return_val_if_fail(pose, nullptr);
  GstStructure* structure = gst_structure_new(
      CERBERUS_EVENT_POSE, "head", G_TYPE_STRING, cerberus::head_of(*pose), "valid-from", G_TYPE_UINT64,
      static_cast<guint64>(pose->valid_from), "valid-until", G_TYPE_UINT64,
      static_cast<guint64>(pose->valid_until), "source", CERBERUS_TYPE_POSE_SOURCE, pose->source, "moving",
      G_TYPE_BOOLEAN, pose->moving, "settled", G_TYPE_BOOLEAN, pose->settled, nullptr);
  for (const auto& [name, member] : kNumbers)
    gst_structure_set(structure, name, G_TYPE_DOUBLE, pose->*member, nullptr);
  return gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, structure);
}

CerberusPose* cerberus_event_parse_pose(GstEvent* event) {
  g_return_val_if_fail(GST_IS_EVENT(event), nullptr);
  if (!cerberus::is_custom_upstream(event, CERBERUS_EVENT_POSE)) return nullptr;
  const GstStructure* structure = gst_event_get_structure(event);
  CerberusPose pose;
  cerberus_pose_init(&pose);
  const gchar* head = gst_structure_get_string(structure, "head");
  guint64 from = 0, until = 0;
  gint source = 0;
  if (!head || !gst_structure_get_uint64(structure, "valid-from", &from) ||
      !gst_structure_get_uint64(structure, "valid-until", &until) ||
      !gst_structure_get_enum(structure, "source", CERBERUS_TYPE_POSE_SOURCE, &source) ||
      !gst_structure_get_boolean(structure, "moving", &pose.moving) ||
      !gst_structure_get_boolean(structure, "settled", &pose.settled))
    return nullptr;
  if (!GST_CLOCK_TIME_IS_VALID(from) || (GST_CLOCK_TIME_IS_VALID(until) && until < from)) return nullptr;
  for (const auto& [name, member] : kNumbers) {
    double& number = pose.*member;
    if (!gst_structure_get_double(structure, name, &number)) return nullptr;
    if (!(std::fabs(number) <= cerberus::kMostDegrees)) return nullptr;  // NaN fails too
  }
  pose.head = g_intern_string(head);
  pose.valid_from = from;
  pose.valid_until = until;
  pose.source = static_cast<CerberusPoseSource>(source);
  return cerberus_pose_copy(&pose);
}

gboolean cerberus_buffer_set_pose(GstBuffer* buffer, const CerberusPose* pose) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  if (!pose) return Carried::set(buffer, nullptr);
  CerberusPose named = *pose;
  named.head = cerberus::head_of(*pose);
  return Carried::set(buffer, &named);
}

const CerberusPose* cerberus_buffer_peek_pose(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return Carried::peek(buffer);
}

CerberusPose* cerberus_buffer_get_pose(GstBuffer* buffer) {
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  return pose ? cerberus_pose_copy(pose) : nullptr;
}
