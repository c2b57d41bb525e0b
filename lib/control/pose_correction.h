// SPDX-License-Identifier: LGPL-2.1-or-later
// Stands between a head controller and a head that reports no position: keeps the difference between the angles by which
// the driver reckons and the estimated ones (PoseEstimate).
//
//   pose = the driver's pose + shift;  what the driver is given = command - shift, limits - shift
//
// The limits that the driver is given lie inside the head's by the stop margin (motion/stop_margin.h). While the driver
// reports measured positions the shift is zero. Without frames that have a turn of the picture the shift stays as it is.
#pragma once

#include <optional>

#include "control/pose_estimate.h"
#include "control/turn_division.h"
#include "drivers/head/head.h"

namespace cerberus::control {

class PoseCorrection {
 public:
  using Time = motion::Time;

  // The head is at `start`. dead_time: from a command until the head obeys.
  void reset(const motion::Pose& start, Time dead_time);
  void set_dead_time(Time dead_time) { dead_time_ = dead_time; }
  // Records the driver's pose and adds the shift to it.
  void add(motion::Pose& pose);
  // The driver's own pose at `time`, as recorded.
  motion::Pose driver_pose(Time time) const { return raw_.at(time); }
  // The driver's own poses, as recorded.
  const motion::PoseHistory& reckoned() const { return raw_; }
  // Adds a frame that was taken at `taken` (the head's time). ahead: the estimated pose when a command takes effect.
  // turn: of the picture since the frame before. Returns true if narrowed() and limits() of `limits` have changed by
  // so much that the driver must be given them.
  // base_known: the base's turn is known, and is no part of `turn` (else turn_division.h).
  bool on_frame(Time taken, const motion::Pose& ahead, const std::optional<Turn>& turn,
                const motion::Limits& limits, bool base_known = true);
  // Whether head and base have both turned, and nothing measures the base.
  bool ambiguous() const { return division_.ambiguous(); }

  // The estimated position when the last frame was taken; nullopt before the first and while the driver measures.
  std::optional<motion::PanTilt> position() const { return position_; }
  // The head's own turn since the frame before, as the picture shows it; nothing: it does not, or the driver measures.
  const std::optional<Turn>& seen() const { return seen_; }
  bool lost() const { return position_ && estimate_.lost(); }
  // The limits less the stop margin; zero stays within them.
  motion::Limits narrowed(const motion::Limits& limits) const;
  // The same in the driver's angles.
  motion::Limits limits(const motion::Limits& limits) const;
  void to_driver(drivers::HeadCommand& command) const;

 private:
  // Limits are passed on when a stop has moved by this, radians. derived: a tenth of what a head may be beyond them.
  static constexpr double kLeastChange = sensing::radians(0.1);

  double speed(Time taken) const;

  PoseEstimate estimate_;
  TurnDivision division_;
  motion::PoseHistory raw_;
  motion::PanTilt shift_;
  std::optional<motion::PanTilt> before_;    // the driver's position at the last frame
  std::optional<motion::PanTilt> position_;  // estimated at the last frame
  std::optional<Turn> seen_;
  motion::Pose ahead_;
  Time dead_time_{};
  std::optional<motion::Limits> sent_;  // as limits() returned them
};

}  // namespace cerberus::control
