// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pantilt.h>

#include "cerberus/private/define.hpp"
#include "cerberus/private/text.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kFields[] = {
    {"state", Type::nick, offsetof(CerberusPantilt, state), cerberus_pantilt_state_get_type},
    {"head", Type::word, offsetof(CerberusPantilt, pose.head)},
    {"pan", Type::number, offsetof(CerberusPantilt, pose.pan)},
    {"tilt", Type::number, offsetof(CerberusPantilt, pose.tilt)},
    {"running-time", Type::time, offsetof(CerberusPantilt, pose.valid_from)},
};
constexpr cerberus::Field kWaits[] = {
    {"waits-for-order", Type::flag, offsetof(CerberusPantilt, waits_for_order)}};

void at_rest(CerberusPantilt& pantilt) {
  cerberus_pose_init(&pantilt.pose);
}
void own(CerberusPantilt& pantilt) {
  pantilt.reason = g_strdup(pantilt.reason);
}
void release(CerberusPantilt& pantilt) {
  g_free(pantilt.reason);
}

void write(GstStructure* to, const CerberusPantilt& pantilt) {
  CerberusPantilt written = pantilt;
  written.pose.head = cerberus::head_of(pantilt.pose);
  // The time of a message is its stamp's.
  cerberus::write_fields(to, std::span(kFields).first<4>(), &written);
  cerberus::write_fields(to, kWaits, &written);
  const std::string reason = cerberus::printable(pantilt.reason ? pantilt.reason : "");
  gst_structure_set(to, "reason", G_TYPE_STRING, reason.c_str(), nullptr);
}

bool read(const GstStructure* from, CerberusPantilt& pantilt) {
  const gchar* reason = gst_structure_get_string(from, "reason");
  pantilt.reason = g_strdup(reason);
  cerberus::read_known_fields(from, kWaits, &pantilt);
  return reason && cerberus::read_fields(from, kFields, &pantilt);
}

}  // namespace

CERBERUS_DEFINE_OWNING_BOXED(CerberusPantilt, cerberus_pantilt, at_rest, own, release)
CERBERUS_DEFINE_ENUM(CerberusPantiltState, cerberus_pantilt_state,
                     {CERBERUS_PANTILT_STOPPED, "CERBERUS_PANTILT_STOPPED", "stopped"},
                     {CERBERUS_PANTILT_TRACKING, "CERBERUS_PANTILT_TRACKING", "tracking"},
                     {CERBERUS_PANTILT_TURNING, "CERBERUS_PANTILT_TURNING", "turning"},
                     {CERBERUS_PANTILT_SEARCHING, "CERBERUS_PANTILT_SEARCHING", "searching"},
                     {CERBERUS_PANTILT_ZEROING, "CERBERUS_PANTILT_ZEROING", "zeroing"},
                     {CERBERUS_PANTILT_HOLDING, "CERBERUS_PANTILT_HOLDING", "holding"},
                     {CERBERUS_PANTILT_MANUAL, "CERBERUS_PANTILT_MANUAL", "manual"},
                     {CERBERUS_PANTILT_LIMITED, "CERBERUS_PANTILT_LIMITED", "limited"},
                     {CERBERUS_PANTILT_FAULT, "CERBERUS_PANTILT_FAULT", "fault"},
                     {CERBERUS_PANTILT_HOMING, "CERBERUS_PANTILT_HOMING", "homing"})
CERBERUS_DEFINE_MESSAGE(CerberusPantilt, pantilt, CERBERUS_MESSAGE_PANTILT)
