// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/person_verifier.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

Point middle_of(const Box& box) {
  return {box.x + box.width / 2, box.y + box.height / 2};
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
  people_.clear(), lost_.clear(), records_.clear(), candidates_.clear(), result_.clear();
  pictures_.reset();
  level_.reset();
  changes_.reset();
  line_.reset();
}

PersonVerifier::TrackRecord& PersonVerifier::record(std::uint32_t id) {
  for (TrackRecord& each : records_)
    if (each.id == id) return each;
  return records_.emplace_back(TrackRecord{.id = id});
}

void PersonVerifier::update(GrayView picture, Size frame, const Transform& motion, double seconds,
                            std::span<const Candidate> candidates) {
  seconds_ = seconds;
  pictures_.add(picture, frame, motion);
  level_.update(pictures_.picture(pictures_.number()), pictures_.motion(pictures_.number()));
  line_.move(motion);
  compare();
  candidates_.assign(candidates.begin(), candidates.end());
  for (TrackRecord& each : records_)
    each.since_look += seconds, each.since_seen += seconds, each.age += seconds;
  std::erase_if(records_, [](const TrackRecord& each) { return each.since_seen > 60; });
  for (const Candidate& each : candidates_) record(each.id).since_seen = 0;
  carry_lost(motion);
  for (Person& person : people_) {
    person.follow(pictures_.number(), pictures_, p_);
    person.age += seconds, person.since_seen += seconds, person.since_look += seconds;
  }
  bind();
  for (Person& person : people_) {
    person.since_support += seconds;
    if (is_supported(person.box())) person.since_support = 0;
    person.sure = person.sure || (!person.weak && share_on_tracks(person.box()) >= p_.on_track);
  }
  forget_if([&](const Person& person) {
    const double longest = person.moved() ? p_.longest : p_.longest_still;
    return person.evidence <= 0 || pictures_.seen(person.box()).area() < p_.leaves * person.box().area() ||
           person.since_support > p_.longest_still || (person.candidate < 0 && person.since_seen > longest);
  });
}

// With a picture of some frames before, if the camera has stood since.
void PersonVerifier::compare() {
  const std::uint64_t now = pictures_.number();
  const auto back = std::min(static_cast<std::uint64_t>(p_.change_frames), now - 1);
  bool stood = back >= static_cast<std::uint64_t>(p_.least_change_frames);
  for (std::uint64_t n = now; stood && n > now - back; --n)
    stood = pictures_.motion(n).corner_motion(pictures_.picture(n).size()) < p_.stands;
  changes_.update(pictures_.picture(now), stood ? pictures_.picture(now - back) : GrayView{}, seconds_, p_);
}

void PersonVerifier::carry_lost(const Transform& motion) {
  for (Lost& each : lost_) {
    const Point middle = middle_of(each.box), moved = motion.apply(middle);
    each.box.x += moved.x - middle.x + each.velocity.x, each.box.y += moved.y - middle.y + each.velocity.y;
    each.since += seconds_;
  }
  std::erase_if(lost_, [&](const Lost& each) { return each.since > p_.hidden; });
}

bool PersonVerifier::is_owned(std::uint32_t id) const {
  return std::ranges::any_of(people_, [&](const Person& person) { return person.id == id; });
}

// The identity of somebody who was hidden and may be this person, whose age it continues; 0: none.
std::uint32_t PersonVerifier::lost_identity(Person& person) {
  const Box& box = person.box();
  const Point at = middle_of(box);
  const Lost* found = nullptr;
  double nearest = 1;
  for (const Lost& each : lost_) {
    const Point was = middle_of(each.box);
    const double reach = box.height * (p_.hidden_reach + p_.hidden_speed * each.since);
    const double distance = std::hypot(at.x - was.x, at.y - was.y) / reach;
    const bool is_track =
        std::ranges::any_of(candidates_, [&](const Candidate& c) { return c.id == each.id; });
    if (distance > nearest || std::abs(std::log(each.box.height / box.height)) > p_.hidden_height ||
        is_owned(each.id) || is_track)
      continue;
    nearest = distance, found = &each;
  }
  if (!found) return 0;
  const std::uint32_t id = found->id;
  person.age = std::max(person.age, found->age + found->since);
  std::erase_if(lost_, [&](const Lost& each) { return each.id == id; });
  return id;
}

// Something moves there.
bool PersonVerifier::is_supported(const Box& box) const {
  return share_on_tracks(box) >= p_.on_track || changes_.share(pictures_.reduced(box)) >= p_.changed;
}

// The track shows one person, about as high and as wide as the looks showed this one.
bool PersonVerifier::is_whole(const Candidate& c, const Person& person) const {
  const Box& box = person.box();
  return c.state == TrackState::seen && c.kind == RegionKind::person_like &&
         line_.judge(c.box, p_) != HeightLine::Fit::contradicts &&
         std::abs(std::log(c.box.height / box.height)) < p_.alike_height &&
         std::abs(std::log(c.box.width / box.width)) < p_.alike_width;
}

