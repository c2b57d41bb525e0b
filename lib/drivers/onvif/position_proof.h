// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether the positions that a camera reports follow its turns: some cameras always report the same one (0, 0). Until a
// report has changed, the positions are not proven; they are false once the camera has turned by its commands and none has
// changed. One that changes later proves them after all: a camera at its mechanical stop cannot follow its commands.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "motion/pan_tilt.h"
#include "motion/pose.h"

namespace cerberus::drivers {

class PositionProof {
 public:
  using Time = motion::Time;
  using PanTilt = motion::PanTilt;
  struct Parameters {
    double change = .5;  // degrees between two reports; derived: cameras round to tenths of a degree
    double travel =
        5;  // degrees by its commands; derived: below the 10 degrees that make a fault of a wrong report
    // From the travel to the report that should show it. derived: a dead time of 500 ms, and a status as old.
    // Guarded by unit-onvif_head.
    Time patience = std::chrono::milliseconds(1000);
  };

  // A report (degrees) that was asked for at `asked`, while the commands had turned the camera to `reckoned` (degrees).
  void add(const PanTilt& reported, const PanTilt& reckoned, Time asked) {
    constexpr Parameters kParameters{};
    const auto apart = [](const PanTilt& a, const PanTilt& b) {
      return std::max(std::abs(a.pan - b.pan), std::abs(a.tilt - b.tilt));
    };
    if (!first_) first_ = {reported, reckoned};
    if (apart(reported, first_->reported) > kParameters.change) state_ = State::proven;
    if (state_ == State::unproven && !travelled_ && apart(reckoned, first_->reckoned) >= kParameters.travel)
      travelled_ = asked;
    if (state_ == State::unproven && travelled_ && asked - *travelled_ >= kParameters.patience)
      state_ = State::wrong;
  }
  // How far the commands have turned the camera since the first report, degrees.
  PanTilt travel(const PanTilt& reckoned) const {
    if (!first_) return {};
    return {reckoned.pan - first_->reckoned.pan, reckoned.tilt - first_->reckoned.tilt};
  }
  bool proven() const { return state_ == State::proven; }
  bool wrong() const { return state_ == State::wrong; }

 private:
  enum class State : std::uint8_t { unproven, proven, wrong } state_ = State::unproven;
  struct Report {
    PanTilt reported, reckoned;
  };
  std::optional<Report> first_;
  std::optional<Time> travelled_;
};

}  // namespace cerberus::drivers
