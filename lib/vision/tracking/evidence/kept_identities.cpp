// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/evidence/kept_identities.h"

#include <algorithm>

namespace cerberus::vision {

void keep_identities(std::span<const Track> before, std::span<Track> now, std::uint32_t& last) {
  for (Track& track : now) {
    if (track.id != 0) continue;
    double best = 0.3;
    for (const Track& each : before) {
      const double shared = intersection_over_union(each.box, track.box);
      if (shared > best && std::ranges::find(now, each.id, &Track::id) == now.end())
        best = shared, track.id = each.id;
    }
    if (track.id == 0) track.id = ++last;
  }
}

}  // namespace cerberus::vision
