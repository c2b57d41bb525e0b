// SPDX-License-Identifier: LGPL-2.1-or-later
// The messages that the page sends over its WebSocket: one line of words each, documented in docs/manual/robot.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "robot/mode.h"

namespace cerberus::robot {

struct PageCommand {
  enum class Kind : std::uint8_t {
    ack,     // `ack N`: picture N was drawn
    seen,    // `seen N`: status N arrived
    camera,  // `camera NAME`: shows another camera
    stop,
    home,
    automatic,  // `auto`
    turn,       // `turn PAN TILT`: shares of the turning speed, -1 to 1; for 500 ms
    follow,     // `follow ID`: a track
    mode,       // `mode armed`
    stage,      // `stage mask`: shows what one stage of the detection made; `stage picture`
    set,        // `set quality 60`: a setting of live_settings.h
    drive,      // `drive SPEED YAW`: the base, shares of its greatest speeds, -1 to 1; for 500 ms
  };
  Kind kind = Kind::ack;
  std::uint64_t number = 0;
  double pan = 0, tilt = 0;  // turn; drive: speed, yaw rate
  double value = 0;          // set
  std::string name;
  Mode mode = Mode::armed;
};

// Longest message, in bytes.
constexpr std::size_t kLongestCommand = 128;

// nullopt: not one of the above, letter by letter; nothing is guessed.
std::optional<PageCommand> parse_command(std::string_view line);

}  // namespace cerberus::robot
