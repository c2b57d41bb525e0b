// SPDX-License-Identifier: LGPL-2.1-or-later
// The control law: from a goal (an action, a point of the picture) to the commands of the two axes.
//
// A target is followed in the world's frame, predicted to the time at which the command takes effect
// (followed_axis.h). Turns towards a known direction are made at the head's own full speed; what is searched and the way
// back to zero at the turn speed. A search begins where the last target left. A target that crosses behind a head with
// stops is met on the other side where that is sooner (way_round.h).
#pragma once

#include <cstdint>
#include <optional>

#include "control/following/followed_axis.h"
#include "control/following/way_round.h"
#include "fusion/rules.h"
#include "motion/pose.h"
#include "sensing/sectors.h"
#include "vision/geometry/lens.h"

namespace cerberus::control {

struct LawOptions {
  motion::Limits limits;
  double base_turn = 0;  // radians a second that the base may be asked for; 0: it is not asked
  double turn_speed = sensing::radians(40);  // radians a second, for searching and returning
  Response response = Response::normal;
  // Of FollowedAxis::Parameters.
  double gain = FollowedAxis::Parameters{}.gain;
  double dead_band_start = FollowedAxis::Parameters{}.dead_band_start;  // never less than dead_band_stop
  double dead_band_stop = FollowedAxis::Parameters{}.dead_band_stop;
};

// The goal of the head for one frame.
struct Goal {
  fusion::Action action = fusion::Action::hold;
  std::optional<vision::Point> target;  // of Action::track, frame pixels; none: hold
  sensing::Interval sector{0, 0};       // of Action::search, pan angles
  std::uint32_t track = 0;              // the target's; another one begins anew
  bool immediate = false;               // it ends a way round
};

enum class State : std::uint8_t { holding, tracking, turning, searching, zeroing };

struct Command {
  motion::AxisCommand pan, tilt;
  State state = State::holding;
  bool limited = false;  // the goal lies beyond a stop; the head goes to the nearest position
  // Of a target that was seen on this frame: its pan angle when the command takes effect, and how fast that changes.
  struct Target {
    double pan = 0, rate = 0;
  };
  std::optional<Target> target{};
  bool round = false;  // it goes all the way round, to a target that is out of the picture meanwhile
};

// The head at the two times that a command connects.
struct Moment {
  motion::Pose capture;       // when the frame was taken
  motion::Pose ahead;         // when the command takes effect
  FollowedAxis::Times times;  // these times
  BaseTurn base;
  double view = 0;       // what the camera sees over the picture's width, radians; 0: not known
  double dead_time = 0;  // the head's, seconds
};

class Law {
 public:
  void set_options(const LawOptions& options);
  const LawOptions& options() const { return options_; }
  // Clears the state.
  void reset();

  // Computes the command for one frame. Without a known lens, tracking is impossible and the command is hold.
  // Deterministic; allocates nothing.
  Command update(const Goal& goal, const vision::Lens& lens, const Moment& moment);

 private:
  Command track(vision::Point target, const vision::Lens& lens, const Moment& moment);
  bool goes_round(const FollowedAxis::Aim& pan, const Moment& moment);
  std::optional<Command> go_on_round(const Moment& moment);
  Command turn(double direction, const motion::Pose& ahead) const;
  Command search(const sensing::Interval& sector, const Moment& moment);
  Command zero();

  LawOptions options_;
  fusion::Action last_ = fusion::Action::hold;
  FollowedAxis pan_, tilt_;
  WayRound way_round_;
  // Where the last target left, and when it was seen last.
  struct Left {
    double pan = 0;   // angle
    double time = 0;  // seconds
  };
  std::optional<Left> left_;
  std::uint32_t track_ = 0;
  bool sweeping_right_ = false;
};

}  // namespace cerberus::control
