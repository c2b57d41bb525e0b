// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/target_selector.h"

#include <algorithm>

namespace cerberus::control {

namespace {

std::optional<vision::Point> middle_of(std::span<const fusion::Track> tracks, std::uint32_t id) {
  const auto found = std::ranges::find(tracks, id, &fusion::Track::id);
  if (found == tracks.end()) return std::nullopt;
  return vision::Point{found->x + found->width / 2, found->y + found->height / 2};
}

std::string reason_of(const fusion::Decision& decision) {
  std::string text = decision.rule > 0 ? "rule " + std::to_string(decision.rule) : std::string("rule");
  text.append(" (").append(decision.rule_name).append("): ").append(fusion::name(decision.action));
  if (decision.action == fusion::Action::track) text.append(" ").append(std::to_string(decision.target));
  return text;
}

TargetSelector::Selection selection_of(const fusion::Decision& decision,
                                       std::span<const fusion::Track> tracks) {
  TargetSelector::Selection selection;
  selection.goal.action = decision.action;
  selection.goal.sector = decision.sector;
  selection.goal.immediate = decision.immediate;
  if (decision.action == fusion::Action::track) {
    selection.goal.target = middle_of(tracks, decision.target);
    selection.goal.track = decision.target;
  }
  selection.reason = reason_of(decision);
  return selection;
}

}  // namespace

// Replaces the automatic selection by the chosen track. The automatic selection is made first in any case: it continues
// when the override ends, and while the chosen track is awaited its turn towards a sensor's detection is useful.
void TargetSelector::apply_override(const Observation& frame, motion::Time time, Selection& selection) {
  const std::uint32_t id = override_.id();
  following_ = false;
  if (id == 0) return;
  using enum fusion::TargetOverride::Answer;
  const std::optional<vision::Point> middle = middle_of(frame.tracks, id);
  const fusion::TargetOverride::Answer answer = override_.watch(middle.has_value(), time);
  if (answer == lost) selection.lost = id;
  following_ = answer == here;
  if (decided_elsewhere_ && frame.fusion) return;
  if (following_) {
    selection.goal = {.action = fusion::Action::track, .target = middle, .track = id};
    selection.reason = "follows the chosen track " + std::to_string(id);
  } else if (answer == awaited && selection.goal.action == fusion::Action::track) {
    selection.goal = {};
    selection.reason = "waits for the chosen track " + std::to_string(id);
  }
}

void TargetSelector::reset() {
  fuser_.reset();
  override_.restart();
  between_.reset();
  decided_.reset();
}

TargetSelector::Selection TargetSelector::on_frame(const Observation& frame, motion::Time time, double pan) {
  const FusionDecision* decision = frame.fusion ? &*frame.fusion : nullptr;
  const bool dated = decision && decision->decided;
  if (!dated || (between_ && *between_->decided <= *decision->decided)) between_.reset();
  if (between_) decision = &*between_;
  decided_.reset();
  if (dated) decided_ = decision->decided;
  Selection selection = selection_of(
      decision ? decision->made
               : fuser_.update({.time = time, .tracks = frame.tracks, .sensors = {}, .pan = pan}),
      frame.tracks);
  apply_override(frame, time, selection);
  return selection;
}

std::optional<TargetSelector::Selection> TargetSelector::on_decision(const FusionDecision& decision) {
  if (!decided_ || !decision.decided || *decision.decided <= *decided_) return std::nullopt;
  between_ = decision;
  decided_ = decision.decided;
  if (following_ || decision.made.action == fusion::Action::track) return std::nullopt;
  return selection_of(decision.made, {});
}

}  // namespace cerberus::control
