// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/person_verifier.h"

#include <algorithm>
#include <cmath>

#include "vision/verification/patch_matching.h"

namespace cerberus::vision {

namespace {

Box core_of(const Box& box, const VerificationParameters& p) {
  return {box.x + box.width * (1 - p.core_width) / 2, box.y + box.height * (1 - p.core_height) / 2,
          box.width * p.core_width, box.height * p.core_height};
}

Box scaled(const Box& box, double x, double y) {
  return {box.x * x, box.y * y, box.width * x, box.height * y};
}

void approach(Box& box, const Box& to, double place, double size) {
  const double cx = box.x + box.width / 2, cy = box.y + box.height / 2;
  const double tx = to.x + to.width / 2, ty = to.y + to.height / 2;
  box.width += size * (to.width - box.width), box.height += size * (to.height - box.height);
  box.x = cx + place * (tx - cx) - box.width / 2, box.y = cy + place * (ty - cy) - box.height / 2;
}

double share_within(const Box& box, const Box& outer) {
  return box.area() > 0 ? overlap_area(box, outer) / box.area() : 0;
}

}  // namespace

void keep_identities(std::span<const Candidate> before, std::span<Candidate> now, std::uint32_t& last) {
  for (Candidate& region : now) {
    if (region.id != 0) continue;
    double best = 0.3;
    for (const Candidate& each : before) {
      const double shared = intersection_over_union(each.box, region.box);
      const bool free = std::ranges::none_of(now, [&](const Candidate& c) { return c.id == each.id; });
      if (free && shared > best) best = shared, region.id = each.id;
    }
    if (region.id == 0) region.id = ++last;
  }
}

void PersonVerifier::reset() {
  people_.clear(), records_.clear(), candidates_.clear(), result_.clear();
  number_ = 0;
  changes_.reset();
}

PersonVerifier::TrackRecord& PersonVerifier::record(std::uint32_t id) {
  for (TrackRecord& each : records_)
    if (each.id == id) return each;
  return records_.emplace_back(TrackRecord{.id = id});
}

void PersonVerifier::update(GrayView picture, Size frame, const Transform& motion, double seconds,
                            std::span<const Candidate> candidates) {
  ++number_;
  frame_ = frame, seconds_ = seconds;
  Past& now = past(number_);
  now.picture.resize(picture.size());
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.row(y), picture.width, now.picture.view().row(y));
  now.motion = motion.rescaled(frame, picture.size());

  compare();
  candidates_.assign(candidates.begin(), candidates.end());
  for (TrackRecord& each : records_) each.since_look += seconds, each.since_seen += seconds;
  std::erase_if(records_, [](const TrackRecord& each) { return each.since_seen > 60; });
  for (const Candidate& each : candidates_) record(each.id).since_seen = 0;
  for (Person& person : people_) {
    follow(person, number_);
    person.age += seconds, person.since_seen += seconds, person.since_look += seconds;
  }
  bind();
  for (Person& person : people_) {
    person.since_support += seconds;
    if (is_supported(person.box)) person.since_support = 0;
  }
  std::erase_if(people_, [&](const Person& person) {
    const Box picture_box{0, 0, double(frame_.width), double(frame_.height)};
    return person.evidence <= 0 || share_within(person.box, picture_box) < 0.4 ||
           person.since_support > p_.longest_still ||
           (person.candidate < 0 && person.since_seen > (person.moved ? p_.longest : p_.longest_still));
  });
}

// With a picture of some frames before, if the camera has stood since.
void PersonVerifier::compare() {
  const auto back = static_cast<std::uint64_t>(p_.change_frames);
  bool stood = number_ > back;
  for (std::uint64_t n = number_; stood && n > number_ - back; --n)
    stood = past(n).motion.corner_motion(past(n).picture.size()) < p_.stands;
  changes_.update(past(number_).picture.view(), stood ? past(number_ - back).picture.view() : GrayView{},
                  seconds_, p_);
}

Box PersonVerifier::reduced(const Box& box) const {
  const Size small = past_[number_ % kKept].picture.size();
  return scaled(box, static_cast<double>(small.width) / frame_.width,
                static_cast<double>(small.height) / frame_.height);
}

// Something moves there.
bool PersonVerifier::is_supported(const Box& box) const {
  return share_on_tracks(box) >= p_.on_track || changes_.share(reduced(box)) >= p_.changed;
}

