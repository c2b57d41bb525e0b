// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds out whether a head stops by itself when its helper is killed: it turns at `speed` for `lead`, then without a
// helper for at most `patience`, and at last until a new helper has stopped it. Decides only; the caller commands the
// head, kills its helper and measures the picture. Seconds of one clock are parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "motion/speed_map.h"

namespace cerberus::control {

struct TimeoutTrialParameters {
  // Degrees a second, the best first. derived: slow, since nothing can stop the head meanwhile; the picture measures 2.
  std::vector<double> speeds{4, 2};
  double lead = 1;       // seconds; derived: a dead time of 500 ms, and as long to be seen turning
  double patience = 3;   // seconds; derived: longer than the Timeout that a driver asks its device for
  double restart = 5.5;  // seconds until a new helper has stopped the head; derived: a start may take
                         // drivers::HelperWatch::Parameters::start, and then comes a dead time of 500 ms
  double still =
      0.3;  // seconds without motion after which the head has stopped; derived: 4 frames at 15 a second
  unsigned frames = 4;  // measured ones without motion that span `still`; derived: 15 a second
  double least = 0.01;  // of the commanded speed, radians a frame: less is noise of the measurement
};

struct TimeoutTrial {
  double speed = 0;  // radians a second as commanded, of either sign
  double lead = 0;   // seconds
};

// Plans the trial of an axis at `position` (radians, from the middle of its reach) so that it stays within `reach` to
// either side even if the device never stops by itself. nullopt: there is no room for it.
std::optional<TimeoutTrial> plan_timeout_trial(const motion::SpeedMap& speeds, double position, double reach,
                                               const TimeoutTrialParameters& parameters = {});

// Follows the head through the trial.
class TimeoutWatch {
 public:
  enum class End : std::uint8_t {
    none,     // the trial goes on
    stopped,  // by itself
    turns,    // it did not stop in time, or went to the end of its reach: a new helper must stop it
    unseen,   // the picture did not show it turning, or not what it did without its helper: nothing is known
    key,      // a key was pressed: nothing is known
  };
  TimeoutWatch(const TimeoutTrial& trial, double position, double reach,
               const TimeoutTrialParameters& parameters = {})
      : parameters_(parameters), trial_(trial), reach_(reach), position_(position) {}

  // A frame that came at `now`: radians that the picture turned since the one before; NaN: not measured.
  void add(double now, double turn);
  void press_key() { key_ = true; }
  // The helper was killed at `now`.
  void kill(double now) { killed_ = measured_ = now; }
  // How the trial ends at `now`. Before the helper is killed only `turns`, at the end of the reach, and `key` end it.
  End end(double now) const;
  double stopped_after() const { return still_from_ - *killed_; }  // seconds, of End::stopped

 private:
  TimeoutTrialParameters parameters_;
  TimeoutTrial trial_;
  double reach_, position_;
  std::optional<double> killed_;
  // Since the helper was killed: the frames without motion that were measured last, without a gap of `still` between.
  unsigned still_frames_ = 0;
  double still_from_ = 0, measured_ = 0;  // the first of them; the last measured frame
  bool turned_ = false;                   // in the last measured frame
  bool seen_ = false;                     // turning, before the helper was killed
  bool key_ = false;
};

}  // namespace cerberus::control
