// SPDX-License-Identifier: LGPL-2.1-or-later
// Where motion counts, on its way from the element with the property `zones` to those downstream that publish persons: a
// private meta on the frames.
#pragma once

#include <gst/gst.h>

#include <memory>
#include <optional>

#include "vision/geometry/box.h"
#include "vision/zones/zones.h"

namespace cerberus::plugin {

struct FrameZones {
  std::shared_ptr<const vision::Zones> zones;  // nullptr: everywhere
  double field_of_view = 0;  // horizontal, radians, of a frame whose pose gives none; 0: not known
};

// Attaches them in place of those that are there; `buffer` is writable. They follow the picture through copying, converting
// and scaling, and are lost where it is cropped; they do not leave the process.
void set_frame_zones(GstBuffer* buffer, const FrameZones& zones);

// Which boxes of one frame count, by their middle. Made while no other thread changes the buffer's metas.
class ZonesOfFrame {
 public:
  ZonesOfFrame() = default;  // all
  // running_time: of the frame, for the head's pose on it. size: pixels of the boxes.
  ZonesOfFrame(GstBuffer* buffer, GstClockTime running_time, vision::Size size);
  bool contain(const vision::Box& box) const;

 private:
  std::shared_ptr<const vision::Zones> zones_;
  std::optional<vision::CameraOrientation> camera_;
  vision::Size size_;
};

}  // namespace cerberus::plugin
