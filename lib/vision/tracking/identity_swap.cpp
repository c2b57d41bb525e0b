// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/identity_swap.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr double kApart = 0.3;  // S: how far two must have come apart to be two
constexpr double kStranger =
    0.25;  // as different as that, two well-known looks are two people's: see AppearanceModel
constexpr double kGain = 0.2;  // by so much less appearance_distance two must be with each other's identities
constexpr double kClose = 0.6;   // S: as near two are who may have been mixed up just now: they touch,
constexpr double kParted = 1.5;  // S/s: and so much farther apart they may be with every second since
constexpr double kLongest = 4;   // s since somebody was close, after which nobody was mixed up

bool may_be_each_other(const TrackHypothesis& a, const TrackHypothesis& b) {
  const double since = std::min(a.clear, b.clear) + std::max(a.unseen, b.unseen);
  return since < kLongest && std::hypot(a.x.position - b.x.position, a.y.position - b.y.position) <
                                 std::max(a.size(), b.size()) * (kClose + kParted * since);
}

// Where each is and how large stays with the body; who it is, and what is known of him, changes place.
void exchange(TrackHypothesis& a, TrackHypothesis& b) {
  std::swap(a.id, b.id);
  std::swap(a.look, b.look);
  std::swap(a.looked, b.looked);
  std::swap(a.age, b.age);
  std::swap(a.top_speed, b.top_speed);
  std::swap(a.origin, b.origin);
  std::swap(a.travelled, b.travelled);
  for (TrackHypothesis* p : {&a, &b}) {
    p->unlikeness = p->knows_recent() ? std::max(0.0, appearance_distance(p->look, p->recent)) : 0;
    p->age = std::max(p->age, p->unseen);
  }
}

// How much less appearance_distance themselves both are with each other's identities. Of somebody who is not seen alone nothing is
// said.
double gain(const TrackHypothesis& a, const TrackHypothesis& b) {
  const auto of = [](const TrackHypothesis& seen, const TrackHypothesis& other) {
    return seen.knows_recent()
               ? appearance_distance(seen.look, seen.recent) - appearance_distance(other.look, seen.recent)
               : 0;
  };
  return of(a, b) + of(b, a);
}

}  // namespace

bool apart(const TrackHypothesis& a, const TrackHypothesis& b) {
  const double both = std::min(a.age, b.age);
  if (!(both > 0)) return false;
  const double x = (a.x.position - a.origin.x) / a.age - (b.x.position - b.origin.x) / b.age;
  const double y = (a.y.position - a.origin.y) / a.age - (b.y.position - b.origin.y) / b.age;
  return std::hypot(x, y) * both > kApart * std::max(a.size(), b.size());
}

bool strangers(const TrackHypothesis& a, const TrackHypothesis& b) {
  return a.well_known() && b.well_known() && appearance_distance(a.look, b.look) > kStranger;
}

void swap_mistaken_identities(std::span<TrackHypothesis> bodies) {
  const auto known = [](const TrackHypothesis& b) { return b.id != 0 && !b.away && b.well_known(); };
  for (TrackHypothesis& a : bodies) {
    if (!known(a) || !a.knows_recent() || !a.doubted()) continue;
    TrackHypothesis* best = nullptr;
    double most = kGain;
    for (TrackHypothesis& b : bodies) {
      if (&a == &b || !known(b) || !may_be_each_other(a, b) || (b.knows_recent() && !b.doubted())) continue;
      const double more = gain(a, b);
      if (more <= most) continue;
      most = more;
      best = &b;
    }
    if (best) exchange(a, *best);
  }
}

}  // namespace cerberus::vision
