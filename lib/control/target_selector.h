// SPDX-License-Identifier: LGPL-2.1-or-later
// From one frame to a goal of the head. The goal comes from the fusion decision on the frame; without one it is decided
// here by the two rules that need no sensors (rule 1: track what the camera sees; rule 7: nothing seen, return to zero).
// The track that the application chose goes before both.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "control/law.h"
#include "fusion/fuser.h"
#include "fusion/target_override.h"

namespace cerberus::control {

// A decision of sensor fusion as it comes with a frame or between two of them. `made.rule_name` must stay valid.
struct FusionDecision {
  fusion::Decision made;
  std::optional<fusion::Time> decided;  // running time until which sensors were read; nothing: not known
};

// What a frame carries.
struct Observation {
  std::span<const fusion::Track> tracks;
  std::optional<FusionDecision> fusion;
};

class TargetSelector {
 public:
  struct Selection {
    Goal goal;
    std::string reason;      // for a user
    std::uint32_t lost = 0;  // the chosen track that was given up with this frame; 0: none
  };
  void set_options(const fusion::FuserOptions& options) { fuser_.set_options(options); }
  // Forgets time and tracks: another stream begins. The chosen track stays.
  void reset();
  // Chooses the track to be followed; 0: the usual choice.
  void follow(std::uint32_t id) { override_.choose(id); }
  // time: running time of the frame; pan: radians, when it was taken.
  Selection on_frame(const Observation& frame, motion::Time time, double pan);
  // A decision between two frames counts as if the last frame had carried it, and goes before frames that were decided
  // earlier (they come late, through queues). Nothing: it is not newer than the last one, the last frame carried none,
  // or it is about a point of a picture and takes effect with the next frame.
  std::optional<Selection> on_decision(const FusionDecision& decision);

 private:
  void apply_override(const Observation& frame, motion::Time time, Selection& selection);

  fusion::Fuser fuser_;
  fusion::TargetOverride override_;
  std::optional<FusionDecision> between_;  // newer than the last frame's
  std::optional<fusion::Time>
      decided_;             // of the last decision that counted; nothing: the last frame had none
  bool following_ = false;  // the chosen track was on the last frame
};

}  // namespace cerberus::control