void PersonVerifier::bind(Person& person, std::size_t candidate) {
  const Candidate& c = candidates_[candidate];
  person.candidate = static_cast<int>(candidate), taken_[candidate] = 1;
  if (person.track != c.id) person.agreed = 0;
  person.track = c.id;
  person.track_boxes[pictures_.number() % PictureHistory::kKept] = c.box;
  // The older identity counts, of tracks that are no group's or thing's.
  const bool sure = c.state == TrackState::seen && c.kind == RegionKind::person_like;
  const bool older = person.id >= kFirstOwn && sure && record(c.id).age > person.age;
  if ((person.id == 0 || older) && !is_owned(c.id)) person.id = c.id;
  // Looks have shown that the track is right, or the last look has left the person out.
  const bool trusted = person.agreed >= p_.agreed || person.since_look > p_.unlooked * period_;
  if (trusted && is_whole(c, person)) {
    const bool near = intersection_over_union(person.box(), c.box) >= p_.unbound;
    person.pull(c.box, near ? p_.track_gain : 1, p_.track_gain, pictures_, p_);
  }
}

// Each track to the person that it fits best; a bound pair first.
void PersonVerifier::bind() {
  for (Person& person : people_)
    person.candidate = -1, person.track_boxes[pictures_.number() % PictureHistory::kKept] = {};
  taken_.assign(candidates_.size(), 0);
  const auto shared = [&](const Person& person, std::size_t i) {
    const bool free = !taken_[i] && candidates_[i].kind != RegionKind::group;
    return free ? intersection_over_union(person.box(), candidates_[i].box) : -1;
  };
  for (Person& person : people_)
    for (std::size_t i = 0; i < candidates_.size() && person.candidate < 0; ++i)
      if (person.track == candidates_[i].id &&
          shared(person, i) >= (is_whole(candidates_[i], person) ? p_.unbound_whole : p_.unbound))
        bind(person, i);
  for (;;) {
    double best = p_.bound;
    Person* who = nullptr;
    std::size_t which = 0;
    for (Person& person : people_)
      for (std::size_t i = 0; i < candidates_.size() && person.candidate < 0; ++i)
        if (shared(person, i) >= best) best = shared(person, i), who = &person, which = i;
    if (!who) break;
    bind(*who, which);
  }
  for (Person& person : people_) {
    if (person.candidate < 0) person.track = 0;
    if (person.id == 0) person.id = lost_identity(person);
    if (person.id == 0) person.id = next_own_++;
  }
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
    const double within = share_within(person.box(), candidate.box);
    if (within >= p_.inside) holds = true;
    covered += within * person.box().area();
  }
  const bool all = holds && covered >= p_.covered * candidate.box.area();
  group = holds && !all;
  return all;
}

// Of the people in it, frame pixels.
double PersonVerifier::height_in(const Candidate& candidate) const {
  return (candidate.kind == RegionKind::person_like ? 1 : p_.in_group) * candidate.box.height;
}

std::optional<PersonVerifier::Look> PersonVerifier::choose() {
  targets_.clear();
  for (const Candidate& each : candidates_) {
    const bool bound = std::ranges::any_of(people_, [&](const Person& q) { return q.track == each.id; });
    if (bound) continue;
    const TrackRecord& own = record(each.id);
    const double waited = std::min(own.since_look, p_.most_waited);
    targets_.push_back({pictures_.seen(each.box), waited / (1 + own.refuted), height_in(each)});
  }
  for (const Person& each : people_)
    targets_.push_back(
        {pictures_.seen(each.box()), each.since_look * (each.candidate < 0 ? 1 : 0.6), each.box().height});
  hidden_.clear();
  for (const Candidate& each : candidates_) hidden_.push_back(pictures_.reduced(each.box));
  for (const Person& each : people_) hidden_.push_back(pictures_.reduced(each.box()));
  const double across = 1 / pictures_.across(), down = 1 / pictures_.down();
  for (const LookTarget& place : changes_.places(hidden_, p_))
    targets_.push_back(
        {{place.box.x * across, place.box.y * down, place.box.width * across, place.box.height * down},
         p_.place_doubt * place.doubt,
         p_.in_group * place.box.height * down});
  const LookRegions regions = choose_look(targets_, pictures_.frame(), most_regions_, p_);
  if (regions.count == 0) return std::nullopt;
  for (const LookRegion& region : regions.chosen()) changes_.looked(pictures_.reduced(region.box()));
  for (const Candidate& each : candidates_)
    if (shows(regions, pictures_.seen(each.box), height_in(each), p_)) record(each.id).since_look = 0;
  for (Person& each : people_)
    if (shows(regions, pictures_.seen(each.box()), each.box().height, p_)) each.since_look = 0;
  return Look{regions, pictures_.number()};
}

std::span<const VerifiedRegion> PersonVerifier::result() {
  result_.clear();
  for (Person& person : people_) {
    if (!person.is_shown()) continue;
    person.published = true;
    VerifiedRegion region{
        .candidate = person.candidate, .id = person.id, .box = person.box(), .person = true};
    region.box.y += above_head_ * region.box.height;
    region.box.height *= 1 - above_head_ - below_feet_;
    region.confidence = person.confidence, region.age = person.age;
    region.vx = person.velocity().x / seconds_, region.vy = person.velocity().y / seconds_;
    result_.push_back(region);
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& each = candidates_[i];
    // A track whose identity a person has taken along in public shows that person no more, and its new one is not known
    // yet. The track of a person who has not been shown stays as it was.
    const auto replaces = [&](const Person& person) {
      return (person.is_shown() && person.candidate == static_cast<int>(i)) ||
             (person.published && person.id == each.id);
    };
    bool group = false;
    if (std::ranges::any_of(people_, replaces) || is_explained(each, group)) continue;
    VerifiedRegion region{
        .candidate = static_cast<int>(i), .id = each.id, .box = each.box, .kind = each.kind};
    if (group) region.kind = RegionKind::group;
    result_.push_back(region);
  }
  return result_;
}

}  // namespace cerberus::vision
