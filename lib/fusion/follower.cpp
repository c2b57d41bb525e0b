// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/follower.h"

#include <algorithm>
#include <cmath>

namespace cerberus::fusion {

namespace {

int rank(TrackState state) {
  switch (state) {
    case TrackState::seen:
      return 0;
    case TrackState::stopped:
      return 1;
    case TrackState::coasted:
      break;
  }
  return 2;
}

// Returns whether a is a better target than b: a person precedes what only moves, a seen track a stopped one, and that a
// coasted one; then `choice` decides. Without known distances the lower edges of the boxes are compared: lower in the picture is nearer
// on a floor.
bool better(const Track& a, const Track& b, TargetChoice choice) {
  if (a.person != b.person) return a.person;
  if (rank(a.state) != rank(b.state)) return rank(a.state) < rank(b.state);
  const double size_a = a.width * a.height, size_b = b.width * b.height;
  switch (choice) {
    case TargetChoice::nearest: {
      const bool known_a = std::isfinite(a.distance), known_b = std::isfinite(b.distance);
      if (known_a != known_b) return known_a;
      const double near_a = known_a ? -a.distance : a.y + a.height;
      const double near_b = known_b ? -b.distance : b.y + b.height;
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
  const Track* best = nullptr;
  const Track* kept = nullptr;
  for (const Track& track : tracks) {
    if (track.id == 0) continue;
    const auto tired = std::ranges::find(tired_, track.id);
    if (tired != tired_.end()) {
      if (track.state != TrackState::seen) continue;
      *tired = 0;
    }
    if (track.id == followed_) kept = &track;
    if (best == nullptr || better(track, *best, choice)) best = &track;
  }

  if (kept != nullptr && best->person && !kept->person) kept = nullptr;
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
