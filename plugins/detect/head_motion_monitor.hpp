// SPDX-License-Identifier: LGPL-2.1-or-later
// What carries the camera: a head, as far as its poses are told, and below it a body. Puts on each frame where the head
// looked and how fast the body turned, and compares what the head was told with what the picture shows.
#pragma once

#include <cerberus/cerberus.h>

#include <mutex>
#include <optional>
#include <string>

#include "control/base_rate.h"
#include "control/slip.h"
#include "sensing/base_rates.h"
#include "shared/frame.hpp"
#include "shared/pose_thread.hpp"

namespace cerberus::plugin {

class HeadMotionMonitor {
 public:
  // Everything, poses and rates too.
  void forget();
  // Another lens, another head: what was compared so far says nothing.
  void begin_comparison();

  // An event that travels upstream, from any thread. `head`: whose poses count, empty: any.
  void hear(GstEvent* event, const std::string& head);

  // For each frame look() and then compare(), in the streaming thread.
  // Where the head looked, from the frame's own pose, else by what was heard; that is put on the frame. Returns where
  // the picture went since the previous frame as far as the head says, frame pixels.
  std::optional<vision::Transform> look(GstElement* element, Frame& frame, const std::string& head,
                                        const vision::Lens& lens);
  // `motion` since the previous frame, frame pixels, and how sure it is. Puts the body's turning on the frame where it
  // is known, and warns in the name of `element` of a head that does not do what it was told.
  void compare(GstElement* element, Frame& frame, const vision::Lens& lens, const vision::Transform& motion,
               double confidence);

 private:
  // The head when a frame was taken; no look: nobody told.
  struct Head {
    std::optional<motion::PanTilt> look;
    const gchar* name = nullptr;  // interned
    bool commanded = false;       // it was heard; else who made the frame attached it, and knows
  };
  Head head_of(GstElement* element, Frame& frame, const std::string& head);
  void tell_base(Frame& frame, double seen);

  Head before_, now_;
  control::BaseRate base_;
  control::SlipWatch pan_, tilt_;

  PoseThread pose_thread_;
  std::mutex lock_;  // of what was told
  sensing::Timeline<CerberusPose> poses_;
  sensing::BaseRates told_base_;
};

}  // namespace cerberus::plugin
