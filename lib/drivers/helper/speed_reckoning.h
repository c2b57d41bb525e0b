// SPDX-License-Identifier: LGPL-2.1-or-later
// The limits of a head that is driven by speeds: they hold by the positions that its device reports or, without these, by
// the speeds that it was sent, integrated (motion/reckoning.h). Every driver without positions reports these speeds to the
// pipeline, which reckons the pose from the same.
#pragma once

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
  };

  // The head rests at `at` (radians) from `now` on.
  void begin(Time now, const motion::PanTilt& at) { reckoned_.begin(now, at); }
  // The device turns at these speeds (radians a second) from now on.
  void set_speeds(const motion::PanTilt& speed, Time now);
  // The device was found to be at `at` (radians).
  void set_reference(const motion::PanTilt& at, Time now) { reckoned_.place(now, at); }
  // The speeds that have changed since the last call; nothing: none have.
  std::optional<SpeedsLine> take_speeds(Time now);
  // speed (radians a second), or 0 where it would lead beyond a limit. measured: the position that the device reported
  // (radians), NaN without one. reaction: seconds of way for which a head with positions is stopped before a limit.
  motion::PanTilt confined(const motion::PanTilt& speed, const motion::PanTilt& measured,
                           const motion::Limits& limits, double reaction, Time now) const;

 private:
  motion::Reckoning reckoned_;
  std::optional<Time> changed_;  // when, if that was not taken yet
};

}  // namespace cerberus::drivers
