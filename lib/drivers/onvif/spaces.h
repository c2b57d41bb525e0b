// SPDX-License-Identifier: LGPL-2.1-or-later
// Degrees in the units of a camera's spaces (ONVIF PTZ Service Specification, 5.2 and annex "Spaces"). A generic space
// goes from -1 to 1 and says nothing of degrees: speeds need the speed at 1, positions the angles at both ends.
#pragma once

#include <optional>
#include <vector>

#include "drivers/onvif/answers.h"
#include "drivers/onvif/messages.h"

namespace cerberus::drivers::onvif {

struct Angles {
  double pan = 0, tilt = 0;  // degrees, positive right and up; or degrees a second
  bool operator==(const Angles&) const = default;
};

// What a generic space means on this camera.
struct Mechanics {
  Angles full_speed{90, 90};          // at velocity 1
  std::optional<Angles> least, most;  // at the ends of the generic position space; nothing: unknown
};

// The spaces for velocities, best first: degrees a second, the generic one, the camera's default (an empty name). One that
// the camera refuses is given up for the next.
std::vector<Space> velocity_spaces(const PtzOptions& options);
// A velocity in `space`, within its range.
PanTilt to_velocity(const Angles& degrees_a_second, const Space& space, const Mechanics& mechanics);
// The same back: what a velocity within the range means, in degrees a second.
Angles from_velocity(const PanTilt& velocity, const Mechanics& mechanics);

// The space of positions that can be expressed in degrees; nothing: none.
std::optional<Space> position_space(const PtzOptions& options, const Mechanics& mechanics);
PanTilt to_position(const Angles& degrees, const Space& space, const Mechanics& mechanics);
// The unit of a reported position. A position without a space is of `space`, and of the generic one where that is not
// known either.
enum class Unit : std::uint8_t { generic, degrees, unknown };
Unit unit_of(const Space& position, const std::optional<Space>& space);
// A reported position in degrees. Nothing: of a space without degrees.
std::optional<Angles> to_degrees(const Space& position, const std::optional<Space>& space,
                                 const PtzOptions& options, const Mechanics& mechanics);
// The speed of an AbsoluteMove; nothing: the camera's own.
std::optional<PanTilt> to_speed(const Angles& degrees_a_second, const PtzOptions& options,
                                const Mechanics& mechanics);

}  // namespace cerberus::drivers::onvif
