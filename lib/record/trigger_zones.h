// SPDX-License-Identifier: LGPL-2.1-or-later
// Where an object begins an event: whether single points lie in the polygons of vision::Zones.
#pragma once

#include <string>
#include <string_view>

#include "vision/geometry/box.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/zones/zones.h"

namespace cerberus::record {

class TriggerZones {
 public:
  // Replaces the polygons; the syntax is that of vision::Zones. Returns what is wrong and keeps the polygons of before;
  // an empty string: nothing. An empty `text` means: everywhere.
  std::string parse(std::string_view text);

  // Whether an object triggers whose box, in pixels of a frame of size `frame`, stands in a zone: the middle of its
  // lower edge counts, where a person's feet are. An unknown size of the frame (0) counts as inside, and so does every
  // polygon of the world, those of the word exclude excepted, where the camera's orientation is not known.
  bool contains(const vision::Box& box, vision::Size frame,
                const std::optional<vision::CameraOrientation>& camera = {}) const;

  // Some polygon is of the world.
  bool need_orientation() const { return zones_.need_orientation(); }

 private:
  vision::Zones zones_;
};

}  // namespace cerberus::record
