// SPDX-License-Identifier: LGPL-2.1-or-later
// The states of a track, and what is known in each of them. life_cycle.h has the transitions and their rules,
// docs/design/track-states.md a drawing.
#pragma once

#include <variant>

#include "vision/geometry/camera_orientation.h"

namespace cerberus::vision {

// In the order of TrackLife's alternatives.
enum class TrackPhase { tentative, confirmed, coasted, stopped, off_screen, lost };

// Not confirmed yet: it has no identity and is not published.
struct Tentative {
  int hits = 1, frames = 1;    // frames with a region, frames in all
  bool newly_visible = false;  // first seen where the camera had just begun to look
};
// With a region in the last frame.
struct Confirmed {};
// Without one, carried on along its velocity.
struct Coasted {};
// Without one, at the place where it ceased to move.
struct Stopped {
  double absent = 0;  // s for which the place has looked otherwise
};
// The camera turned away from it: it is kept by bearing and elevation, unpublished.
struct OffScreen {
  Direction direction;
  double magnification = 1;  // CameraOrientation::magnification() there
  bool in_front = true;      // of the camera: the position in pixels is valid
  bool stopped = false;      // it was when the camera turned away
  double absent = 0;         // s for which it was expected in the picture and not found
};
// Ended; the tracker removes it.
struct Lost {};

using TrackLife = std::variant<Tentative, Confirmed, Coasted, Stopped, OffScreen, Lost>;

inline TrackPhase phase_of(const TrackLife& life) {
  return static_cast<TrackPhase>(life.index());
}

}  // namespace cerberus::vision
