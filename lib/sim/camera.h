// SPDX-License-Identifier: LGPL-2.1-or-later
// What a camera and a detector make of one person: whether it is in the picture, and its box with noise. Radians and
// seconds; only the horizontal angle.
#pragma once

#include <random>

#include "motion/head_limits.h"

namespace cerberus::sim {

using motion::Time;

struct CameraTraits {
  double frames = 25;                           // a second
  double delay = .06;                           // seconds from the exposure until the law has the box
  double field_of_view = sensing::radians(60);  // over the width
  double edge = sensing::radians(1);            // nearer to the edge the person is not found
  double box_noise = sensing::radians(1);       // standard deviation of the box's middle
  double wander = 0;                            // seconds: time constant of the box's noise; 0: white
  double turn_noise = sensing::radians(.03);    // standard deviation of the measured turn of the picture
};

struct Picture {
  Time taken{};
  bool seen = false;
  double field_of_view = 0;  // over the width, then
  double off = 0;            // of the box's middle from the optical axis, to the right
  double turn = 0;           // of the picture since the one before, as measured
};

class Camera {
 public:
  Camera(const CameraTraits& traits, unsigned seed) : traits_(traits), random_(seed) {}
  const CameraTraits& traits() const { return traits_; }
  // The zoom has changed: the box's noise and the edge stay the same in pixels.
  void look_through(double field_of_view);
  // When the next picture is due.
  Time next() const { return next_; }
  // Takes it. off: of the person from the optical axis; direction: of the camera in the world.
  Picture take(Time now, double off, double direction, bool there);

 private:
  CameraTraits traits_;
  std::mt19937 random_;
  std::normal_distribution<> gauss_;
  long taken_ = 0;
  Time next_{};
  double noise_ = 0, direction_ = 0;
};

}  // namespace cerberus::sim