// One frame on: by the picture, near the prediction.
void PersonVerifier::follow(Person& person, std::uint64_t to) {
  Past &before = past(to - 1), &now = past(to);
  if (to < 2 || before.picture.size() != now.picture.size()) return;
  const double sx = static_cast<double>(now.picture.size().width) / frame_.width;
  const double sy = static_cast<double>(now.picture.size().height) / frame_.height;
  const Box small = scaled(person.box, sx, sy);
  const Point middle{small.x + small.width / 2, small.y + small.height / 2};
  const Point moved = now.motion.apply(middle);
  const Point camera{moved.x - middle.x, moved.y - middle.y};
  const Point guess{camera.x + person.vx, camera.y + person.vy};
  const int reach = std::max(2, static_cast<int>(std::ceil(p_.reach * small.height)));
  const Point step = match_patch(before.picture.view(), now.picture.view(), core_of(small, p_), guess, reach);
  person.vx = p_.inertia * person.vx + (1 - p_.inertia) * (step.x - camera.x);
  person.vy = p_.inertia * person.vy + (1 - p_.inertia) * (step.y - camera.y);
  person.box.x += step.x / sx, person.box.y += step.y / sy;
  person.wayx += (step.x - camera.x) / sx, person.wayy += (step.y - camera.y) / sy;
  if (std::hypot(person.wayx, person.wayy) > p_.moved * person.box.width) person.moved = true;
}

Box PersonVerifier::carried(Box box, std::uint64_t from, double& vx, double& vy) {
  Person person;
  person.box = box, person.vx = vx, person.vy = vy;
  for (std::uint64_t n = from + 1; n <= number_; ++n) follow(person, n);
  vx = person.vx, vy = person.vy;
  return person.box;
}

// Each track to the person that it fits best; a bound pair first.
void PersonVerifier::bind() {
  for (Person& person : people_) person.candidate = -1;
  taken_.assign(candidates_.size(), 0);
  const auto pair = [&](Person& person, std::size_t i) {
    const Candidate& c = candidates_[i];
    person.candidate = static_cast<int>(i), taken_[i] = 1;
    person.track = person.id = c.id;
    if (c.state != TrackState::coasted && c.kind == RegionKind::person_like)
      approach(person.box, c.box, intersection_over_union(person.box, c.box) < p_.unbound ? 1 : p_.track_gain,
               p_.track_gain);
  };
  for (Person& person : people_)
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      if (person.track == candidates_[i].id && !taken_[i] &&
          intersection_over_union(person.box, candidates_[i].box) >=
              (candidates_[i].kind == RegionKind::person_like && candidates_[i].state == TrackState::seen
                   ? p_.unbound_sure
                   : p_.unbound))
        pair(person, i);
  for (;;) {
    double best = p_.bound;
    Person* who = nullptr;
    std::size_t which = 0;
    for (Person& person : people_) {
      if (person.candidate >= 0) continue;
      for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const double shared = taken_[i] ? 0 : intersection_over_union(person.box, candidates_[i].box);
        if (shared >= best) best = shared, who = &person, which = i;
      }
    }
    if (!who) break;
    pair(*who, which);
  }
  for (Person& person : people_) {
    if (person.candidate >= 0) continue;
    person.track = 0;
    const bool taken_over =
        std::ranges::any_of(candidates_, [&](const Candidate& c) { return c.id == person.id; });
    if (taken_over || person.id == 0) person.id = next_own_++;
  }
}

// Legs, or a torso, that look like a smaller person.
bool PersonVerifier::is_part(const Box& box) const {
  const auto is_of = [&](const Box& whole) {
    return box.height < p_.part_height * whole.height && share_within(box, whole) >= p_.part;
  };
  return std::ranges::any_of(people_, [&](const Person& q) { return is_of(q.box); }) ||
         std::ranges::any_of(candidates_, [&](const Candidate& c) {
           return c.kind == RegionKind::person_like && is_of(c.box);
         });
}

double PersonVerifier::share_on_tracks(const Box& box) const {
  double share = 0;
  for (const Candidate& each : candidates_) share = std::max(share, share_within(box, each.box));
  return share;
}

bool PersonVerifier::is_explained(const Candidate& candidate, bool& group) const {
  double covered = 0;
  bool holds = false;
  for (const Person& person : people_) {
    if (!person.is_shown()) continue;
    const double within = share_within(person.box, candidate.box);
    if (within >= p_.inside) holds = true;
    covered += within * person.box.area();
  }
  const bool all = holds && covered >= p_.covered * candidate.box.area();
  group = holds && !all;
  return all;
}

