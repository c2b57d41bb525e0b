// SPDX-License-Identifier: LGPL-2.1-or-later
// The content of the overlay for one frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "overlay/picture.h"
#include "overlay/trails.h"

namespace cerberus::overlay {

enum class ObjectState { seen, coasted, stopped };

struct Object {
  std::uint32_t id = 0;  // 0: none
  double x = 0, y = 0, width = 0, height = 0;
  double speed = 0;     // pixels a second; not finite: unknown
  double distance = 0;  // metres; not finite: unknown
  double bearing = 0;   // radians, from the camera's axis; not finite: unknown
  ObjectState state = ObjectState::seen;
  bool target = false;  // the head follows it
};

struct Light {
  int sensor = 0;            // its number, from 1
  std::uint8_t reading = 2;  // 0 no detection, 1 detection, else invalid
  bool operator==(const Light&) const = default;
};

// The head's direction, and the last decision of the fusion.
struct System {
  bool pose = false, decision = false;  // whether the following values are valid
  double pan = 0, tilt = 0;             // degrees
  std::string rule, action;
  std::vector<Light> lights;  // from left to right
};

// Radians, clockwise from where the robot looks.
struct RadarSensor {
  double bearing = 0, left = 0, right = 0;  // its sector: so far to both sides of the bearing
  std::uint8_t reading = 2;                 // as a light's
  bool doubtful = false;  // the reading is not counted: the robot's own motion may be its cause
};
struct RadarObject {
  std::uint32_t id = 0;
  double bearing = 0, distance = 0;  // metres
  bool target = false;
};
struct Radar {
  double pan = 0, field_of_view = 0;  // of the camera; no view, no radar
  std::vector<RadarSensor> sensors;
  std::vector<RadarObject> objects;
};

struct Scene {
  vision::Size frame;
  System system;
  Radar radar;
  std::span<const Object> objects;
  std::span<const Trails::Trail> trails;
  std::span<const Area>
      covered;            // by drawings of other elements, which lie on top: labels keep clear of them
  double time = 0;        // s, of this frame
  double trail_time = 2;  // s, after which a trail has faded
  double line_width = 0;  // pixels, 0: from the frame's size
  bool boxes = true, ids = true, speeds = true, crosshair = false;
};

}  // namespace cerberus::overlay
