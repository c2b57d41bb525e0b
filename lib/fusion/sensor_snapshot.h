// SPDX-License-Identifier: LGPL-2.1-or-later
// The inputs beside the tracks when a frame is fused: the sensors of all groups in their order, the head's pan and the
// base's yaw rate.
#pragma once

#include <array>
#include <cstdint>

#include "fusion/sensor_history.h"

namespace cerberus::fusion {

struct SensorSnapshot {
  std::array<std::uint8_t, sensing::kMaxSensors> sensors{};               // 0, 1, kInvalid
  std::array<double, sensing::kMaxSensors> bearings{}, fields_of_view{};  // radians
  std::size_t count = 0;
  double pan_degrees = kUnknown;
  double lens = 0;  // horizontal field of view, radians, as the head's zoom says; 0: it does not
  double base_degrees = kUnknown;    // a second
  double base_speed = kUnknown;      // metres a second, straight ahead
  bool pan_on_frame = false;         // the frame carried the pose
  bool base_received = false;        // the rate came as an event, which the PIR sources have received too
  bool geometry_known = true;        // the geometry of all sensors is known, none is assumed
  const char* other_head = nullptr;  // interned: another head, whose pose was received

  // Appends the sensors of one group; those beyond sensing::kMaxSensors are dropped.
  void add(const Reading& reading);
};

}  // namespace cerberus::fusion
