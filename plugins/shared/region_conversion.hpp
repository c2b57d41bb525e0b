// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions and tracks of lib as those of the C API, and back.
#pragma once

#include <cerberus/cerberus.h>

#include <vector>

#include "sensing/angles.h"
#include "shared/clock_times.hpp"
#include "vision/tracking/tracker.h"

namespace cerberus::plugin {

static_assert(static_cast<int>(vision::TrackState::coasted) == CERBERUS_REGION_COASTED &&
              static_cast<int>(vision::TrackState::stopped) == CERBERUS_REGION_STOPPED &&
              static_cast<int>(vision::RegionKind::thing) == CERBERUS_REGION_KIND_THING);

// What region and track have in common.
template <typename Found>
CerberusRegion region_of(const Found& found) {
  CerberusRegion out;
  cerberus_region_init(&out);
  out.kind = static_cast<CerberusRegionKind>(found.kind);
  out.x = found.box.x;
  out.y = found.box.y;
  out.width = found.box.width;
  out.height = found.box.height;
  out.confidence = found.confidence;
  return out;
}

inline CerberusRegion tracked(const vision::Track& track) {
  CerberusRegion out = region_of(track);
  out.id = track.id;
  out.tracked = TRUE;
  out.vx = track.vx;
  out.vy = track.vy;
  out.age = clock_time(track.age);
  out.state = static_cast<CerberusRegionState>(track.state);
  out.motion = track.motion, out.person = track.person;
  out.bearing = sensing::degrees(track.bearing);
  out.distance = track.distance;
  return out;
}

// Of a vector that outlives the array.
inline GPtrArray* array_of(std::vector<CerberusRegion>& regions) {
  GPtrArray* array = g_ptr_array_sized_new(static_cast<guint>(regions.size()));
  for (CerberusRegion& region : regions) g_ptr_array_add(array, &region);
  return array;
}

inline vision::Track track_of(const CerberusRegion& region) {
  vision::Track track;
  track.id = region.id;
  track.box = {region.x, region.y, region.width, region.height};
  track.vx = region.vx;
  track.vy = region.vy;
  track.age = static_cast<double>(region.age) / GST_SECOND;
  track.confidence = region.confidence;
  track.state = static_cast<vision::TrackState>(region.state);
  track.motion = region.motion, track.person = region.person;
  track.kind = static_cast<vision::RegionKind>(region.kind);
  track.bearing = sensing::radians(region.bearing);
  track.distance = region.distance;
  return track;
}

}  // namespace cerberus::plugin
