// SPDX-License-Identifier: LGPL-2.1-or-later
// What a look shows: persons who are known, new ones, and persons whom it should have shown and does not.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "vision/verification/hit_merging.h"
#include "vision/verification/person_verifier.h"

namespace cerberus::vision {

namespace {

// A weak detection that another one has taken in: intersection over union, and share of it that lies in the other.
// Derived: the limits of merge_hits().
constexpr double kSamePlace = 0.4, kWithin = 0.6;

// A part of a body looks like a smaller person. share: of its box that lies in that of the whole, at least.
bool is_part_of(const Box& box, const Box& whole, double share, const VerificationParameters& p) {
  return box.height < p.part_height * whole.height && share_within(box, whole) >= share;
}

}  // namespace

// .5 at the threshold, 1 where the detector is certain.
double PersonVerifier::Scores::confidence(double score) const {
  return std::clamp(0.5 + 0.5 * (score - threshold) / std::max(certain - threshold, 1e-9), 0.0, 1.0);
}

// The look shows this person.
bool PersonVerifier::is_shown_by_look(std::size_t i) const {
  return i >= hit_.size() || hit_[i];
}

// Somebody nearer, whom the look shows, hides this person from the detector.
bool PersonVerifier::is_covered(std::size_t i, std::uint64_t frame) const {
  const Person& person = people_[i];
  if (person.looks() < 2 || person.since_seen >= p_.covered_longest) return false;
  const Box& box = person.box_at(frame);
  for (std::size_t k = 0; k < people_.size(); ++k) {
    const Box& front = people_[k].box_at(frame);
    if (k != i && is_shown_by_look(k) && front.bottom() > box.bottom() &&
        share_within(box, front) >= p_.covers)
      return true;
  }
  return false;
}

// Legs, or a torso, of a person or a person-like track. Of somebody who is as high as people are there, more must lie in the
// whole: it may be a person beside a wide box.
bool PersonVerifier::is_part(const Box& box) const {
  const double share = line_.judge(box, p_) == HeightLine::Fit::fits ? p_.part_fits : p_.part;
  const auto is_of = [&](const Box& whole) { return is_part_of(box, whole, share, p_); };
  return std::ranges::any_of(people_, [&](const Person& q) { return is_of(q.box()); }) ||
         std::ranges::any_of(candidates_, [&](const Candidate& c) {
           return c.kind == RegionKind::person_like && is_of(c.box);
         });
}

// Legs, or a torso, of another person whom looks have shown repeatedly, the last one too: it does not confirm person i, who may
// stand behind. The line of the heights says nothing here: before a camera at the height of heads a torso fits it.
bool PersonVerifier::is_part_of_another(const Box& box, std::size_t i, std::uint64_t frame) const {
  for (std::size_t k = 0; k < hit_.size(); ++k)
    if (k != i && people_[k].looks() > 1 && !people_[k].missed &&
        is_part_of(box, people_[k].box_at(frame), p_.part_another, p_))
      return true;
  return false;
}

// The look shows the whole of which this person was a part. Whoever is as high as people are where the feet are is no
// part, but farther away.
bool PersonVerifier::is_absorbed(std::size_t i) const {
  const Box& box = people_[i].box();
  if (line_.judge(box, p_) == HeightLine::Fit::fits) return false;
  for (std::size_t k = 0; k < people_.size(); ++k) {
    if (k != i && is_shown_by_look(k) && !people_[k].weak &&
        is_part_of(box, people_[k].box(), p_.absorbed, p_))
      return true;
  }
  return false;
}

// Fills found_ and weak_ with one detection a person. found_: those above the threshold, and weaker ones that are as high
// as people are where they stand; but none that is higher or lower. weak_: those at places of unknown height that are in
// none of found_'s boxes; they can only confirm persons who are known (a second pass with weak detections, as in Y. Zhang
// et al., "ByteTrack", ECCV 2022). Every detection above the threshold where something moves teaches the line of the
// heights, even where it contradicts: the camera may look at other ground than before.
void PersonVerifier::take_persons(std::span<const PersonDetection> hits, double threshold) {
  const auto take = [&](std::vector<PersonDetection>& to, double floor, auto condition) {
    to.clear();
    std::ranges::copy_if(hits, std::back_inserter(to), condition);
    merge_hits(to, floor);
  };
  const auto is_strong = [threshold](const PersonDetection& hit) { return hit.score >= threshold; };
  take(found_, threshold, is_strong);
  for (const PersonDetection& person : found_)
    if (is_supported(person.box)) line_.learn(person.box, p_);
  const double floor = least_score(threshold);
  take(found_, floor, [&](const PersonDetection& hit) {
    const HeightLine::Fit fit = line_.judge(hit.box, p_);
    return fit == HeightLine::Fit::fits || (fit == HeightLine::Fit::unknown && is_strong(hit));
  });
  take(weak_, floor,
       [&](const PersonDetection& hit) { return line_.judge(hit.box, p_) == HeightLine::Fit::unknown; });
  std::erase_if(weak_, [&](const PersonDetection& hit) {
    return std::ranges::any_of(found_, [&](const PersonDetection& other) {
      return intersection_over_union(hit.box, other.box) > kSamePlace ||
             share_within(hit.box, other.box) >= kWithin;
    });
  });
}

// The appearance of the middle of a box, where little background is. The exposure that is taken out is that of the present
// frame: it changes little while a look takes its time.
AppearanceModel PersonVerifier::appearance_at(const Box& box, std::uint64_t frame) const {
  const Box core = core_of(box, p_.appearance_width, p_.core_height);
  return appearance_of({pictures_.picture(frame), {}}, level_, pictures_.reduced(core),
                       p_.appearance_samples);
}

// No other person and no other detection of the look covers more than `alone` of a detection's box, and the picture's edge does
// not cut it. person: whom it shows; nullptr: nobody who is known.
bool PersonVerifier::is_alone(const Box& box, std::uint64_t frame, const Person* person) const {
  const auto covers = [&](const Box& other) { return share_within(box, other) > p_.alone; };
  const auto is_in_the_way = [&](const Person& q) { return &q != person && covers(q.box_at(frame)); };
  return pictures_.seen(box).area() >= p_.whole * box.area() &&
         std::ranges::none_of(people_, is_in_the_way) &&
         std::ranges::count_if(boxes_, covers) == 1;  // the box itself
}

// How well a detection of a look at this frame fits a person: intersection over union, less what the appearance differs more
// than usual. nullopt: another height, or another place.
std::optional<double> PersonVerifier::likeness(const Person& person, const Box& box,
                                               std::uint64_t frame) const {
  const Box& then = person.box_at(frame);
  const double shared = intersection_over_union(then, box);
  if (shared < p_.same || std::abs(std::log(then.height / box.height)) > p_.same_height) return std::nullopt;
  const double difference =
      person.appearance.known() ? appearance_distance(person.appearance, appearance_at(box, frame)) : -1;
  return difference < 0 ? shared : shared - p_.appearance_weight * (difference - p_.usual_difference);
}

// Gives detections to the known persons whom they show, the pair that fits best first, and takes them out of `found`. A
// person gets one a look.
void PersonVerifier::confirm_known(std::vector<PersonDetection>& found, std::uint64_t frame,
                                   const Scores& scores) {
  for (;;) {
    Person* same = nullptr;
    std::size_t index = 0;
    std::optional<double> best;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < hit_.size(); ++k) {
        const Box& box = found[i].box;
        if (hit_[k] || is_part_of_another(box, k, frame)) continue;
        const auto fit = likeness(people_[k], box, frame);
        if (fit && (!best || *fit >= *best)) best = fit, same = &people_[k], index = i;
      }
    if (!same) return;
    confirm(*same, found[index], frame, scores);
    found.erase(found.begin() + static_cast<std::ptrdiff_t>(index));
  }
}

