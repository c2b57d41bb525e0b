// SPDX-License-Identifier: LGPL-2.1-or-later
// Divides the turn of the picture between a head and the base that carries it, where nothing measures the base's turn.
//
//   rate                 (turn of the picture - reckoned turn of the head) / time, smoothed
//   fastest              speed that the head was commanded in the last `settle` and as long before
//   the head rests       fastest = 0: it did not turn, and the picture's turn is the base's
//   the base turns       the rate was above turning + most_error fastest, which no head explains, and has not been below
//                        `standing` (or `share` of the head's speed) for `calm` since: the picture shows nothing of the head
//   else                 the picture's turn is the head's
//
// A slower base hides in the errors of the head's speeds, and its turn goes into the head's pose. It shows in the sums over
// the frames in which the picture's turn is taken for the head's, each forgotten with the time constant `memory`:
//
//   D = sum of (turn of the picture - reckoned turn),  S = sum of reckoned turns,  F = largest `fastest`
//   ambiguous            |D| > slack + explained (|S| + settle F) + settle F: more than wrong speeds and a late camera make of it
//
// A head that moves while the base turns cannot be told from one that does not obey: its turn is then known from its
// commands alone. Pure; allocates nothing.
#pragma once

#include <optional>

#include "control/base_rate.h"

namespace cerberus::control {

class TurnDivision {
 public:
  struct Parameters {
    // Seconds after the reckoned end of a motion. chosen: cameras are late by up to half a second more than their dead time.
    double settle = .5;
    double turning = sensing::radians(5);  // a second; as what makes PIR sensors doubtful
    // swept with emulated heads: at 1 a camera a second late is taken for a base that turns, at 2 a base is found late.
    // Guard: bench-heads (tests/bench/closed_loop.cpp)
    double most_error = 1.5;
    double standing = sensing::radians(3);  // a second; chosen: below `turning` by its noise
    double share = .3;      // of the head's speed; derived: two of three speeds are known to 15 %
    double smoothing = .1;  // seconds; chosen: three frames
    double calm = .3;       // seconds; chosen: longer than a base takes to turn round
    double ambiguous = .5;  // seconds of head and base turning before it is reported; chosen: not for a jolt
    // Seconds. chosen: a base at 2 degrees a second is found beside a head at 20, and turns of two minutes ago count no more.
    double memory = 20;
    double explained = .5;  // of the head's turn; derived: the slowest shared speed tables are wrong by half
    // derived: less than the uncertainty at which a reference is lost (PoseEstimate). Guard of the three: unit-turn_division
    double slack = sensing::radians(5);
    double longest_step = 1;  // seconds from frame to frame; after that the base's rate is not known
  };

  TurnDivision() = default;
  explicit TurnDivision(const Parameters& parameters) : parameters_(parameters) {}

  // Returns the head's turn since the frame before as the picture shows it; nothing: it does not show it. taken: time of
  // the frame; reckoned: the head's turn by its commands; speed: the larger one of its axes that a command may be giving
  // it, radians a second; seen: turn of the picture.
  std::optional<Turn> head(motion::Time taken, const motion::PanTilt& reckoned, double speed,
                           const std::optional<Turn>& seen);
  // Whether base and head have both turned, so that the picture could not tell what the head does.
  bool ambiguous() const { return both_ >= parameters_.ambiguous || hidden_; }

 private:
  void sum(double step, double reckoned, double difference, double fastest);

  Parameters parameters_;
  std::optional<motion::Time> last_;
  double calm_ = 0, both_ = 0;             // seconds
  double rate_ = 0;                        // of the base, radians a second
  double difference_ = 0, reckoned_ = 0;   // radians: D and S
  double fastest_ = 0;                     // radians a second: F
  bool hidden_ = false;                    // a base has turned in D
  double fast_now_ = 0, fast_before_ = 0;  // radians a second, since `span_` and in the span before
  motion::Time span_{};                    // begin of a span of `settle`
  bool base_turns_ = false;
};

}  // namespace cerberus::control
