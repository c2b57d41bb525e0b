// SPDX-License-Identifier: LGPL-2.1-or-later
// Judges the positions that one axis of a head reports by what it was commanded: reports beyond the limits, of a head that
// moves by itself, with the wrong sign, that jump, that never change, or that are no numbers part from the commands.
//
//   tolerance   slack + v (latency + grace),  v: the largest commanded speed of the last latency + grace
//   outside     |report - command| > tolerance, or the report is no number
//   parted      outside for `patience`; time inside takes a quarter of itself back, so that jumps to and fro count
//
// A head that is slower or faster than it is commanded is no such case. While it is outside, no time counts in which the
// reports come nearer to the command, or change in its direction by `least_share` to `most_share` of its way, each without
// a jump. Other reports outside are not to be believed meanwhile (`doubtful`). Pure.
#pragma once

#include <cstdint>

#include "motion/head_limits.h"

namespace cerberus::motion {

class ReportWatch {
 public:
  struct Parameters {
    double slack = sensing::radians(10);  // asked
    double grace = .5;                    // seconds; asked
    double patience = 1;                  // seconds; asked
    // derived: uncalibrated cameras turn at .4 to 1.7 times the speeds of the shared table.
    double least_share = .25, most_share = 3;
    double span = .5;  // seconds over which both ways are compared; chosen: five reports
    double least_way = sensing::radians(1);  // radians of progress; chosen: above the noise of encoders
    double progress = .3;                    // seconds for which progress lasts; chosen: three reports
    double longest_step = .5;                // seconds that one report counts at most; chosen: two reports
  };
  enum class Verdict : std::uint8_t { plausible, doubtful, parted };

  ReportWatch() = default;
  explicit ReportWatch(const Parameters& parameters) : parameters_(parameters) {}

  // Begins anew with the next report.
  void reset() { *this = ReportWatch(parameters_); }
  // Adds what was reported (radians; NaN: no number) for `time`, and what the commands make of that time: radians and
  // radians a second. latency: seconds from a command until it takes effect.
  Verdict add(Time time, double reported, double commanded, double speed, double latency);
  // After the axis was commanded to hold and has come to rest: whether its reports have followed the commands since the
  // last such time, so that the command may be taken to be where the head stands.
  bool take_rest(double reported, double commanded);
  // What the commands make of all times is shifted by this, radians.
  void shift(double by);

 private:
  struct Point {
    Time time{};
    double reported = 0, commanded = 0;
  };
  bool follows(const Point& now);
  bool progresses(const Point& now);

  Parameters parameters_;
  bool begun_ = false;
  Point last_, mark_;
  Time fast_{}, progressed_{};
  double fastest_ = 0, outside_ = 0;
  double nearest_ = 0;  // report since the axis is outside, on that side of the command
  double side_ = 0;
  bool follows_ = false;
  double commanded_way_ = 0, reported_way_ = 0;  // since take_rest()
};

// The angle that a report means: heads that report 0 to 360 degrees mean angles to the left by those above 180. Radians.
// Of reported + n 2 pi the one nearest to `commanded`, if it is within the limits and `reported` is not, each by
// 10 degrees; else `reported`.
double unwrapped(double reported, double commanded, const AxisLimits& limits);

}  // namespace cerberus::motion
