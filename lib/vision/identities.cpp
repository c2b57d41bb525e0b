// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/identities.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr double kApart = 0.3;      // S: how far two must have come apart to be two
constexpr double kStranger = 0.25;  // as different as that, two well-known looks are two people's: see Look
constexpr double kGain = 0.2;       // by so much less unlike two must be with each other's identities
constexpr double kClose = 0.6;      // S: as near two are who may have been mixed up just now: they touch,
constexpr double kParted = 1.5;     // S/s: and so much farther apart they may be with every second since
constexpr double kLongest = 4;      // s since somebody was close, after which nobody was mixed up

bool may_be_each_other(const Body& a, const Body& b) {
  const double since = std::min(a.clear, b.clear) + std::max(a.unseen, b.unseen);
  return since < kLongest && std::hypot(a.x.position - b.x.position, a.y.position - b.y.position) <
                                 std::max(a.size(), b.size()) * (kClose + kParted * since);
}

// Where each is and how large stays with the body; who it is, and what is known of him, changes place.
void exchange(Body& a, Body& b) {
  std::swap(a.id, b.id);
  std::swap(a.look, b.look);
  std::swap(a.looked, b.looked);
  std::swap(a.age, b.age);
  std::swap(a.top_speed, b.top_speed);
  std::swap(a.origin, b.origin);
  std::swap(a.travelled, b.travelled);
  for (Body* p : {&a, &b}) {
    p->unlikeness = p->knows_recent() ? std::max(0.0, unlike(p->look, p->recent)) : 0;
    p->age = std::max(p->age, p->unseen);
  }
}

// How much less unlike themselves both are with each other's identities. Of somebody who is not seen alone nothing is
// said.
double gain(const Body& a, const Body& b) {
  const auto of = [](const Body& seen, const Body& other) {
    return seen.knows_recent() ? unlike(seen.look, seen.recent) - unlike(other.look, seen.recent) : 0;
  };
  return of(a, b) + of(b, a);
}

}  // namespace

bool apart(const Body& a, const Body& b) {
  const double both = std::min(a.age, b.age);
  if (!(both > 0)) return false;
  const double x = (a.x.position - a.origin.x) / a.age - (b.x.position - b.origin.x) / b.age;
  const double y = (a.y.position - a.origin.y) / a.age - (b.y.position - b.origin.y) / b.age;
  return std::hypot(x, y) * both > kApart * std::max(a.size(), b.size());
}

bool strangers(const Body& a, const Body& b) {
  return a.well_known() && b.well_known() && unlike(a.look, b.look) > kStranger;
}

void settle_identities(std::span<Body> bodies) {
  const auto known = [](const Body& b) { return b.id != 0 && !b.away && b.well_known(); };
  for (Body& a : bodies) {
    if (!known(a) || !a.knows_recent() || !a.doubted()) continue;
    Body* best = nullptr;
    double most = kGain;
    for (Body& b : bodies) {
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
