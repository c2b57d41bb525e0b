// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/identity_swap.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

// Could the one have become the other since their last contact?
bool within_reach(const TrackHypothesis& a, const TrackHypothesis& b, const IdentitySwapParameters& q) {
  const double since =
      std::min(a.appearance.since_contact, b.appearance.since_contact) + std::max(a.unseen, b.unseen);
  return since < q.longest && std::hypot(a.x.position - b.x.position, a.y.position - b.y.position) <
                                  std::max(a.size(), b.size()) * (q.contact + q.parting * since);
}

// Position and extent stay with the hypothesis; identity, appearance and history are exchanged.
void exchange(TrackHypothesis& a, TrackHypothesis& b) {
  std::swap(a.id, b.id);
  std::swap(a.appearance.model, b.appearance.model);
  std::swap(a.appearance.frames, b.appearance.frames);
  std::swap(a.appearance.learnt, b.appearance.learnt);
  std::swap(a.age, b.age);
  std::swap(a.top_speed, b.top_speed);
  std::swap(a.travel.origin, b.travel.origin);
  std::swap(a.travel.most, b.travel.most);
  for (TrackHypothesis* p : {&a, &b}) {
    TrackHypothesis::Appearance& look = p->appearance;
    look.change =
        p->has_recent_appearance() ? std::max(0.0, appearance_distance(look.model, look.recent)) : 0;
    p->age = std::max(p->age, p->unseen);
  }
}

// What an exchange saves in appearance distance, both together. A track without recent appearance adds nothing.
double saved(const TrackHypothesis& a, const TrackHypothesis& b) {
  const auto of = [](const TrackHypothesis& seen, const TrackHypothesis& other) {
    return seen.has_recent_appearance()
               ? appearance_distance(seen.appearance.model, seen.appearance.recent) -
                     appearance_distance(other.appearance.model, seen.appearance.recent)
               : 0;
  };
  return of(a, b) + of(b, a);
}

}  // namespace

bool went_apart(const TrackHypothesis& a, const TrackHypothesis& b) {
  const double both = std::min(a.age, b.age);
  if (!(both > 0)) return false;
  const double x = (a.x.position - a.travel.origin.x) / a.age - (b.x.position - b.travel.origin.x) / b.age;
  const double y = (a.y.position - a.travel.origin.y) / a.age - (b.y.position - b.travel.origin.y) / b.age;
  return std::hypot(x, y) * both > a.parameters->apart * std::max(a.size(), b.size());
}

bool look_different(const TrackHypothesis& a, const TrackHypothesis& b) {
  return a.has_appearance() && b.has_appearance() &&
         appearance_distance(a.appearance.model, b.appearance.model) > a.parameters->different;
}

void undo_identity_swaps(std::span<TrackHypothesis> tracks, const IdentitySwapParameters& parameters) {
  const auto known = [](const TrackHypothesis& t) { return t.in_view() && t.has_appearance(); };
  for (TrackHypothesis& a : tracks) {
    if (!known(a) || !a.has_recent_appearance() || !a.is_ambiguous()) continue;
    TrackHypothesis* best = nullptr;
    double most = parameters.gain;
    for (TrackHypothesis& b : tracks) {
      if (&a == &b || !known(b) || !within_reach(a, b, parameters) ||
          (b.has_recent_appearance() && !b.is_ambiguous()))
        continue;
      const double gain = saved(a, b);
      if (gain <= most) continue;
      most = gain;
      best = &b;
    }
    if (best) exchange(a, *best);
  }
}

}  // namespace cerberus::vision
