// SPDX-License-Identifier: LGPL-2.1-or-later
// Judges how a camera follows one person: the same words as other projects' benches use.
#pragma once

#include <optional>

#include "sensing/angles.h"

namespace cerberus::sim {

class Score {
 public:
  struct Parameters {
    double reversal = sensing::radians(.1);   // a camera that went back by less did not reverse
    double centred = sensing::radians(2.5);   // from the optical axis
    double centred_for = .5;                  // seconds
    double half_view = sensing::radians(30);  // beyond: out of the picture
    double skip = 3;  // seconds; what comes before counts for seen() and centred() only
  };
  explicit Score(const Parameters& parameters) : parameters_(parameters) {}

  // Adds one moment of an evenly spaced series. off: of the person from the optical axis; camera: the head's angle;
  // published: where the head says that it looked then. Radians.
  void add(double seconds, double off, double camera, double published);

  double rms() const;         // of `off`, radians, also while the person is out of the picture
  double lost() const;        // share of time out of the picture, 0 to 1
  double reversals() const;   // of the camera, a minute
  double pose_error() const;  // RMS of published - camera, radians
  // Seconds until the person was in the picture, and until it was and stayed in its middle; nothing: never.
  std::optional<double> seen() const { return seen_; }
  std::optional<double> centred() const { return centred_; }

 private:
  void count_reversals(double camera);

  Parameters parameters_;
  long count_ = 0, out_ = 0, reversals_ = 0;
  double squares_ = 0, pose_squares_ = 0;
  double first_ = 0, last_ = 0;  // seconds, of what is judged
  double extreme_ = 0;           // of the camera since it last reversed
  int direction_ = 0;
  std::optional<double> seen_, centred_, near_since_;
};

}  // namespace cerberus::sim
