// SPDX-License-Identifier: LGPL-2.1-or-later
// Monitors what carries the camera: a head, by its published poses, and the base below it. Attaches the head's pose and
// the base's yaw rate to each frame, and posts what lib's comparison of head and picture finds.
#pragma once

#include <cerberus/cerberus.h>

#include <mutex>
#include <optional>
#include <string>

#include "control/head_comparison.h"
#include "frame.hpp"
#include "sensing/base_rates.h"
#include "shared/pose_thread.hpp"

namespace cerberus::plugin {

class HeadMotionMonitor {
 public:
  // Clears all state, poses and rates too.
  void forget();
  // Begins the comparison anew, for another lens or another head.
  void begin_comparison() { comparison_.forget_faults(); }

  // Processes an upstream event, from any thread. `head`: the head whose poses are used, empty: any.
  void hear(GstEvent* event, const std::string& head);

  // Call look() and then compare() for each frame, in the streaming thread. Takes the head's pose from the frame or,
  // without one, from the events, and attaches it to the frame. Returns the motion of the picture since the previous
  // frame that follows from the poses, frame pixels. field_of_view: radians, of a frame whose pose does not say it.
  std::optional<vision::Transform> look(GstElement* element, Frame& frame, const std::string& head,
                                        double field_of_view);
  // `motion`: measured since the previous frame, frame pixels, with its confidence. Attaches the base's yaw rate to the
  // frame if it is known, and posts a warning of `element` if the head does not execute its commands.
  void compare(GstElement* element, Frame& frame, double field_of_view, const vision::Transform& motion,
               double confidence);
  // Attaches pose and base to a frame that repeats the last picture. The pose is the one of that picture, at rest: the
  // pixels of the frame were taken with it, wherever the head has turned since.
  void repeat(Frame& frame);

 private:
  control::HeadComparison::Head head_of(GstElement* element, Frame& frame, const std::string& head);
  void attach_base(Frame& frame, double measured);

  control::HeadComparison comparison_;
  std::optional<CerberusPose> pose_;  // of the last picture, at rest
  bool holds_ = false;                // pose_ had not expired at that picture

  PoseThread pose_thread_;
  std::mutex lock_;  // of the members below
  sensing::Timeline<CerberusPose> poses_;
  sensing::BaseRates told_base_;
};

}  // namespace cerberus::plugin
