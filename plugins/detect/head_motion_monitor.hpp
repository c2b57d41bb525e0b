// SPDX-License-Identifier: LGPL-2.1-or-later
// Monitors what carries the camera: a head, by its published poses, and the base below it. Attaches the head's pose and
// the base's yaw rate to each frame, and compares the commanded turn of the head with the turn of the picture.
#pragma once

#include <cerberus/cerberus.h>

#include <mutex>
#include <optional>
#include <string>

#include "control/base_rate.h"
#include "control/slip.h"
#include "frame.hpp"
#include "sensing/base_rates.h"
#include "shared/pose_thread.hpp"

namespace cerberus::plugin {

class HeadMotionMonitor {
 public:
  // Clears all state, poses and rates too.
  void forget();
  // Begins the comparison anew, for another lens or another head.
  void begin_comparison();

  // Processes an upstream event, from any thread. `head`: the head whose poses are used, empty: any.
  void hear(GstEvent* event, const std::string& head);

  // Call look() and then compare() for each frame, in the streaming thread.
  // Takes the head's pose from the frame or, without one, from the events, and attaches it to the frame. Returns the
  // motion of the picture since the previous frame that follows from the poses, frame pixels.
  std::optional<vision::Transform> look(GstElement* element, Frame& frame, const std::string& head,
                                        const vision::Lens& lens);
  // `motion`: measured since the previous frame, frame pixels, with its confidence. Attaches the base's yaw rate to the
  // frame if it is known, and posts a warning of `element` if the head does not execute its commands.
  void compare(GstElement* element, Frame& frame, const vision::Lens& lens, const vision::Transform& motion,
               double confidence);

 private:
  // The head when a frame was taken; no look: unknown.
  struct Head {
    std::optional<motion::PanTilt> look;
    const gchar* name = nullptr;  // interned
    bool commanded = false;  // from a pose event; else attached by the source of the frame, which is exact
  };
  Head head_of(GstElement* element, Frame& frame, const std::string& head);
  void tell_base(Frame& frame, double seen);

  Head before_, now_;
  control::BaseRate base_;
  control::SlipWatch pan_, tilt_;

  PoseThread pose_thread_;
  std::mutex lock_;  // of the members below
  sensing::Timeline<CerberusPose> poses_;
  sensing::BaseRates told_base_;
};

}  // namespace cerberus::plugin
