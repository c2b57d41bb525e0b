// SPDX-License-Identifier: LGPL-2.1-or-later
// A radar in the lower left corner: the robot in the middle looks up; sectors of the sensors (red: detects; pale red: its
// reading is not counted; blue: does not; grey: no valid reading), in yellow the camera's view, and the objects in the
// colours of their identities.
#pragma once

#include <span>

#include "overlay/picture.h"
#include "overlay/scene.h"
#include "vision/geometry/lens.h"

namespace cerberus::overlay {

// Metres from the middle to the rim: as far as the paper's sensors see. That of a robot's page is the same.
inline constexpr double kRadarReach = 12;

// Sets the bearings' sectors: halfway to the neighbours on both sides, at most 60 degrees, half of what PIR modules see.
void divide_round(std::span<RadarSensor> sensors);

// Where an object of the picture is, the camera's pan (radians) away from straight ahead. What is not known of it follows
// from the picture: the bearing from its middle, and the lower its feet the nearer it is.
RadarObject radar_object(const Object& object, double pan, const vision::Lens& lens);

// Returns a patch without pixels where the frame has no room for it.
Patch draw_radar(const Radar& radar, Area frame, PicturePool& pool);

}  // namespace cerberus::overlay
