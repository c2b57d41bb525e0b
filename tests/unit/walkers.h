// SPDX-License-Identifier: LGPL-2.1-or-later
// People whose true paths are known, as regions, and their tracks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "vision/tracking/tracker.h"

namespace cerberus::tests {

inline constexpr vision::Size kFrame{640, 480};

// A person, 100 pixels tall by default.
inline vision::Region person(double x, double y, double confidence = 0.9, double width = 40,
                             double height = 100) {
  return {{x - width / 2, y - height / 2, width, height},
          width * height / 2,
          confidence,
          1,
          confidence < 0.5 ? vision::RegionKind::group : vision::RegionKind::person_like};
}

inline const vision::Track* with_id(std::span<const vision::Track> tracks, std::uint32_t id) {
  const auto it =
      std::find_if(tracks.begin(), tracks.end(), [&](const vision::Track& t) { return t.id == id; });
  return it == tracks.end() ? nullptr : &*it;
}

inline vision::Point centre(const vision::Track& t) {
  return {t.box.x + t.box.width / 2, t.box.y + t.box.height / 2};
}

}  // namespace cerberus::tests
