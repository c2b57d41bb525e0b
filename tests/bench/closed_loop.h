// SPDX-License-Identifier: LGPL-2.1-or-later
// A person, a camera, a head and a law that follows, in their own time: lib/sim around a law of this project or of a
// peer. Radians and seconds. Steps of 1 ms.
#pragma once

#include <deque>

#include "sim/camera.h"
#include "sim/head_kinds.h"
#include "sim/scenes.h"
#include "sim/score.h"
#include "sim/zoom_lens.h"

namespace cerberus::bench {

using motion::Time;

// A picture as a law gets it.
struct Seen {
  sim::Picture picture;
  double base_turn = 0;  // since the picture before, as reported
  double base_yaw = 0;   // the same as a sum
  bool base_reported = false;
  double height = 0;    // of the box, of the picture's height; 0: of no account
  bool sector = false;  // a sensor's sector says where the person is: at `bearing` from the base
  double bearing = 0;
};

class FollowingLaw {
 public:
  virtual ~FollowingLaw() = default;
  virtual void on_picture(const Seen& seen, Time now) = 0;
  virtual void elapse(Time now) = 0;
  // Where the law believes that the camera looked at a time, from the base; peers do not say.
  virtual double look(Time) { return 0; }
  // The yaw rate for which it asks the base now.
  virtual double asks_base() { return 0; }
};

// lens: of a camera with a zoom, which the law drives.
sim::Score run(FollowingLaw& law, sim::PanHead& head, const sim::Scene& scene, sim::CameraTraits camera,
               unsigned seed, sim::ZoomLens* lens = nullptr);

}  // namespace cerberus::bench
