// SPDX-License-Identifier: LGPL-2.1-or-later
// Selects the goal of the head for each frame. The goal comes from the fusion decision on the frame; without one the
// selector applies the two rules that need no sensors (rule 1: follow a track; rule 7: without a track return to zero).
// The track chosen by the application takes precedence over both.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "control/law.h"
#include "fusion/fuser.h"
#include "fusion/target_override.h"

namespace cerberus::control {

// A decision of sensor fusion, received with a frame or between two frames. `made.rule_name` must stay valid.
struct FusionDecision {
  fusion::Decision made;
  std::optional<fusion::Time> decided;  // running time until which sensors were read; nullopt: unknown
};

// The tracks and the decision that a frame carries.
struct Observation {
  std::span<const fusion::Track> tracks;
  std::optional<FusionDecision> fusion;
};

class TargetSelector {
 public:
  struct Selection {
    Goal goal;
    std::string reason;      // for a user
    std::uint32_t lost = 0;  // the chosen track that is given up with this frame; 0: none
  };
  void set_options(const fusion::FuserOptions& options) { fuser_.set_options(options); }
  // Clears time and tracks for a new stream. The chosen track stays.
  void reset();
  // Chooses the track to follow; 0: the automatic choice. decided: the decisions on the frames take the choice into
  // account, and begin and end it there; without a decision on the frame it is made here all the same.
  void follow(std::uint32_t id, bool decided = false) {
    override_.choose(id);
    decided_elsewhere_ = decided;
  }
  // Returns the selection for a frame. time: its running time; pan: the head's pan when it was taken, radians.
  Selection on_frame(const Observation& frame, motion::Time time, double pan);
  // Processes a decision between two frames as if the last frame had carried it. It takes precedence over frames that
  // were decided earlier (they arrive late, through queues). Returns nullopt if it is not newer than the last one, if
  // the last frame carried none, or if it follows a track and takes effect with the next frame.
  std::optional<Selection> on_decision(const FusionDecision& decision);

 private:
  void apply_override(const Observation& frame, motion::Time time, Selection& selection);

  fusion::Fuser fuser_;
  fusion::TargetOverride override_;
  std::optional<FusionDecision> between_;  // newer than the last frame's
  std::optional<fusion::Time> decided_;    // of the last decision in force; nullopt: the last frame had none
  bool decided_elsewhere_ = false;         // the choice, by the decisions on the frames
  bool following_ = false;                 // the chosen track was on the last frame
};

}  // namespace cerberus::control
