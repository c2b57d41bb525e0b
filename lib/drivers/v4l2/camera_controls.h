// SPDX-License-Identifier: LGPL-2.1-or-later
// The controls of a camera: an interface of what the driver v4l2 asks of the kernel, so that tests have cameras of their
// own. Functions that can fail return errno, 0 = no error.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace cerberus::drivers {

struct ControlRange {
  std::int32_t least = 0, most = 0, step = 1;
};

class CameraControls {
 public:
  virtual ~CameraControls() = default;
  virtual int open(const std::string& device) = 0;
  virtual void close() noexcept = 0;
  // Nothing: the camera has no such control, or it is disabled.
  virtual std::optional<ControlRange> query(std::uint32_t control) = 0;
  virtual int get(std::uint32_t control, std::int32_t& value) noexcept = 0;
  virtual int set(std::uint32_t control, std::int32_t value) noexcept = 0;
  // Whether the camera is still there. Changes nothing.
  virtual int probe() noexcept = 0;
};

// Of linux/v4l2-controls.h. Angles are arc-seconds, pan positive to the right, tilt positive up; speeds have no unit.
namespace camera_control {
inline constexpr std::uint32_t kPanRelative = 0x009a0904, kTiltRelative = 0x009a0905;
inline constexpr std::uint32_t kPanAbsolute = 0x009a0908, kTiltAbsolute = 0x009a0909;
inline constexpr std::uint32_t kPanSpeed = 0x009a0920, kTiltSpeed = 0x009a0921;
inline constexpr std::uint32_t kZoomAbsolute = 0x009a090d;  // no unit
}  // namespace camera_control

}  // namespace cerberus::drivers
