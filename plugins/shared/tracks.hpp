// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads the tracks on a frame as those of lib/fusion, for elements that decide by frames.
#pragma once

#include <cerberus/cerberus.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "clock_times.hpp"
#include "fusion/fuser.h"

namespace cerberus::plugin {

static_assert(static_cast<int>(fusion::TrackState::seen) == CERBERUS_REGION_SEEN &&
              static_cast<int>(fusion::TrackState::coasted) == CERBERUS_REGION_COASTED &&
              static_cast<int>(fusion::TrackState::stopped) == CERBERUS_REGION_STOPPED);

// The regions on `buffer` that are tracks, in place of what `tracks` held.
inline void read_tracks(GstBuffer* buffer, std::vector<fusion::Track>& tracks) {
  tracks.clear();
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i) {
    const auto& region = *static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    if (!region.tracked || region.id == 0) continue;
    tracks.push_back({.id = region.id,
                      .x = region.x,
                      .y = region.y,
                      .width = region.width,
                      .height = region.height,
                      .distance = region.distance,
                      .age = time_of(region.age),
                      .state = static_cast<fusion::TrackState>(region.state),
                      .person = region.person != FALSE});
  }
}

}  // namespace cerberus::plugin
