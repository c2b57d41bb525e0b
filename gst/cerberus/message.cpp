// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/message.h>

#include "cerberus/private/define.hpp"

namespace {

using Type = cerberus::Field::Type;
constexpr cerberus::Field kMotionFields[] = {
    {"state", Type::nick, offsetof(CerberusMotion, state), cerberus_motion_state_get_type},
};
constexpr cerberus::Field kTrackFields[] = {
    {"state", Type::nick, offsetof(CerberusTrack, state), cerberus_track_state_get_type},
    {"first", Type::time, offsetof(CerberusTrack, first)},
    {"last", Type::time, offsetof(CerberusTrack, last)},
};

GPtrArray* copies(const GPtrArray* regions) {
  GPtrArray* all = g_ptr_array_new_with_free_func(reinterpret_cast<GDestroyNotify>(cerberus_region_free));
  for (guint i = 0; regions && i < regions->len; ++i)
    g_ptr_array_add(all, cerberus_region_copy(static_cast<CerberusRegion*>(g_ptr_array_index(regions, i))));
  return all;
}

void own(CerberusMotion& motion) {
  motion.regions = copies(motion.regions);
}
void release(CerberusMotion& motion) {
  if (motion.regions) g_ptr_array_unref(motion.regions);
}

void write(GstStructure* to, const CerberusMotion& motion) {
  cerberus::write_fields(to, kMotionFields, &motion);
  GValue list = G_VALUE_INIT;
  g_value_init(&list, GST_TYPE_LIST);
  for (guint i = 0; motion.regions && i < motion.regions->len; ++i) {
    GValue value = G_VALUE_INIT;
    g_value_init(&value, GST_TYPE_STRUCTURE);
    g_value_take_boxed(&value, cerberus_region_to_structure(
                                   static_cast<CerberusRegion*>(g_ptr_array_index(motion.regions, i))));
    gst_value_list_append_and_take_value(&list, &value);
  }
  gst_structure_take_value(to, "objects", &list);
}

bool read(const GstStructure* from, CerberusMotion& motion) {
  const GValue* list = gst_structure_get_value(from, "objects");
  if (!list || !GST_VALUE_HOLDS_LIST(list) || !cerberus::read_fields(from, kMotionFields, &motion))
    return false;
  motion.regions = copies(nullptr);
  for (guint i = 0; i < gst_value_list_get_size(list); ++i) {
    const GValue* value = gst_value_list_get_value(list, i);
    CerberusRegion* region = GST_VALUE_HOLDS_STRUCTURE(value)
                                 ? cerberus_region_from_structure(gst_value_get_structure(value))
                                 : nullptr;
    if (region) g_ptr_array_add(motion.regions, region);
  }
  return true;
}

void appeared(CerberusTrack& track) {
  cerberus_region_init(&track.region);
  track.first = track.last = GST_CLOCK_TIME_NONE;
}

void write(GstStructure* to, const CerberusTrack& track) {
  cerberus::write_fields(to, kTrackFields, &track);
  g_autoptr(GstStructure) object = cerberus_region_to_structure(&track.region);
  gst_structure_set(to, "object", GST_TYPE_STRUCTURE, object, nullptr);
}

bool read(const GstStructure* from, CerberusTrack& track) {
  const GValue* object = gst_structure_get_value(from, "object");
  if (!object || !GST_VALUE_HOLDS_STRUCTURE(object)) return false;
  g_autoptr(CerberusRegion) region = cerberus_region_from_structure(gst_value_get_structure(object));
  if (!region) return false;
  track.region = *region;
  return cerberus::read_fields(from, kTrackFields, &track);
}

}  // namespace

CERBERUS_DEFINE_OWNING_BOXED(CerberusMotion, cerberus_motion, cerberus::zero, own, release)
CERBERUS_DEFINE_ENUM(CerberusMotionState, cerberus_motion_state,
                     {CERBERUS_MOTION_STARTED, "CERBERUS_MOTION_STARTED", "started"},
                     {CERBERUS_MOTION_ENDED, "CERBERUS_MOTION_ENDED", "ended"})
CERBERUS_DEFINE_MESSAGE(CerberusMotion, motion, CERBERUS_MESSAGE_MOTION)

CERBERUS_DEFINE_BOXED(CerberusTrack, cerberus_track, appeared)
CERBERUS_DEFINE_ENUM(CerberusTrackState, cerberus_track_state,
                     {CERBERUS_TRACK_APPEARED, "CERBERUS_TRACK_APPEARED", "appeared"},
                     {CERBERUS_TRACK_UPDATED, "CERBERUS_TRACK_UPDATED", "updated"},
                     {CERBERUS_TRACK_LEFT, "CERBERUS_TRACK_LEFT", "left"})
CERBERUS_DEFINE_MESSAGE(CerberusTrack, track, CERBERUS_MESSAGE_TRACK)

void cerberus_motion_add_region(CerberusMotion* motion, const CerberusRegion* region) {
  g_return_if_fail(motion);
  g_return_if_fail(region);
  if (!motion->regions) motion->regions = copies(nullptr);
  g_ptr_array_add(motion->regions, cerberus_region_copy(region));
}

GPtrArray* cerberus_motion_get_regions(const CerberusMotion* motion) {
  g_return_val_if_fail(motion, nullptr);
  return copies(motion->regions);
}
