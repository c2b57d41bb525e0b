// SPDX-License-Identifier: LGPL-2.1-or-later
// Measures what a head makes of its commands, by the turn of the picture: the speed table, the dead time and the
// backlash of each axis. Decides only; the caller commands the head and measures the picture.
//
// Each speed v is run four times for T seconds: to the right, again to the right, to the left, again to the left. Of a
// run that was commanded at 0 the turn in its steady part is a straight line:
//   angle(t) = s (t - d)            s: the actual speed; d: the dead time, to the middle of the ramp
//   first run of a direction        d' = d + backlash / s
// s and d by least squares over the frames from `steady` seconds on; s: mean of four; dead time: mean of the second
// runs, weighted by s^2 (the error of d is that of an angle divided by s); backlash: mean of (d' - d) s.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "control/base_rate.h"
#include "motion/speed_map.h"

namespace cerberus::control {

struct CalibrationParameters {
  // Degrees a second. derived: what following people asks for, by factors of two.
  std::vector<double> speeds{2, 4, 8, 16, 32};
  double longest = 1.6;  // seconds of a run
  double least = 1.1;    // seconds; a speed whose runs would be shorter is not measured
  double steady = 0.65;  // seconds from the command on; derived: a dead time of 500 ms and a ramp of 150 ms
  double pause = 0.9;    // seconds between runs; derived: the same dead time and ramp, and play that settles
  // Share of their mean by which the runs of a speed may lie apart. derived: twice what noise of .05 degrees a frame does,
  // and below what a wrong step of a speed table is. Guarded by unit-calibration.
  double far_apart = 0.1;
  int least_frames = 5;  // in the steady part; derived: a line has two unknowns, and frames at 15 a second
};

// What the single runs of one quantity gave.
struct Spread {
  double least = 0, most = 0, sum = 0;
  int runs = 0;
  double mean() const { return sum / runs; }
  void add(double value);
  // For a user, in units of `unit` and with so many decimals: "4 runs, 4.1 to 4.3".
  std::string text(double unit, int decimals) const;
};

class AxisCalibration {
 public:
  using Time = motion::Time;
  // reach: radians that the axis may go to either side of where it stands. fastest: radians a second.
  AxisCalibration(double reach, double fastest, const CalibrationParameters& parameters = {});
  // The speed to command at `now`, radians a second; nullopt: the axis is done, or cannot be measured.
  std::optional<double> command(Time now);
  // A frame that was taken at `taken`: radians that the picture turned since the one before; NaN: not measured.
  void add(Time taken, double turn);

  std::string problem() const { return problem_; }  // for a user; empty: none
  double seconds_left() const;
  // Once done. No points: nothing could be measured.
  motion::SpeedMap speeds() const;
  double dead_time() const;  // seconds
  double backlash() const;   // radians
  // How far the runs lay apart that the numbers above are means of.
  Spread speed_runs(double commanded) const;  // radians a second, of this commanded speed
  Spread dead_time_runs() const;              // seconds
  Spread backlash_runs() const;               // radians
  // The speed (radians a second, as commanded) whose runs lie further apart than far_apart, and by which share of their
  // mean; the worst one. 0: none do.
  struct FarApart {
    double commanded = 0, share = 0;
  };
  FarApart far_apart() const;
  // Where the picture has it now: radians from where the axis stood at first.
  double position() const { return position_; }

 private:
  struct Run {
    double speed = 0;   // as commanded, of either sign
    double length = 0;  // seconds
    bool reversal = false;
    double actual = 0, delay = 0;  // measured
    bool measured = false;
  };
  void finish(Run& run);

  CalibrationParameters parameters_;
  double reach_ = 0;
  std::vector<Run> runs_;
  std::size_t at_ = 0;
  std::optional<Time> begun_;  // the present run
  double position_ = 0;        // radians, by the picture
  double angle_ = 0;           // since the run began
  int missed_ = 0;             // frames in a row without a measurement
  // Sums over the steady part: frames, t, angle, t^2, t angle.
  double n_ = 0, st_ = 0, sa_ = 0, stt_ = 0, sta_ = 0;
  std::string problem_;
};

}  // namespace cerberus::control
