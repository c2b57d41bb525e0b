// SPDX-License-Identifier: LGPL-2.1-or-later
#include "triggers.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <cmath>

#include "shared/camera_mount.hpp"

namespace cerberus::plugin {

namespace {

// Readings of 1 that are not doubtful: the sensor's own turning causes those.
bool is_motion(const guint8* sensors, guint count, guint doubtful) {
  for (guint k = 0; k < std::min<guint>(count, CERBERUS_PIR_MAX_SENSORS); ++k)
    if (sensors[k] == 1 && !(doubtful >> k & 1)) return true;
  return false;
}

std::optional<Trigger> trigger_of(const CerberusFusion& fusion, const TriggerSettings& settings) {
  const bool acts = fusion.action != CERBERUS_FUSION_ZERO && fusion.action != CERBERUS_FUSION_HOLD;
  if (settings.fusion && acts)
    return Trigger{Trigger::Kind::moment,
                   std::string("fusion ") + cerberus_fusion_action_get_nick(fusion.action)};
  if (settings.pir && is_motion(fusion.sensors, fusion.n_sensors, fusion.doubtful))
    return Trigger{Trigger::Kind::moment, "pir"};
  return std::nullopt;
}

bool stands_in_zone(const CerberusRegion& region, const TriggerSettings& settings) {
  return settings.zones.contains({region.x, region.y, region.width, region.height}, settings.frame,
                                 settings.camera);
}

std::optional<Trigger> track_trigger(GstBuffer* buffer, const TriggerSettings& settings) {
  if (!cerberus_buffer_regions_known(buffer)) return std::nullopt;
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  std::optional<Trigger> found;
  for (guint k = 0; k < regions->len; ++k) {
    const auto* region = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, k));
    if (!region->tracked || !stands_in_zone(*region, settings)) continue;
    if (region->state != CERBERUS_REGION_STOPPED)
      return Trigger{Trigger::Kind::moment, "track " + std::to_string(region->id)};
    found = Trigger{Trigger::Kind::carry_on, "track " + std::to_string(region->id)};
  }
  return found;
}

}  // namespace

std::optional<vision::CameraOrientation> camera_of(GstBuffer* buffer, GstClockTime running_time,
                                                   vision::Size frame, double field_of_view) {
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  const auto look = pose ? look_of(*pose, running_time) : std::nullopt;
  if (!look) return std::nullopt;
  const double reported = field_of_view_of(*pose);
  const vision::Lens lens(reported > 0 ? reported : radians(field_of_view), frame);
  if (!lens.known() || std::isnan(reported)) return std::nullopt;
  return vision::CameraOrientation{lens, look->pan, look->tilt};
}

std::optional<Trigger> trigger_of(GstBuffer* buffer, const TriggerSettings& settings) {
  std::optional<Trigger> found;
  if (settings.track) found = track_trigger(buffer, settings);
  if (found && found->kind == Trigger::Kind::moment) return found;
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer))
    if (auto decided = trigger_of(*fusion, settings)) return decided;
  return found;
}

std::optional<Trigger> trigger_of(GstMessage* message, const TriggerSettings& settings, GstClockTime& time) {
  time = GST_CLOCK_TIME_NONE;
  if (g_autoptr(CerberusStamp) stamp = cerberus_message_parse_stamp(message)) time = stamp->running_time;
  if (g_autoptr(CerberusMotion) motion = cerberus_message_parse_motion(message))
    return motion->state == CERBERUS_MOTION_STARTED ? Trigger{Trigger::Kind::hold, "motion"}
                                                    : Trigger{Trigger::Kind::release, "motion"};
  if (g_autoptr(CerberusTrack) track = cerberus_message_parse_track(message)) {
    if (!settings.track || track->state == CERBERUS_TRACK_LEFT || !stands_in_zone(track->region, settings))
      return std::nullopt;
    const bool stands = track->region.state == CERBERUS_REGION_STOPPED;
    return Trigger{stands ? Trigger::Kind::carry_on : Trigger::Kind::moment,
                   "track " + std::to_string(track->region.id)};
  }
  if (g_autoptr(CerberusFusion) fusion = cerberus_message_parse_fusion(message))
    return trigger_of(*fusion, settings);
  if (g_autoptr(CerberusPir) pir = cerberus_message_parse_pir(message))
    if (settings.pir && is_motion(pir->sensors, pir->n_sensors, pir->doubtful))
      return Trigger{Trigger::Kind::moment, "pir"};
  return std::nullopt;
}

std::optional<Trigger> trigger_of(GstEvent* event, const TriggerSettings& settings) {
  if (!cerberus_event_is_fusion(event)) return std::nullopt;
  g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event);
  return fusion ? trigger_of(*fusion, settings) : std::nullopt;
}

}  // namespace cerberus::plugin