void PersonVerifier::confirm(Person& person, const PersonDetection& found, std::uint64_t frame,
                             const Scores& scores) {
  hit_[static_cast<std::size_t>(&person - people_.data())] = 1;
  if (is_alone(found.box, frame, &person))
    person.appearance.learn(appearance_at(found.box, frame), p_.appearance_gain);
  const Box& track = person.track_boxes[frame % PictureHistory::kKept];
  if (track.area() > 0)
    person.agreed = intersection_over_union(track, found.box) >= p_.agrees ? person.agreed + 1 : 0;
  person.correct(found.box, frame, pictures_, p_);
  person.evidence = std::min(person.evidence + 1, p_.most_evidence), person.missed = false;
  person.confidence += 0.5 * (scores.confidence(found.score) - person.confidence);
  if (person.moved() || is_supported(found.box)) person.since_seen = 0;
}

// Somebody new, where something moves that is no part of a person who is known: background is no person.
void PersonVerifier::add(const PersonDetection& found, std::uint64_t frame, const Scores& scores) {
  if (!is_supported(found.box) || is_part(found.box)) return;
  Person person;
  person.begin(found.box, frame, pictures_, p_);
  person.evidence = 1, person.confidence = scores.confidence(found.score);
  person.weak = found.score < scores.threshold;
  person.sure = !person.weak && (share_on_tracks(person.box()) >= p_.on_track || person.walks() ||
                                 found.score >= p_.sure_at * scores.threshold);
  if (is_alone(found.box, frame, nullptr)) person.appearance = appearance_at(found.box, frame);
  people_.push_back(person);
}

// Persons in a region of the look, at a scale at which the detector sees them, whom it does not show, though nobody hides
// them.
void PersonVerifier::miss(const Look& look, std::size_t known) {
  for (std::size_t i = 0; i < known; ++i) {
    Person& person = people_[i];
    if (hit_[i]) continue;
    if (is_absorbed(i))
      person.evidence = 0;
    else if (person.age > 0 && shows(look.regions, pictures_.seen(person.box()), person.box().height, p_) &&
             !is_covered(i, look.frame))
      person.evidence -= 1, person.missed = true;
  }
  forget_if([](const Person& person) { return person.evidence <= 0; });
}

void PersonVerifier::apply(const Look& look, std::span<const PersonDetection> hits, double threshold,
                           double certain) {
  if (!pictures_.holds(look.frame)) return;
  take_persons(hits, threshold);
  const Scores scores{threshold, certain};
  const std::size_t known = people_.size();
  hit_.assign(known, 0);
  boxes_.clear();
  for (const auto* each : {&found_, &weak_})
    std::ranges::transform(*each, std::back_inserter(boxes_), &PersonDetection::box);
  confirm_known(found_, look.frame, scores);
  for (const PersonDetection& found : found_) add(found, look.frame, scores);
  confirm_known(weak_, look.frame, scores);
  miss(look, known);
  bind();
  for (const Candidate& each : candidates_) {
    if (!shows(look.regions, pictures_.seen(each.box), height_in(each), p_)) continue;
    bool explained = false;
    for (const Person& person : people_)
      explained = explained || person.track == each.id || share_within(person.box(), each.box) >= p_.inside;
    TrackRecord& own = record(each.id);
    own.refuted = explained ? 0 : own.refuted + 1;
  }
}

}  // namespace cerberus::vision
