// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pose.h>

#include <algorithm>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kFields[] = {
    {"head", Type::word, offsetof(CerberusPose, head)},
    {"valid-from", Type::time, offsetof(CerberusPose, valid_from)},
    {"valid-until", Type::time, offsetof(CerberusPose, valid_until)},
    {"source", Type::choice, offsetof(CerberusPose, source), cerberus_pose_source_get_type},
    {"moving", Type::flag, offsetof(CerberusPose, moving)},
    {"settled", Type::flag, offsetof(CerberusPose, settled)},
    {"pan", Type::angle, offsetof(CerberusPose, pan)},
    {"tilt", Type::angle, offsetof(CerberusPose, tilt)},
    {"pan-speed", Type::angle, offsetof(CerberusPose, pan_speed)},
    {"tilt-speed", Type::angle, offsetof(CerberusPose, tilt_speed)},
    {"pan-acceleration", Type::angle, offsetof(CerberusPose, pan_acceleration)},
    {"tilt-acceleration", Type::angle, offsetof(CerberusPose, tilt_acceleration)},
    {"field-of-view", Type::angle, offsetof(CerberusPose, field_of_view)},
};

void straight_ahead(CerberusPose& pose) {
  pose.head = cerberus::head_of(pose);
  pose.valid_until = GST_CLOCK_TIME_NONE;
  pose.settled = TRUE;
}

CerberusPose sane(CerberusPose pose) {
  pose.head = cerberus::head_of(pose);
  if (!cerberus::is_one_of(CERBERUS_TYPE_POSE_SOURCE, &pose.source)) pose.source = CERBERUS_POSE_COMMANDED;
  return pose;
}

void write(GstStructure* to, const CerberusPose& pose) {
  const CerberusPose written = sane(pose);
  cerberus::write_fields(to, kFields, &written);
}

bool read(const GstStructure* from, CerberusPose& pose) {
  cerberus::read_known_fields(from, std::span(kFields).last(1), &pose);  // it may be absent
  return cerberus::read_fields(from, std::span(kFields).first(std::size(kFields) - 1), &pose) &&
         GST_CLOCK_TIME_IS_VALID(pose.valid_from) && pose.valid_until >= pose.valid_from;
}

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusPose& pose) {
  archive(pose.head, cerberus::publish::Moment{pose.valid_from}, cerberus::publish::Moment{pose.valid_until},
          pose.source, pose.moving, pose.settled, pose.pan, pose.tilt, pose.pan_speed, pose.tilt_speed,
          pose.pan_acceleration, pose.tilt_acceleration, pose.field_of_view);
  pose = sane(pose);
}

CERBERUS_DEFINE_BOXED(CerberusPose, cerberus_pose, straight_ahead)
CERBERUS_DEFINE_ENUM(CerberusPoseSource, cerberus_pose_source,
                     {CERBERUS_POSE_COMMANDED, "CERBERUS_POSE_COMMANDED", "commanded"},
                     {CERBERUS_POSE_MEASURED, "CERBERUS_POSE_MEASURED", "measured"})
CERBERUS_DEFINE_META(CerberusPose, pose, sane, nullptr)
CERBERUS_DEFINE_EVENT(CerberusPose, pose, CERBERUS_EVENT_POSE, GST_EVENT_CUSTOM_UPSTREAM, cerberus::is_any)

void cerberus_pose_set_head(CerberusPose* pose, const gchar* head) {
  g_return_if_fail(pose);
  g_return_if_fail(head);
  pose->head = g_intern_string(head);
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
