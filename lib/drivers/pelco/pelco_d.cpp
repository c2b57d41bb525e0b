// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/pelco/pelco_d.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace cerberus::drivers::pelco {
namespace {

constexpr std::uint8_t kSync = 0xff;
constexpr std::uint8_t kRight = 0x02, kLeft = 0x04, kUp = 0x08, kDown = 0x10;
constexpr std::uint8_t kGoToPreset = 0x07;
constexpr std::uint8_t kQueryPan = 0x51, kQueryTilt = 0x53, kPan = 0x59, kTilt = 0x5b;
constexpr std::uint8_t kSetZoom = 0x4f, kQueryZoom = 0x55, kZoom = 0x5d;
constexpr double kZoomRange = 0xffff;

std::uint8_t sum_of(const Frame& frame) {
  return static_cast<std::uint8_t>(std::accumulate(frame.begin() + 1, frame.end() - 1, 0));
}

Frame finished(int address, int command, int pan, int tilt) {
  Frame frame{kSync,
              static_cast<std::uint8_t>(std::clamp(address, 1, 255)),
              0,
              static_cast<std::uint8_t>(command),
              static_cast<std::uint8_t>(pan),
              static_cast<std::uint8_t>(tilt),
              0};
  frame.back() = sum_of(frame);
  return frame;
}

}  // namespace

Frame drive(int address, int pan, int tilt) {
  int command = 0;
  if (pan != 0) command |= pan > 0 ? kRight : kLeft;
  if (tilt != 0) command |= tilt > 0 ? kUp : kDown;
  return finished(address, command, std::min(std::abs(pan), kMostStep), std::min(std::abs(tilt), kMostStep));
}

Frame position_query(int address, Axis axis) {
  return finished(address,
                  axis == Axis::pan    ? kQueryPan
                  : axis == Axis::tilt ? kQueryTilt
                                       : kQueryZoom,
                  0, 0);
}

Frame zoom(int address, double position) {
  const auto units = static_cast<int>(std::lround(std::clamp(position, 0.0, 1.0) * kZoomRange));
  return finished(address, kSetZoom, units >> 8, units & 0xff);
}

Frame go_to_preset(int address, int preset) {
  return finished(address, kGoToPreset, 0, preset);
}

// Hundredths of a degree, 0 to 35999, clockwise; a tilt grows downwards.
std::optional<Position> Answers::take() {
  while (bytes_.size() >= 7) {
    Frame frame;
    std::copy_n(bytes_.begin(), 7, frame.begin());
    const bool is_zoom = frame[3] == kZoom;
    const bool answer =
        frame[0] == kSync && frame[2] == 0 && (frame[3] == kPan || frame[3] == kTilt || is_zoom);
    const int hundredths = frame[4] << 8 | frame[5];
    if (!answer || frame.back() != sum_of(frame) || (hundredths >= 36000 && !is_zoom)) {
      bytes_.erase(bytes_.begin());
      continue;
    }
    bytes_.erase(bytes_.begin(), bytes_.begin() + 7);
    if (is_zoom) return Position{frame[1], Axis::zoom, 0, hundredths / kZoomRange};
    const double degrees = hundredths < 18000 ? hundredths / 100.0 : hundredths / 100.0 - 360;
    if (frame[3] == kPan) return Position{frame[1], Axis::pan, degrees, 0};
    return Position{frame[1], Axis::tilt, std::clamp(-degrees, -90.0, 90.0), 0};
  }
  return std::nullopt;
}

}  // namespace cerberus::drivers::pelco
