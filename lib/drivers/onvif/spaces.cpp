// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/spaces.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace cerberus::drivers::onvif {
namespace {

constexpr std::string_view kPositionGeneric =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/PositionGenericSpace";
constexpr std::string_view kPositionDegrees =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalPositionSpaceDegrees";
constexpr std::string_view kVelocityGeneric =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/VelocityGenericSpace";
constexpr std::string_view kVelocityDegrees =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/VelocitySpaceDegrees";
constexpr std::string_view kSpeedGeneric = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/GenericSpeedSpace";

const Space* find(const std::vector<Space>& spaces, std::string_view uri) {
  const auto at =
      std::find_if(spaces.begin(), spaces.end(), [uri](const Space& space) { return space.uri == uri; });
  return at == spaces.end() ? nullptr : &*at;
}

double within(double value, const Range& range) {
  return std::clamp(value, range.from, range.to);
}

// One axis of the generic position space: its ends are `least` and `most` degrees.
double from_degrees(double degrees, double least, double most, const Range& range) {
  return within(range.from + (degrees - least) / (most - least) * (range.to - range.from), range);
}
double in_degrees(double value, double least, double most, const Range& range) {
  return least + (value - range.from) / (range.to - range.from) * (most - least);
}

}  // namespace

std::vector<Space> velocity_spaces(const PtzOptions& options) {
  std::vector<Space> spaces;
  for (const std::string_view uri : {kVelocityDegrees, kVelocityGeneric})
    if (const Space* space = find(options.velocities, uri)) spaces.push_back(*space);
  spaces.push_back({});
  return spaces;
}

PanTilt to_velocity(const Angles& degrees_a_second, const Space& space, const Mechanics& mechanics) {
  if (space.uri == kVelocityDegrees)
    return {within(degrees_a_second.pan, space.x), within(degrees_a_second.tilt, space.y), space.uri};
  // The range of a generic space is -1 to 1 (PTZ Service Specification, "Generic Pan/Tilt velocity space").
  return {within(degrees_a_second.pan / mechanics.full_speed.pan, space.x),
          within(degrees_a_second.tilt / mechanics.full_speed.tilt, space.y), space.uri};
}

Angles from_velocity(const PanTilt& velocity, const Mechanics& mechanics) {
  if (velocity.space == kVelocityDegrees) return {velocity.x, velocity.y};
  return {velocity.x * mechanics.full_speed.pan, velocity.y * mechanics.full_speed.tilt};
}

std::optional<Space> position_space(const PtzOptions& options, const Mechanics& mechanics) {
  if (const Space* space = find(options.positions, kPositionDegrees)) return *space;
  const Space* space = find(options.positions, kPositionGeneric);
  if (!space || !mechanics.least || !mechanics.most) return std::nullopt;
  return *space;
}

PanTilt to_position(const Angles& degrees, const Space& space, const Mechanics& mechanics) {
  if (space.uri == kPositionDegrees || !mechanics.least || !mechanics.most)
    return {within(degrees.pan, space.x), within(degrees.tilt, space.y), space.uri};
  return {from_degrees(degrees.pan, mechanics.least->pan, mechanics.most->pan, space.x),
          from_degrees(degrees.tilt, mechanics.least->tilt, mechanics.most->tilt, space.y), space.uri};
}

Unit unit_of(const Space& position, const std::optional<Space>& space) {
  const std::string_view uri = !position.uri.empty() ? std::string_view(position.uri)
                               : space               ? std::string_view(space->uri)
                                                     : kPositionGeneric;
  return uri == kPositionDegrees ? Unit::degrees : uri == kPositionGeneric ? Unit::generic : Unit::unknown;
}

std::optional<Angles> to_degrees(const Space& position, const std::optional<Space>& space,
                                 const PtzOptions& options, const Mechanics& mechanics) {
  const Unit unit = unit_of(position, space);
  if (unit == Unit::degrees) return Angles{position.x.from, position.y.from};
  if (unit != Unit::generic || !mechanics.least || !mechanics.most) return std::nullopt;
  const Space* generic = find(options.positions, kPositionGeneric);
  const Range x = generic ? generic->x : Range{}, y = generic ? generic->y : Range{};
  return Angles{in_degrees(position.x.from, mechanics.least->pan, mechanics.most->pan, x),
                in_degrees(position.y.from, mechanics.least->tilt, mechanics.most->tilt, y)};
}

std::optional<PanTilt> to_speed(const Angles& degrees_a_second, const PtzOptions& options,
                                const Mechanics& mechanics) {
  const Space* space = find(options.speeds, kSpeedGeneric);
  if (!space) return std::nullopt;
  return PanTilt{within(std::abs(degrees_a_second.pan) / mechanics.full_speed.pan, space->x),
                 within(std::abs(degrees_a_second.tilt) / mechanics.full_speed.tilt, space->y), space->uri};
}

}  // namespace cerberus::drivers::onvif
