// SPDX-License-Identifier: LGPL-2.1-or-later
#include "target_selector.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>

#include "shared/choices.hpp"
#include "shared/tracks.hpp"

namespace cerberus::plugin {

namespace {

std::string because(int rule, std::string_view name, fusion::Action action, guint target) {
  std::string text = rule > 0 ? "rule " + std::to_string(rule) : std::string("rule");
  text.append(" (").append(name).append("): ").append(fusion::name(action));
  if (action == fusion::Action::track) text.append(" ").append(std::to_string(target));
  return text;
}

}  // namespace

std::optional<vision::Point> TargetSelector::middle_of(guint id) const {
  const auto found = std::ranges::find(tracks_, id, &fusion::Track::id);
  if (found == tracks_.end()) return std::nullopt;
  return vision::Point{found->x + found->width / 2, found->y + found->height / 2};
}

TargetSelector::Verdict TargetSelector::obey(const CerberusFusion& fusion) const {
  const fusion::Action action = heard(fusion.action);
  Verdict verdict;
  verdict.wish.action = action;
  verdict.wish.sector = {sensing::radians(fusion.sector_from), sensing::radians(fusion.sector_to)};
  if (action == fusion::Action::track) verdict.wish.target = middle_of(fusion.target);
  verdict.reason = because(fusion.rule, fusion.rule_name, action, fusion.target);
  return verdict;
}

TargetSelector::Verdict TargetSelector::decide(motion::Time time, double pan) {
  const fusion::Decision& decision =
      fuser_.update({.time = time, .tracks = tracks_, .sensors = {}, .pan = pan});
  Verdict verdict;
  verdict.wish.action = decision.action;
  if (decision.action == fusion::Action::track) verdict.wish.target = middle_of(decision.target);
  verdict.reason = because(decision.rule, decision.rule_name, decision.action, decision.target);
  return verdict;
}

// Whom the application chose goes before the usual verdict, which is found all the same: it goes on when the choice
// ends, and sensors may know where somebody went whom the camera has lost.
void TargetSelector::prefer(motion::Time time, Verdict& verdict) {
  const guint id = chosen_.id();
  follows_ = false;
  if (id == 0) return;
  using enum fusion::Chosen::Answer;
  const std::optional<vision::Point> middle = middle_of(id);
  const fusion::Chosen::Answer answer = chosen_.watch(middle.has_value(), time);
  if (answer == lost) verdict.lost = id;
  follows_ = answer == here;
  if (follows_) {
    verdict.wish = {.action = fusion::Action::track, .target = middle};
    verdict.reason = "told to follow " + std::to_string(id);
  } else if (answer == awaited && verdict.wish.action == fusion::Action::track) {
    verdict.wish = {};
    verdict.reason = "waits for " + std::to_string(id) + ", which it was told to follow";
  }
}

void TargetSelector::reset() {
  fuser_.reset();
  chosen_.restart();
  between_.reset();
  decided_.reset();
}

TargetSelector::Verdict TargetSelector::look(GstBuffer* frame, motion::Time time, double pan) {
  read_tracks(frame, tracks_);
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(frame);
  const bool dated = fusion && GST_CLOCK_TIME_IS_VALID(fusion->decided);
  if (!dated || (between_ && between_->decided <= fusion->decided)) between_.reset();
  if (between_) fusion = &*between_;
  decided_.reset();
  if (dated) decided_ = fusion->decided;
  Verdict verdict = fusion ? obey(*fusion) : decide(time, pan);
  prefer(time, verdict);
  return verdict;
}

std::optional<TargetSelector::Verdict> TargetSelector::heed(const CerberusFusion& fusion) {
  if (!decided_ || fusion.decided <= *decided_) return std::nullopt;
  between_ = fusion;
  decided_ = fusion.decided;
  if (follows_ || fusion.action == CERBERUS_FUSION_TRACK) return std::nullopt;
  return obey(fusion);
}

}  // namespace cerberus::plugin
