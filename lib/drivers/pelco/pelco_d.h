// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of the Pelco-D protocol (Pelco, "D Protocol Manual", TF-0002): 0xff, address, command 1, command 2, data 1,
// data 2, and the sum of bytes 2 to 6 modulo 256.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cerberus::drivers::pelco {

using Frame = std::array<std::uint8_t, 7>;
inline constexpr int kMostStep = 0x3f;  // of both axes; 0x40 is turbo, of pan alone, and not used

// pan, tilt: signed steps -63 to 63, positive to the right and up; both 0 is the stop.
Frame drive(int address, int pan, int tilt);
enum class Axis : std::uint8_t { pan, tilt, zoom };
// Set Zoom Position. position: 0 to 1 of the zoom's range (0 to ffff hex).
Frame zoom(int address, double position);
Frame position_query(int address, Axis axis);
Frame go_to_preset(int address, int preset);  // 1 to 255

struct Position {
  int address = 0;
  Axis axis = Axis::pan;
  double degrees = 0;  // pan in [-180, 180) to the right; tilt in [-90, 90], positive up
  double zoom = 0;     // as in zoom()
};

// Finds position answers in a stream of bytes: frames with a wrong sum are skipped, byte by byte.
class Answers {
 public:
  void append(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::optional<Position> take();

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace cerberus::drivers::pelco
