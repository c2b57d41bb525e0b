// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/follower.h"

#include <algorithm>
#include <cmath>

namespace cerberus::fusion {

namespace {

constexpr int kWorstRank = 5;  // of rank()

// derived: as long as the default camera-hold bridges a missing track; somebody who walks at 1.4 m/s goes 8 % of the
// picture's width meanwhile (8 m away, 60 degrees). Guard: tests/unit/follower.cpp.
constexpr Time kTakeover = std::chrono::milliseconds(500);

// The lower the better: a person precedes what only moves, a seen track a stopped one; a coasted track comes last.
int rank(const Track& track) {
  if (track.state == TrackState::coasted) return track.person ? 4 : 5;
  return (track.person ? 0 : 2) + (track.state == TrackState::stopped ? 1 : 0);
}

// Returns whether a is a better target than b, of tracks of one rank. By nearness without distances the lower edges of the
// boxes are compared: lower in the picture is nearer on a floor.
bool better(const Track& a, const Track& b, TargetChoice choice, bool by_distance) {
  const double size_a = a.width * a.height, size_b = b.width * b.height;
  switch (choice) {
    case TargetChoice::nearest: {
      const double near_a = by_distance ? -a.distance : a.y + a.height;
      const double near_b = by_distance ? -b.distance : b.y + b.height;
      if (near_a != near_b) return near_a > near_b;
      break;
    }
    case TargetChoice::newest:
      if (a.age != b.age) return a.age < b.age;
      break;
    case TargetChoice::largest:
      break;
  }
  return size_a != size_b ? size_a > size_b : a.id < b.id;
}

}  // namespace

void Follower::watch(std::span<const Track> tracks, Time time, TargetChoice choice, Time hold_stopped) {
  const auto counts = [this](const Track& track) {
    return track.id != 0 && std::ranges::find(tired_, track.id) == tired_.end();
  };
  const Track* kept = nullptr;
  bool person = false, person_seen = false;
  int first = kWorstRank;
  for (const Track& track : tracks) {
    if (track.state == TrackState::seen) std::ranges::replace(tired_, track.id, 0U);
    if (!counts(track)) continue;
    if (track.id == followed_) kept = &track;
    person |= track.person;
    person_seen |= track.person && track.state == TrackState::seen;
    first = std::min(first, rank(track));
  }
  // Distances are used only where they are known of all: the choice must not depend on the order of the tracks.
  const auto candidate = [&](const Track& track) { return counts(track) && rank(track) == first; };
  const bool by_distance = std::ranges::all_of(
      tracks, [&](const Track& track) { return !candidate(track) || std::isfinite(track.distance); });
  const Track* best = nullptr;
  for (const Track& track : tracks)
    if (candidate(track) && (best == nullptr || better(track, *best, choice, by_distance))) best = &track;

  if (!person)
    person_ = kLongAgo;
  else if (person_seen && person_ == kLongAgo)
    person_ = time;
  if (kept != nullptr && !kept->person && person_seen && !within(kTakeover, person_, time)) kept = nullptr;
  if (kept != nullptr) {
    if (kept->state == TrackState::seen) stopped_ = kLongAgo;
    if (kept->state == TrackState::stopped && stopped_ == kLongAgo) stopped_ = time;
    if (kept->state != TrackState::seen && stopped_ != kLongAgo && !within(hold_stopped, stopped_, time)) {
      tired_[tired_next_++ % tired_.size()] = kept->id;
      followed_ = 0;
      stopped_ = kLongAgo;
      return watch(tracks, time, choice,
                   hold_stopped);  // at most once for each given-up track, which is then skipped
    }
  } else if (best != nullptr) {
    followed_ = best->id;
    stopped_ = best->state == TrackState::stopped ? time : kLongAgo;
    kept = best;
  }
  here_ = kept != nullptr;
  if (kept != nullptr) found_ = time;
}

}  // namespace cerberus::fusion
