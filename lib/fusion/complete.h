// SPDX-License-Identifier: LGPL-2.1-or-later
// The rule set computed from where the sensors look, how wide the lens is and where the head's stops are: any
// number of sensors, no case left open. Radians; pan angles are a line, nothing wraps on it.
#pragma once

#include <array>

#include "fusion/rules.h"
#include "sensing/angles.h"
#include "sensing/sectors.h"

namespace cerberus::fusion {

using sensing::Geometry;
using sensing::Interval;

// A head of +-170 degrees unless somebody says otherwise.
constexpr Interval kDefaultLimits{sensing::radians(-170), sensing::radians(170)};

// A place worth looking at: turn until pan is within `wanted`, then sweep `sweep` (never wider than `wanted`).
struct Place {
  Interval wanted;
  Interval sweep;
  SensorBits sensors = 0;  // who asks for it
  bool limited = false;    // the stops keep the picture from covering all of it
};
constexpr int kMaxPlaces = 40;  // two for each of 16 sensors, and some that they share; more are dropped
using Places = sensing::FixedList<Place, kMaxPlaces>;

// Where to look when the sensors `fired` detect and the head stands at `pan`, best first; empty for no sensor.
//   1 what all of them cover together (the wanted interval), nearest to the head first
//   2 each fired sector, nearest to the head first; equally near: the one of the higher `order` (the later it fired),
//     then the lower number
// Within each of the two, what the head can turn to goes before what it cannot. Each is cut to the limits; a sector cut
// in two by the stops gives two places; one out of reach becomes the nearest limit. The sweep is the place with its
// edges pulled in by half a lens, because there the picture's border meets the edge; narrower than the lens: its
// middle. fired: sensors beyond the geometry's count are ignored. lens: the camera's horizontal field of view, [0, pi).
Places places(const Geometry& geometry, SensorBits fired, double pan,
              const std::array<int, kMaxSensors>& order, double lens, const Interval& limits);

// Which way: turn_left, turn_right, or search when pan is within the place. `inside` says whether it was within at the
// last call: then it has to leave by more than `hysteresis` to be outside again. A place narrower than twice the
// hysteresis (a stop, a border) is reached at hysteresis from it. Limits cannot be crossed: places lie inside them.
Action approach(const Place& place, double pan, bool inside, double hysteresis);

}  // namespace cerberus::fusion
