// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/fusion.h>

#include <algorithm>
#include <cmath>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kFields[] = {
    {"rule", Type::integer, offsetof(CerberusFusion, rule)},
    {"rule-name", Type::word, offsetof(CerberusFusion, rule_name)},
    {"action", Type::choice, offsetof(CerberusFusion, action), cerberus_fusion_action_get_type},
    {"target", Type::count, offsetof(CerberusFusion, target)},
    {"pan", Type::number, offsetof(CerberusFusion, pan)},
    {"sector-from", Type::number, offsetof(CerberusFusion, sector_from)},
    {"sector-to", Type::number, offsetof(CerberusFusion, sector_to)},
    {"limited", Type::flag, offsetof(CerberusFusion, limited)},
    {"camera-found", Type::flag, offsetof(CerberusFusion, camera_found)},
    {"doubtful", Type::count, offsetof(CerberusFusion, doubtful)},
    {"decided", Type::time, offsetof(CerberusFusion, decided)},
    {"head", Type::word, offsetof(CerberusFusion, head)},
};
constexpr cerberus::Field kImmediate[] = {{"immediate", Type::flag, offsetof(CerberusFusion, immediate)}};

void hold(CerberusFusion& fusion) {
  fusion.rule_name = g_intern_static_string("none");
  fusion.action = CERBERUS_FUSION_HOLD;
  fusion.pan = fusion.sector_from = fusion.sector_to = NAN;
  fusion.decided = GST_CLOCK_TIME_NONE;
}

CerberusFusion sane(CerberusFusion fusion) {
  if (!cerberus::is_one_of(CERBERUS_TYPE_FUSION_ACTION, &fusion.action)) fusion.action = CERBERUS_FUSION_HOLD;
  if (!fusion.rule_name) fusion.rule_name = g_intern_static_string("none");
  cerberus::tidy_sensors(fusion.n_sensors, fusion.sensors, fusion.bearings);
  return fusion;
}

void write(GstStructure* to, const CerberusFusion& fusion) {
  const CerberusFusion written = sane(fusion);
  cerberus::write_fields(to, kFields, &written);
  cerberus::write_fields(to, kImmediate, &written);
  cerberus::write_sensors(to, written.n_sensors, written.sensors, written.bearings);
}

bool read(const GstStructure* from, CerberusFusion& fusion) {
  if (!cerberus::read_fields(from, kFields, &fusion)) return false;
  cerberus::read_known_fields(from, kImmediate, &fusion);
  cerberus_fusion_set_head(&fusion, fusion.head);
  return cerberus::read_sensors(from, fusion.n_sensors, fusion.sensors, fusion.bearings);
}

bool is_complete(const CerberusFusion& fusion) {
  return GST_CLOCK_TIME_IS_VALID(fusion.decided);
}

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusFusion& f) {
  archive(f.rule, f.rule_name, f.action, f.target, f.pan, f.sector_from, f.sector_to, f.limited,
          f.camera_found, f.n_sensors, f.sensors, f.bearings, f.doubtful,
          cerberus::publish::Moment{f.decided}, f.head, f.immediate);
  f = sane(f);
}

CERBERUS_DEFINE_BOXED(CerberusFusion, cerberus_fusion, hold)
CERBERUS_DEFINE_ENUM(CerberusFusionAction, cerberus_fusion_action,
                     {CERBERUS_FUSION_TRACK, "CERBERUS_FUSION_TRACK", "track"},
                     {CERBERUS_FUSION_TURN_LEFT, "CERBERUS_FUSION_TURN_LEFT", "turn-left"},
                     {CERBERUS_FUSION_TURN_RIGHT, "CERBERUS_FUSION_TURN_RIGHT", "turn-right"},
                     {CERBERUS_FUSION_SEARCH, "CERBERUS_FUSION_SEARCH", "search"},
                     {CERBERUS_FUSION_ZERO, "CERBERUS_FUSION_ZERO", "zero"},
                     {CERBERUS_FUSION_HOLD, "CERBERUS_FUSION_HOLD", "hold"})
CERBERUS_DEFINE_META(CerberusFusion, fusion, sane, nullptr)
CERBERUS_DEFINE_MESSAGE(CerberusFusion, fusion, CERBERUS_MESSAGE_FUSION)
CERBERUS_DEFINE_EVENT(CerberusFusion, fusion, CERBERUS_EVENT_FUSION, GST_EVENT_CUSTOM_DOWNSTREAM_OOB,
                      is_complete)

void cerberus_fusion_set_head(CerberusFusion* fusion, const gchar* head) {
  g_return_if_fail(fusion);
  fusion->head = head && *head ? g_intern_string(head) : nullptr;
}

GBytes* cerberus_fusion_get_sensors(const CerberusFusion* fusion) {
  g_return_val_if_fail(fusion, nullptr);
  return g_bytes_new(fusion->sensors, std::min<guint>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS));
}
