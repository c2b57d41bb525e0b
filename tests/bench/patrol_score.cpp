// SPDX-License-Identifier: LGPL-2.1-or-later
#include "patrol_score.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cerberus::bench {
namespace {

constexpr double kCounts = .5;  // visible share
constexpr double kRight = .5, kOnSomebody = .3;

double share_inside(const vision::Box& box, const vision::Box& other) {
  const double area = box.width * box.height;
  return area > 0 ? vision::overlap_area(box, other) / area : 0;
}

bool counts(const Subject& subject) {
  return subject.visible >= kCounts;
}

}  // namespace

vision::Box PatrolScore::seen_part(const vision::Box& box) const {
  const double left = std::max(box.x, 0.), top = std::max(box.y, 0.);
  return {left, top, std::max(0., std::min(box.right(), double(size_.width)) - left),
          std::max(0., std::min(box.bottom(), double(size_.height)) - top)};
}

void PatrolScore::add(const std::vector<Subject>& subjects, const std::vector<Found>& found, double seconds) {
  if (frames_++ == 0) first_ = seconds;
  last_ = seconds;
  add_boxes(subjects, found, seconds);
  add_gaze(subjects, seconds);
}

void PatrolScore::add_boxes(const std::vector<Subject>& subjects, const std::vector<Found>& found,
                            double seconds) {
  std::vector<Person> people;
  for (const Subject& s : subjects) {
    if (!counts(s)) continue;
    people.push_back({s.person.id, seen_part(s.person.box)});
    if (Life& life = lives_[s.person.id]; life.counts_since < 0) life.counts_since = seconds;
  }
  std::vector<Person> boxes;
  for (const Found& f : found) {
    const vision::Box& box = f.person.box;
    tracks_.insert(f.person.id);
    const auto is_on = [&](const Subject& s) {
      return s.visible > 0 && share_inside(box, s.person.box) > .5;
    };
    const auto overlaps = [&](double least) {
      return [&, least](const Person& p) { return vision::intersection_over_union(p.box, box) >= least; };
    };
    if (std::ranges::any_of(subjects, is_on) || std::ranges::any_of(people, overlaps(kOnSomebody)))
      on_somebody_.insert(f.person.id);
    const bool is_on_others =
        std::ranges::any_of(subjects, [&](const Subject& s) { return !counts(s) && is_on(s); });
    if (!f.group && (!is_on_others || std::ranges::any_of(people, overlaps(kRight))))
      boxes.push_back(f.person);
  }
  const auto partner = score_.add(people, boxes);
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (partner[i] < 0) continue;
    Life& life = lives_[people[i].id];
    life.tracks.insert(boxes[std::size_t(partner[i])].id);
    if (life.found < 0) life.found = seconds;
    if (found_since_ < 0) found_since_ = seconds;
  }
}

void PatrolScore::add_gaze(const std::vector<Subject>& subjects, double seconds) {
  double off = std::numeric_limits<double>::infinity();
  for (const Subject& s : subjects) {
    if (s.in_sight && s.moves && moves_since_ < 0) moves_since_ = seconds;
    if (counts(s) && in_picture_since_ < 0) in_picture_since_ = seconds;
    if (s.in_sight) off = std::min(off, std::abs(s.bearing));
  }
  if (in_picture_since_ < 0 || !std::isfinite(off)) return;
  ++in_sight_;
  in_picture_ += off < half_view_;
  if (found_since_ < 0 || seconds < found_since_ + kSettled) return;
  ++settled_;
  squares_ += off * off;
}

PatrolFigures PatrolScore::figures() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  PatrolFigures f;
  f.in_picture_after = in_picture_since_ < 0 ? kNever : std::max(0., in_picture_since_ - moves_since_);
  int with_box = 0;
  double carried = 0;
  for (const auto& [id, life] : lives_) {
    f.found_after = std::max(f.found_after, life.found < 0 ? kNever : life.found - life.counts_since);
    with_box += life.found >= 0;
    carried += double(life.tracks.size());
  }
  if (lives_.empty()) f.found_after = kNever;
  f.in_picture = in_sight_ > 0 ? double(in_picture_) / in_sight_ : 0;
  f.off = settled_ > 0 ? std::sqrt(squares_ / settled_) : kNever;
  f.precision = score_.precision(), f.recall = score_.recall();
  f.identities = with_box > 0 ? carried / with_box : 0;
  // The last frame lasts as long as the others.
  const double n = std::max(1, frames_), seconds = (last_ - first_) * n / std::max(1., n - 1);
  f.false_identities = seconds > 0 ? double(tracks_.size() - on_somebody_.size()) * 60 / seconds : 0;
  return f;
}

}  // namespace cerberus::bench
