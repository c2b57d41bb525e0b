// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pilot.hpp"

#include <cerberus/cerberus.h>

#include <memory>

#include "fusion/tracks.hpp"

namespace cerberus::plugin {

namespace {

struct RegionsDeleter {
  void operator()(GPtrArray* regions) const { g_ptr_array_unref(regions); }
};

// Calls visit(region) for each tracked region of the frame.
template <typename Visit>
void each_track(GstBuffer* frame, Visit visit) {
  const std::unique_ptr<GPtrArray, RegionsDeleter> regions(cerberus_buffer_get_regions(frame));
  for (guint i = 0; i < regions->len; ++i) {
    const auto* region = static_cast<const CerberusRegion*>(g_ptr_array_index(regions.get(), i));
    if (region->tracked) visit(*region);
  }
}

std::optional<vision::Point> middle_of(GstBuffer* frame, guint id) {
  std::optional<vision::Point> middle;
  each_track(frame, [&](const CerberusRegion& region) {
    if (region.id == id) middle = {region.x + region.width / 2, region.y + region.height / 2};
  });
  return middle;
}

// The C API's actions are lib's, number by number.
static_assert(static_cast<int>(fusion::Action::track) == CERBERUS_FUSION_TRACK &&
              static_cast<int>(fusion::Action::turn_left) == CERBERUS_FUSION_TURN_LEFT &&
              static_cast<int>(fusion::Action::turn_right) == CERBERUS_FUSION_TURN_RIGHT &&
              static_cast<int>(fusion::Action::search) == CERBERUS_FUSION_SEARCH &&
              static_cast<int>(fusion::Action::zero) == CERBERUS_FUSION_ZERO &&
              static_cast<int>(fusion::Action::hold) == CERBERUS_FUSION_HOLD);
static_assert(static_cast<int>(fusion::TrackState::coasted) == CERBERUS_REGION_COASTED &&
              static_cast<int>(fusion::TrackState::stopped) == CERBERUS_REGION_STOPPED);

std::string because(int rule, std::string_view name, fusion::Action action, guint target) {
  std::string text = rule > 0 ? "rule " + std::to_string(rule) : std::string("rule");
  text.append(" (").append(name).append("): ").append(fusion::name(action));
  if (action == fusion::Action::track) text.append(" ").append(std::to_string(target));
  return text;
}

}  // namespace

Pilot::Verdict Pilot::obey(GstBuffer* frame, const CerberusFusion& fusion) {
  const auto action = static_cast<fusion::Action>(fusion.action);
  Verdict verdict;
  verdict.wish.action = action;
  verdict.wish.sector = {sensing::radians(fusion.sector_from), sensing::radians(fusion.sector_to)};
  if (action == fusion::Action::track) verdict.wish.target = middle_of(frame, fusion.target);
  verdict.reason = because(fusion.rule, fusion.rule_name, action, fusion.target);
  return verdict;
}

Pilot::Verdict Pilot::decide(GstBuffer* frame, control::Time time, double pan) {
  read_tracks(frame, tracks_);
  const fusion::Decision& decision =
      fuser_.update({.time = time, .tracks = tracks_, .sensors = {}, .pan = pan});
  Verdict verdict;
  verdict.wish.action = decision.action;
  if (decision.action == fusion::Action::track) verdict.wish.target = middle_of(frame, decision.target);
  verdict.reason = because(decision.rule, decision.rule_name, decision.action, decision.target);
  return verdict;
}

// Whom the application chose goes before the usual verdict, which is found all the same: it goes on when the choice ends, and
// sensors may know where somebody went whom the camera has lost.
void Pilot::prefer(GstBuffer* frame, control::Time time, Verdict& verdict) {
  const guint id = chosen_.id();
  if (id == 0) return;
  using enum fusion::Chosen::Answer;
  const std::optional<vision::Point> middle = middle_of(frame, id);
  const fusion::Chosen::Answer answer = chosen_.watch(middle.has_value(), time);
  if (answer == lost) verdict.lost = id;
  if (answer == here) {
    verdict.wish = {.action = fusion::Action::track, .target = middle};
    verdict.reason = "told to follow " + std::to_string(id);
  } else if (answer == awaited && verdict.wish.action == fusion::Action::track) {
    verdict.wish = {};
    verdict.reason = "waits for " + std::to_string(id) + ", which it was told to follow";
  }
}

void Pilot::reset() {
  fuser_.reset();
  chosen_.restart();
}

Pilot::Verdict Pilot::look(GstBuffer* frame, control::Time time, double pan) {
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(frame);
  Verdict verdict = fusion ? obey(frame, *fusion) : decide(frame, time, pan);
  prefer(frame, time, verdict);
  return verdict;
}

}  // namespace cerberus::plugin
