// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/trigger_zones.h"

#include <algorithm>

namespace cerberus::record {

std::string TriggerZones::parse(std::string_view text) {
  return zones_.parse(text);
}

bool TriggerZones::contains(const vision::Box& box, vision::Size frame,
                            const std::optional<vision::CameraOrientation>& camera) const {
  if (zones_.everywhere() || frame.width <= 0 || frame.height <= 0) return true;
  // Inside the frame, so that feet beyond its edge stand at the edge.
  const auto place = [](double at, int extent) { return std::clamp(at, 0.5, extent - 0.5); };
  const vision::Point feet{place(box.x + box.width / 2, frame.width), place(box.bottom(), frame.height)};
  return zones_.contain(feet, frame, camera);
}

}  // namespace cerberus::record
