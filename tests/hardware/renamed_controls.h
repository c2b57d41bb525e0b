// SPDX-License-Identifier: LGPL-2.1-or-later
// Which controls of the kernel's test camera stand for pan, tilt and zoom
// (drivers/media/test-drivers/vivid/vivid-ctrls.c).
#pragma once

#include <linux/videodev2.h>

#include <cstdint>

namespace simulated {

constexpr std::uint32_t kPan =
    (V4L2_CID_USER_BASE | 0xf000) + 2;                // "Integer 32 Bits": all of them, arc-seconds
constexpr std::uint32_t kTilt = V4L2_CID_CONTRAST;    // 0 to 255: degrees from -128 on
constexpr std::uint32_t kPanSpeed = V4L2_CID_HUE;     // -128 to 128
constexpr std::uint32_t kZoom = V4L2_CID_BRIGHTNESS;  // 0 to 255
constexpr std::int32_t kDegree = 3600, kMiddle = 128;
constexpr std::int32_t tilt_of(std::int32_t contrast) {
  return (contrast - kMiddle) * kDegree;
}

}  // namespace simulated
