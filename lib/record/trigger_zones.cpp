// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/trigger_zones.h"

#include <algorithm>

namespace cerberus::record {

namespace {
// Cells of the plane a side. Derived: a thousandth of the picture is less than a track's own uncertainty.
constexpr int kCells = 1024;
}  // namespace

std::string TriggerZones::parse(std::string_view text) {
  std::string fault = zones_.parse(text);
  if (!fault.empty() || zones_.everywhere()) return fault;
  plane_.resize({kCells, kCells});
  zones_.draw(plane_.view());
  return fault;
}

bool TriggerZones::contains(const vision::Box& box, vision::Size frame) const {
  if (zones_.everywhere() || frame.width <= 0 || frame.height <= 0) return true;
  const auto cell = [](double place, int extent) {
    return static_cast<int>(std::clamp(place / extent * kCells, 0.0, static_cast<double>(kCells - 1)));
  };
  return plane_.view().at(cell(box.x + box.width / 2, frame.width), cell(box.bottom(), frame.height)) != 0;
}

}  // namespace cerberus::record
