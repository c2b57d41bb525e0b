// SPDX-License-Identifier: LGPL-2.1-or-later
// The zoom of a head that keeps its target's size (zoom_keeper.h): from the tracks of a frame to the position to order.
#pragma once

#include <optional>
#include <span>

#include "control/following/zoom_keeper.h"
#include "control/law.h"
#include "fusion/fuser.h"
#include "motion/zoom_table.h"

namespace cerberus::control {

class ZoomControl {
 public:
  // Of a head that is opened. An empty table: its zoom is left alone.
  void begin(const motion::ZoomTable& table) {
    table_ = table;
    keeper_.reset();
  }

  // taken: of the frame, seconds. picture: its size, in which the tracks' boxes are. field_of_view: when it was taken, as in
  // motion::Pose. Returns the position for HeadCommand::zoom. A target that is only predicted is not seen.
  std::optional<double> on_frame(double taken, const Goal& goal, std::span<const fusion::Track> tracks,
                                 const vision::Size& picture, double field_of_view);

 private:
  motion::ZoomTable table_;
  ZoomKeeper keeper_;
  std::uint32_t track_ = 0;  // the last target
};

}  // namespace cerberus::control