std::optional<PersonVerifier::Look> PersonVerifier::choose() {
  targets_.clear();
  for (const Candidate& each : candidates_) {
    const bool bound = std::ranges::any_of(people_, [&](const Person& q) { return q.track == each.id; });
    if (bound) continue;
    const TrackRecord& own = record(each.id);
    const double waited = std::min(own.since_look, p_.most_waited);
    targets_.push_back({each.box, waited / (1 + own.refuted)});
  }
  for (const Person& each : people_)
    targets_.push_back({each.box, each.since_look * (each.candidate < 0 ? 1 : 0.6)});
  hidden_.clear();
  for (const Candidate& each : candidates_) hidden_.push_back(reduced(each.box));
  for (const Person& each : people_) hidden_.push_back(reduced(each.box));
  const Size small = past(number_).picture.size();
  for (const LookTarget& place : changes_.places(hidden_, p_))
    targets_.push_back({scaled(place.box, static_cast<double>(frame_.width) / small.width,
                               static_cast<double>(frame_.height) / small.height),
                        p_.place_doubt * place.doubt});
  const auto region = choose_look(targets_, frame_, p_);
  if (!region) return std::nullopt;
  const Box seen{double(region->x), double(region->y), double(region->width), double(region->height)};
  changes_.looked(reduced(seen));
  for (const Candidate& each : candidates_)
    if (share_within(each.box, seen) > 0.8) record(each.id).since_look = 0;
  for (Person& each : people_)
    if (share_within(each.box, seen) > 0.8) each.since_look = 0;
  return Look{*region, number_};
}

void PersonVerifier::apply(const Look& look, std::span<const PersonDetection> found, double floor,
                           double certain) {
  if (look.frame > number_ || number_ - look.frame >= kKept) return;
  const auto confidence = [&](double score) {
    return std::clamp(0.5 + 0.5 * (score - floor) / std::max(certain - floor, 1e-9), 0.0, 1.0);
  };
  const std::size_t before = people_.size();
  hit_.assign(before, 0);
  for (const PersonDetection& detection : found) {
    Person next;
    next.box = carried(detection.box, look.frame, next.vx, next.vy);
    // Background is no person: something moves there, or the person has moved.
    const bool supported = is_supported(next.box);
    Person* same = nullptr;
    double best = p_.same;
    for (std::size_t i = 0; i < before; ++i) {
      const double shared = hit_[i] ? 0 : intersection_over_union(people_[i].box, next.box);
      if (shared >= best) best = shared, same = &people_[i];
    }
    if (same) {
      hit_[same - people_.data()] = 1;
      approach(same->box, next.box, p_.place_gain, p_.size_gain);
      same->evidence = std::min(same->evidence + 1, p_.most_evidence), same->missed = false;
      same->confidence += 0.5 * (confidence(detection.score) - same->confidence);
      if (same->moved || supported) same->since_seen = 0;
    } else if (supported && !is_part(next.box)) {
      next.evidence = 1, next.confidence = confidence(detection.score);
      people_.push_back(next);
    }
  }
  const LookRegion& r = look.region;
  const Box seen{double(r.x), double(r.y), double(r.width), double(r.height)};
  for (std::size_t i = 0; i < before; ++i)
    if (!hit_[i] && share_within(people_[i].box, seen) > 0.8 && people_[i].age > 0)
      people_[i].evidence -= 1, people_[i].missed = true;
  std::erase_if(people_, [](const Person& person) { return person.evidence <= 0; });
  bind();
  for (const Candidate& each : candidates_) {
    if (share_within(each.box, seen) < 0.8) continue;
    bool explained = false;
    for (const Person& person : people_)
      explained = explained || person.track == each.id || share_within(person.box, each.box) >= p_.inside;
    TrackRecord& own = record(each.id);
    own.refuted = explained ? 0 : own.refuted + 1;
  }
}

std::span<const VerifiedRegion> PersonVerifier::result() {
  result_.clear();
  for (const Person& person : people_) {
    if (!person.is_shown()) continue;
    VerifiedRegion region{.candidate = person.candidate, .id = person.id, .box = person.box, .person = true};
    region.confidence = person.confidence, region.age = person.age;
    const double sx = static_cast<double>(frame_.width) / past(number_).picture.size().width;
    region.vx = person.vx * sx / seconds_, region.vy = person.vy * sx / seconds_;
    result_.push_back(region);
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& each = candidates_[i];
    if (std::ranges::any_of(people_, [&](const Person& q) { return q.candidate == static_cast<int>(i); }))
      continue;
    bool group = false;
    if (is_explained(each, group)) continue;
    VerifiedRegion region{
        .candidate = static_cast<int>(i), .id = each.id, .box = each.box, .kind = each.kind};
    if (group) region.kind = RegionKind::group;
    result_.push_back(region);
  }
  return result_;
}

}  // namespace cerberus::vision
