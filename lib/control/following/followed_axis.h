// SPDX-License-Identifier: LGPL-2.1-or-later
// One axis of a head that follows a target: from the angles at which the target is seen to the commands of the axis.
//
//   world   = angle + yaw of the base then            two filters: a quick one, and a slow one that decides that it stands
//   target  = world at `effect` - yaw of the base then,  its rate less the base's
//   speed   = rate + sign(e) min(gain |e|, sqrt(2 a |e|)),  e = target - position of the axis at `effect`
//   the commanded speed follows that one with limits of acceleration and jerk:  dv/dt = smoothing (speed - v)
//
// The head goes with the target and does not run after it; sqrt(2 a e) is the speed from which it can still brake. A
// target that stands is judged by the slow filter alone: the axis rests within dead_band_stop of it and starts again
// beyond dead_band_start, so that boxes that wander do not move it. Radians and seconds; allocates nothing.
#pragma once

#include <cstdint>

#include "control/following/target_filter.h"
#include "motion/profile.h"

namespace cerberus::control {

// How the head follows, the one dial for users.
enum class Response : std::uint8_t { calm, normal, fast };

// The turn of the base below the head, radians to the right: since the start when the frame was taken and when the
// command takes effect, and its rate then.
struct BaseTurn {
  double taken = 0, effect = 0, rate = 0;
};

class FollowedAxis {
 public:
  struct Parameters {
    Response response = Response::normal;
    double gain = 6.5;                              // radians a second for each radian of error
    double dead_band_start = sensing::radians(3);   // radians
    double dead_band_stop = sensing::radians(0.7);  // radians
    // What the camera sees over the picture's width, radians; 0: not known. Through a lens that sees less than a usual one
    // the boxes' noise and the dead bands are smaller angles, and so is what the picture may turn by from one to the next.
    double field_of_view = 0;
  };
  // When the frame was taken, and when the command takes effect: seconds. blind: for how much of that time nothing may be
  // predicted, since the picture is an old one again.
  struct Times {
    double taken = 0, effect = 0, blind = 0;
    double horizon() const { return effect - taken; }
    double predicted() const { return effect - blind; }
  };
  // Where the target is when the command takes effect.
  struct Aim {
    double position = 0, rate = 0;
    double calm = 0;      // the position by the slow filter
    bool stands = false;  // calm is what counts
    // Takes this place for the target: a stop before it, or the other way round.
    void move_to(double place) { *this = {place, 0, place, stands}; }
  };

  void reset() { *this = {}; }
  // A new target is centred: the start of the dead band does not apply.
  void begin() { moves_ = true; }
  // Adds the angle at which the target was seen.
  Aim observe(double angle, const BaseTurn& base, const Times& times, const Parameters& parameters);
  // ahead: of the axis when the command takes effect.
  motion::AxisCommand command(const Aim& aim, const motion::AxisState& ahead,
                              const motion::AxisLimits& limits, const Times& times,
                              const Parameters& parameters);

 private:
  double shaped(double speed, const motion::AxisState& ahead, double acceleration, const Times& times,
                double smoothing);

  TargetFilter quick_, slow_;
  double taken_ = 0, interval_ = 0;  // seconds, of the last picture
  double moved_ = 0;                 // seconds: when the slow filter last did not find that it stands
  bool moves_ = false;
  double speed_ = 0, acceleration_ = 0, commanded_ = -1;  // of the last command, and its time of effect
};

}  // namespace cerberus::control
