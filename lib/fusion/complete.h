// SPDX-License-Identifier: LGPL-2.1-or-later
// The rule set that is computed from the directions of the sensors, the lens's field of view and the head's stops, for
// any number of sensors and without open cases. Radians; pan angles lie on a line and do not wrap.
#pragma once

#include <array>

#include "fusion/rules.h"
#include "sensing/angles.h"
#include "sensing/sectors.h"

namespace cerberus::fusion {

using sensing::Geometry;
using sensing::Interval;

// Default pan limits: +-170 degrees.
constexpr Interval kDefaultLimits{sensing::radians(-170), sensing::radians(170)};

// A place to search: turn until pan is within `wanted`, then sweep `sweep` (never wider than `wanted`).
struct Place {
  Interval wanted;
  Interval sweep;
  SensorBits sensors = 0;  // the sensors whose detections give this place
  bool limited = false;    // because of the stops the picture cannot cover all of it
};
constexpr int kMaxPlaces = 40;  // two for each of 16 sensors, and some that they share; more are dropped
using Places = sensing::FixedList<Place, kMaxPlaces>;

// Returns the places to search when the sensors `fired` detect and the head is at `pan`, best first; empty without a
// sensor.
//   1 the intervals that all of them cover together, nearest to the head first
//   2 each fired sector, nearest to the head first; equally near: the one of the higher `order` (the later it fired),
//     then the lower number
// Within each of the two, reachable places precede unreachable ones. Each is cut to the limits; a sector cut in two by
// the stops gives two places; one out of reach becomes the nearest limit. The sweep is the place with its edges moved
// in by half a field of view, where the picture's border meets the edge; of a place narrower than that, its middle.
// fired: sensors beyond the geometry's count are ignored. lens: the camera's horizontal field of view, [0, pi).
Places places(const Geometry& geometry, SensorBits fired, double pan,
              const std::array<int, kMaxSensors>& order, double lens, const Interval& limits);

// Returns turn_left, turn_right, or search when pan is within the place. `inside`: whether pan was within the place at
// the last call; it then counts as outside only beyond `hysteresis`. A place narrower than twice the hysteresis (a
// stop, a border) is reached at a distance of hysteresis. The limits are not crossed, because places lie inside them.
Action approach(const Place& place, double pan, bool inside, double hysteresis);

}  // namespace cerberus::fusion
