// SPDX-License-Identifier: LGPL-2.1-or-later
// The control law: from a goal (an action, a point of the picture) to the commands of the two axes.
//
// Here the law is proportional:
//   target  = the pose when the frame was taken, turned by the angle of the point from the optical axis
//   error   = target - the position when the command takes effect, which follows from the commands given so far
//   command = go to the target, at no more than gain x |error|
// The prediction removes the dead time from the loop, and a head without further commands ends at the target. An axis
// at rest starts when the error exceeds the start of the dead band and rests again when it is below its stop: with one
// threshold for both, noise on the boxes makes a head hunt (the test in tests/unit/law.cpp counts the reversals).
#pragma once

#include <cstdint>
#include <optional>

#include "fusion/rules.h"
#include "motion/pose.h"
#include "sensing/sectors.h"
#include "vision/geometry/lens.h"

namespace cerberus::control {

struct LawOptions {
  motion::Limits limits;
  double turn_speed = sensing::radians(40);       // radians a second, for turning, searching and returning
  double gain = 4;                                // radians a second for each radian of error
  double dead_band_start = sensing::radians(3);   // radians; never less than dead_band_stop
  double dead_band_stop = sensing::radians(0.7);  // radians
};

// The goal of the head for one frame.
struct Goal {
  fusion::Action action = fusion::Action::hold;
  std::optional<vision::Point> target;  // of Action::track, frame pixels; none: hold
  sensing::Interval sector{0, 0};       // of Action::search, pan angles
};

enum class State : std::uint8_t { holding, tracking, turning, searching, zeroing };

struct Command {
  motion::AxisCommand pan, tilt;
  State state = State::holding;
  bool limited = false;  // the goal lies beyond a stop; the head goes to the nearest position
};

class Law {
 public:
  void set_options(const LawOptions& options);
  const LawOptions& options() const { return options_; }
  // Clears the state.
  void reset();

  // Computes the command for one frame. capture: the pose when the frame was taken. ahead: the pose when this command
  // takes effect. Without a known lens, tracking is impossible and the command is hold. Deterministic; allocates
  // nothing.
  Command update(const Goal& goal, const vision::Lens& lens, const motion::Pose& capture,
                 const motion::Pose& ahead);

 private:
  motion::AxisCommand approach(double target, double position, bool& moving) const;
  Command track(vision::Point target, const vision::Lens& lens, const motion::Pose& capture,
                const motion::Pose& ahead);
  Command turn(double direction, const motion::Pose& ahead) const;
  Command search(const sensing::Interval& sector, const motion::Pose& ahead);
  Command zero() const;

  LawOptions options_;
  fusion::Action last_ = fusion::Action::hold;
  bool pan_moving_ = false, tilt_moving_ = false;
  bool sweeping_right_ = false;
};

}  // namespace cerberus::control
