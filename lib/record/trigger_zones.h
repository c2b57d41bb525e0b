// SPDX-License-Identifier: LGPL-2.1-or-later
// Where an object begins an event: the polygons of vision::Zones, asked for single points.
#pragma once

#include <string>
#include <string_view>

#include "vision/detection/zones.h"
#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::record {

class TriggerZones {
 public:
  // Replaces the polygons; the syntax is that of vision::Zones. Returns what is wrong and keeps the polygons of before;
  // an empty string: nothing. An empty `text` means: everywhere.
  std::string parse(std::string_view text);

  // Whether an object triggers whose box, in pixels of a frame of size `frame`, stands in a zone: the middle of its
  // lower edge counts, where a person's feet are. An unknown size of the frame (0) counts as inside.
  bool contains(const vision::Box& box, vision::Size frame) const;

 private:
  vision::Zones zones_;
  vision::Image<std::uint8_t> plane_;  // 255 where it triggers, for fractions of the picture
};

}  // namespace cerberus::record
