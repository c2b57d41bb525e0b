// SPDX-License-Identifier: LGPL-2.1-or-later
// The limits of a head that is driven by speeds: they hold by the positions that its device reports or, without these,
// by the speeds that it was sent, integrated (motion/reckoning.h). Every driver without positions reports these speeds
// to the pipeline, which reckons the pose from the same.
//
// A stop is reckoned as obeyed from the time at which it was sent. Where it was lost on its way, which the next
// acknowledgement or its absence shows, the way that the head has gone on since is added.
#pragma once

#include <array>
#include <optional>

#include "drivers/helper/head_lines.h"
#include "motion/reckoning.h"
#include "sensing/angles.h"

namespace cerberus::drivers {

class SpeedReckoning {
 public:
  struct Parameters {
    // Radians beyond a limit, by reckoning alone, where the device stops a head that its pipeline still drives on.
    // derived: more than the pipeline's own reckoning of the same speeds can differ by.
    double slack = sensing::radians(2);
    // Seconds for which a device that does not stop by itself is reckoned to have gone on after a lost stop, at most.
    // One that is out of reach for longer may have no power, or stand at its end: its position is unknown, not far away.
    // derived: the oldest change of speeds that the pipeline takes. Guard: unit/visca_head.
    double most_lost = SpeedsLine::kMostAge;
  };

  // The head rests at `at` (radians) from `now` on.
  void begin(Time now, const motion::PanTilt& at);
  // The device turns at these speeds (radians a second) from now on, until `until` if it then stops by itself.
  void set_speeds(const motion::PanTilt& speed, Time now, Time until = motion::kNever);
  // The device has refused the last speeds: those before it are in force still.
  void on_refused();
  // A stop is sent.
  void stop(Time now);
  // The device has obeyed the stop that was sent at `sent`, and none that was sent earlier.
  void on_stopped(Time sent);
  // The device has obeyed no stop, as far as known: its last speeds are in force still.
  void on_stop_lost();
  // Ends the speeds that the device has ended by itself until `now`.
  void expire(Time now);
  // The device was found to be at `at` (radians).
  void set_reference(const motion::PanTilt& at, Time now) { reckoned_.place(now, at); }
  // Where the head is by the speeds that it was sent, radians.
  motion::PanTilt position(Time now) const;
  // take_speeds() returns the speeds in force, whatever it has returned before.
  void report_again(Time now);
  // The oldest change of the speeds that was not taken yet; nothing: there is none.
  std::optional<SpeedsLine> take_speeds(Time now);
  // speed (radians a second), or 0 where it would lead beyond a limit. measured: the position that the device reported
  // (radians), NaN without one. reaction: seconds of way for which a head with positions is stopped before a limit.
  motion::PanTilt confined(const motion::PanTilt& speed, const motion::PanTilt& measured,
                           const motion::Limits& limits, double reaction, Time now) const;

 private:
  struct InForce {
    motion::PanTilt speed{};
    Time from{}, until = motion::kNever;
  };
  struct Change {
    motion::PanTilt speed;
    Time time;
  };
  void turn(const motion::PanTilt& speed, Time time);
  // Until when the speeds that a lost stop left in force are reckoned.
  Time end_of_lost() const;

  motion::Reckoning reckoned_;
  InForce in_force_, before_;
  std::optional<InForce> unstopped_;  // by the stop that is not acknowledged
  Time stopped_{};                    // when the first such stop was sent
  std::array<Change, 4> changes_{};   // not taken yet, the oldest first
  unsigned changed_ = 0;
};

}  // namespace cerberus::drivers
