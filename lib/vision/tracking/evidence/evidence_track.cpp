// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/evidence/evidence_track.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "vision/tracking/evidence/picture_follower.h"

namespace cerberus::vision {

namespace {

constexpr double kFirstPlace = 0.1,
                 kFirstHeight = 0.1;  // standard deviations of a first box: pixels, logarithm
constexpr double kTravelTime = 1;     // s

Point middle_of(const Box& box) {
  return {box.x + box.width / 2, box.y + box.height / 2};
}

// By which the transform enlarges what is at this point.
double scale_at(const Transform& t, const Point& p) {
  const Point o = t.apply(p), x = t.apply({p.x + 1, p.y}), y = t.apply({p.x, p.y + 1});
  return std::sqrt(std::abs((x.x - o.x) * (y.y - o.y) - (x.y - o.y) * (y.x - o.x)));
}

}  // namespace

EvidenceTrack EvidenceTrack::begin(const Box& box) {
  EvidenceTrack t;
  t.set_box(box);
  t.places_[t.next_++] = t.rest_;
  return t;
}

void EvidenceTrack::set_box(const Box& box) {
  const Point to = middle_of(box);
  if (height > 0) {
    way_.x += (to.x - centre.x) / height, way_.y += (to.y - centre.y) / height;
    growth_.x += std::log(box.width / (shape * height)), growth_.y += std::log(box.height / height);
  }
  centre = to;
  height = box.height, shape = box.width / box.height;
  place_variance = kFirstPlace * kFirstPlace, height_variance = kFirstHeight * kFirstHeight;
}

void EvidenceTrack::follow(const Pyramid* before, const Pyramid& now, const Transform& motion, double seconds,
                           const EvidenceParameters& p) {
  age += seconds, unseen += seconds, since_motion += seconds, since_look += seconds;
  hit = false;
  const Point at_rest = motion.apply(centre);
  const double grown = height * scale_at(motion, centre);
  std::optional<BoxStep> step;
  if (before && !mirrors)
    step = follow_box(*before, now, box(), {at_rest.x - centre.x, at_rest.y - centre.y});
  followed = step.has_value();
  Point own{velocity.x * seconds, velocity.y * seconds};
  if (step) {
    height *= step->growth;
    growth_.x += std::log(height / grown), growth_.y += std::log(height / grown);
    own = {(centre.x + step->shift.x - at_rest.x) / height, (centre.y + step->shift.y - at_rest.y) / height};
    if (seconds > 0) {
      const double gain = std::min(1.0, seconds / p.velocity_time);
      velocity.x += gain * (own.x / seconds - velocity.x),
          velocity.y += gain * (own.y / seconds - velocity.y);
    }
  } else {
    height = grown;
  }
  centre = {at_rest.x + own.x * height, at_rest.y + own.y * height};
  way_.x += own.x, way_.y += own.y;
  height_variance += p.drift * p.drift * seconds;
  place_variance += p.drift * p.drift * seconds * height * height;
}

void EvidenceTrack::correct(const Box& seen, const EvidenceParameters& p) {
  const Box& then = looked_;
  const Point was = middle_of(then), is = middle_of(seen);
  const double place = p.place * height;
  const double gain = place_variance / (place_variance + place * place);
  centre.x += gain * height * (is.x - was.x) / then.height;
  centre.y += gain * height * (is.y - was.y) / then.height;
  place_variance *= 1 - gain;
  const double share = height_variance / (height_variance + p.height * p.height);
  height *= std::pow(seen.height / then.height, share);
  shape *= std::pow(seen.width / seen.height * then.height / then.width, share);
  height_variance *= 1 - share;
}

void EvidenceTrack::distrust() {
  place_variance = height * height, height_variance = 1;
}

void EvidenceTrack::keep(const EvidenceParameters& p) {
  const Place here{way_, growth_, age};
  if (is_far(rest_, p.travel)) rest_ = here;
  const Place& last = places_[(next_ + kKept - 1) % kKept];
  if (age - last.age < kTravelTime / kKept) return;
  places_[next_] = here;
  next_ = (next_ + 1) % kKept;
}

bool EvidenceTrack::is_far(const Place& from, double distance) const {
  const double across = growth_.x - from.growth.x, up = growth_.y - from.growth.y;
  const double growth = across * up > 0 ? std::min(std::abs(across), std::abs(up)) : 0;
  return growth > distance || std::hypot(way_.x - from.way.x, way_.y - from.way.y) > distance;
}

bool EvidenceTrack::travels(double distance) const {
  return std::ranges::any_of(
      places_, [&](const Place& place) { return age - place.age <= kTravelTime && is_far(place, distance); });
}

void EvidenceTrack::add(double more, const EvidenceParameters& p) {
  evidence = std::min(p.ceiling, evidence + more);
}

void EvidenceTrack::add_person(double more, const EvidenceParameters& p) {
  person_evidence = std::clamp(person_evidence + more, 0.0, p.ceiling);
}

}  // namespace cerberus::vision
