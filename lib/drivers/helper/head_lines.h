// SPDX-License-Identifier: LGPL-2.1-or-later
// The line protocol between a pipeline and the helper process that drives a head, version 1. A line is ASCII text with
// a line feed at its end and at most kMostLine bytes. Angles are degrees (pan positive to the right, tilt positive up),
// speeds degrees a second, accelerations degrees a second squared, times seconds; numbers have a point in every locale.
// docs/manual/head-protocol.md describes it for authors of a helper.
//
//   pipeline -> helper
//     cerberus-head 1 timeout T limits PAN-MIN PAN-MAX TILT-MIN TILT-MAX speed PAN TILT acceleration PAN TILT start PAN TILT
//     move PAN-COMMAND TILT-COMMAND     a command is `hold`, `to POSITION SPEED` or `at SPEED`
//     limits PAN-MIN PAN-MAX TILT-MIN TILT-MAX
//     home                              looks for the reference
//     zoom POSITION                     of a helper with that ability: goes there
//     alive | stop | quit
//   helper -> pipeline
//     ready 1 [position] [velocity] [feedback] [home] [alive] [zoom] [rate N]
//     alive                             of a helper with that ability: the answer to `alive`
//     pose PAN TILT PAN-SPEED TILT-SPEED AGE
//     speeds PAN TILT AGE               of a head without feedback: what its steps make of the last `move`
//     zoom POSITION                     0: the widest, 1: the longest focal length
//     homed PAN TILT                    the reference was found; the head stands there
//     fault TEXT | recovered | stopped TEXT | emergency pressed | emergency released
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "drivers/head/head.h"
#include "drivers/transport/line_buffer.h"
#include "motion/pan_tilt.h"

namespace cerberus::drivers {

inline constexpr int kHeadProtocol = 1;

// What the helper can do with its head.
struct HeadAbilities {
  bool position = false;  // it goes to an angle
  bool velocity = false;  // it turns at a speed
  bool feedback = false;  // it sends `pose` lines
  double rate = 50;       // commands a second that it takes, 1 to 1000
  bool home = false;      // it finds a reference: `home`
  bool alive = false;     // it answers each `alive` within 500 ms
  bool zoom = false;      // it goes to a position of its zoom, and reports where that is
};

struct ReadyLine {
  HeadAbilities abilities;
};
struct PoseLine {
  motion::AxisState pan, tilt;  // radians; acceleration 0
  double age = 0;               // seconds since it was measured
};
struct SpeedsLine {
  motion::PanTilt speed;  // radians a second
  double age = 0;         // seconds since they were commanded; more than kMostAge counts as that
  static constexpr double kMostAge = 1;
};
struct ZoomLine {       // in both directions: where it is, and where it is to go
  double position = 0;  // 0 to motion::kMostZoom
};
struct HomedLine {
  motion::PanTilt at;  // radians
};
struct FaultLine {
  std::string text;
};
struct RecoveredLine {};
struct StoppedLine {
  std::string text;  // why the helper stopped the head by itself
};
struct EmergencyLine {
  bool pressed = false;  // the device's emergency stop
};
struct AliveLine {};  // the question and its answer
// What a helper sends.
using HelperLine = std::variant<ReadyLine, PoseLine, SpeedsLine, HomedLine, ZoomLine, FaultLine,
                                RecoveredLine, StoppedLine, EmergencyLine, AliveLine>;

struct HelloLine {
  HeadSetup setup;  // limits, start and helper_timeout; the rest as by default
};
struct MoveLine {
  motion::AxisCommand pan, tilt;
};
struct LimitsLine {
  motion::Limits limits;  // the stops only
};
struct HomeLine {};
struct StopLine {};
struct QuitLine {};
// What a pipeline sends.
using PipelineLine =
    std::variant<HelloLine, MoveLine, LimitsLine, HomeLine, ZoomLine, AliveLine, StopLine, QuitLine>;

std::string hello_line(const HeadSetup& setup, Time timeout);
std::string move_line(const motion::AxisCommand& pan, const motion::AxisCommand& tilt);
std::string limits_line(const motion::Limits& limits);

// Without a line feed.
std::string ready_line(const HeadAbilities& abilities);
std::string pose_line(const PoseLine& pose);
std::string speeds_line(const SpeedsLine& speeds);
std::string homed_line(const HomedLine& homed);
std::string zoom_line(const ZoomLine& zoom);         // in both directions
inline constexpr std::string_view kAlive = "alive";  // in both directions

// One line without its line feed. Nothing: it is no line of this protocol, a number is not finite, its limits are not
// those of a head (motion::check(); `limits` alone may exclude zero: those of a corrected head are shifted), or its
// timeout is not between 1 ms and 10 s.
std::optional<PipelineLine> parse_pipeline_line(std::string_view line);

// One line without its line feed. Nothing: it is no line of this protocol, its numbers are not finite, or a `ready`
// names another version or neither `position` nor `velocity`. Unknown words at the end of `ready` are skipped, so that
// later versions can add abilities.
std::optional<HelperLine> parse_helper_line(std::string_view line);

}  // namespace cerberus::drivers
