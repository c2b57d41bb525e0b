// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/data_association.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
namespace {

Box bounding(const Box& a, const Box& b) {
  const double x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

bool is_upright(const Box& box) {
  return box.height > kTrackParameters.upright * box.width;
}

// From the centre where the track is expected, frame pixels.
double distance_between(const TrackHypothesis& t, const Box& box) {
  return std::hypot(centre(box).x - t.x.position, centre(box).y - t.y.position);
}

}  // namespace

DataAssociation::Turn DataAssociation::turn_of(const TrackHypothesis& t) {
  switch (t.phase()) {
    case TrackPhase::tentative:
      return Turn::tentative;
    case TrackPhase::off_screen:
      return Turn::off_screen;
    default:
      return Turn::in_view;
  }
}

// Two upright boxes with rows in common, nearly as tall as the track, are two persons who walk side by side, not fragments of
// one.
bool DataAssociation::side_by_side(const Box& a, const Box& b, const Box& expected) const {
  const double low = std::max(a.y, b.y), high = std::min(a.bottom(), b.bottom());
  return is_upright(a) && is_upright(b) && high - low > parameters_.inside * expected.height;
}

// Are they fragments, one above the other, of the person whose region this is? A person who walks straight up or down
// the picture is detected as moving edges (head, waist, feet) before he is detected whole. Two persons in a region have
// rows in common; where they have not, one far behind the other, both are upright.
bool DataAssociation::one_above_another(const Box& a, const Box& b, const Box& region) const {
  const double columns = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double rows = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  return is_upright(region) && rows < parameters_.inside * std::min(a.height, b.height) &&
         columns > parameters_.inside * std::min(a.width, b.width) && !(is_upright(a) && is_upright(b));
}

// Is it small and, all but its rim, inside the other?
bool DataAssociation::is_part(const TrackHypothesis& part, const TrackHypothesis& whole) const {
  const Box a = part.box(), b = whole.box();
  return a.area() < part.parameters->fragment * b.area() &&
         overlap_area(a, b) > parameters_.inside * a.area();
}

// Is an object that has come so far, frame pixels, beyond maximum-speed?
bool DataAssociation::too_fast(const TrackHypothesis& t, double moved) const {
  return frame_.maximum_speed > 0 &&
         moved > frame_.maximum_speed * (frame_.seconds + t.unseen) + t.parameters->gate_noise * t.size();
}

DataAssociation::SameExtents DataAssociation::same_extents(const TrackHypothesis& t, const Box& seen) const {
  const Box expected = turn_of(t) == Turn::off_screen ? t.visible(frame_.size) : t.box();
  return {compare_extents(expected.x, expected.right(), seen.x, seen.right(), *t.parameters).same_extent,
          compare_extents(expected.y, expected.bottom(), seen.y, seen.bottom(), *t.parameters).same_extent};
}

double DataAssociation::pair_cost(const TrackHypothesis& t, std::size_t j) const {
  const Region& region = regions_[j];
  const auto* returns = std::get_if<OffScreen>(&t.life);
  if (returns && !returns->in_front) return Assignment::kForbidden;
  const double distance = t.distance(region.box, frame_.size);
  if (distance < 0) return Assignment::kForbidden;
  if (too_fast(t, distance_between(t, region.box))) return Assignment::kForbidden;
  // Only a region of the track's own extent shows all of it and nothing else. Of a track that comes back the picture's edge
  // may hide a part; a piece of another width and height may be anybody's.
  const SameExtents same = same_extents(t, region.box);
  if (returns && !same.width && !same.height) return Assignment::kForbidden;
  const double appearance = returns || (same.width && same.height) ? appearance_cost(t, j) : 0;
  if (appearance < 0) return Assignment::kForbidden;
  // Of the tracks that may come back the nearest does, however far.
  return returns ? distance + appearance : std::min(distance + appearance, parameters_.unmatched);
}

// Cost of a difference in appearance; negative: another object.
double DataAssociation::appearance_cost(const TrackHypothesis& t, std::size_t j) const {
  const Parameters& q = parameters_;
  if (!t.has_appearance()) return t.walked_out() && appearances_->of(j).known() ? -1 : 0;
  const bool returns = turn_of(t) == Turn::off_screen;
  const double difference = appearance_distance(t.appearance.model, appearances_->of(j));
  // Others come in at the same side meanwhile: of one that walked out nothing may differ.
  if (t.walked_out() && (difference < 0 || difference > q.usual_change)) return -1;
  if (difference > (returns ? 0 : t.appearance.change) + q.sudden_change) return -1;
  const double known = returns ? 0 : 1 - std::exp(-t.appearance.learnt / q.known_time);
  return (q.appearance_cost + known * q.known_cost) * std::max(0.0, difference - q.usual_change);
}

// Is it a blob of several that the track is expected in?
bool DataAssociation::may_hold(const Region& region, const TrackHypothesis& t) const {
  if (is_person_like(region) || turn_of(t) != Turn::in_view) return false;
  const Box box = t.visible(frame_.size);
  return is_larger(region.box, box) && overlap_area(box, region.box) > parameters_.inside * box.area();
}

// The least total cost for the tracks whose turn it is and the regions that are left.
void DataAssociation::assign(Turn turn) {
  rows_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (turn_of(tracks_[i]) == turn) rows_.push_back(static_cast<int>(i));
  const std::size_t columns = regions_.size();
  if (cost_.size() < rows_.size() * columns) cost_.resize(rows_.size() * columns);
  unmatched_.assign(rows_.size(), turn == Turn::off_screen ? Assignment::kForbidden : parameters_.unmatched);
  for (std::size_t c = 0; c < columns; ++c) {
    double least = Assignment::kForbidden;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      double& pair = cost_[r * columns + c];
      pair = is_new(c) ? pair_cost(tracks_[rows_[r]], c) : Assignment::kForbidden;
      least = std::min(least, pair);
    }
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if (cost_[r * columns + c] > least && may_hold(regions_[c], tracks_[rows_[r]]))
        unmatched_[r] = parameters_.shared;
  }
  const auto partner =
      assignment_.solve(cost_, static_cast<int>(rows_.size()), static_cast<int>(columns), unmatched_);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (partner[r] < 0) continue;
    matches_[rows_[r]].region = partner[r];
    owner_[partner[r]] = rows_[r];
  }
}

// An object may be so fast that its second region lies beyond the gate, as its velocity is not known yet. Where of the
// objects that the last frame showed for the first time one is left over, and one region of its extent, they are one.
void DataAssociation::follow_leap() {
  const auto is_left = [&](std::size_t i) {
    const auto* data = std::get_if<Tentative>(&tracks_[i].life);
    return data && data->frames == 2 && matches_[i].region < 0;
  };
  std::size_t track = tracks_.size(), region = regions_.size();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!is_left(i)) continue;
    if (track < tracks_.size()) return;
    track = i;
  }
  for (std::size_t j = 0; j < regions_.size(); ++j) {
    if (!is_new(j)) continue;
    if (region < regions_.size()) return;
    region = j;
  }
  if (track == tracks_.size() || region == regions_.size()) return;
  const TrackHypothesis& t = tracks_[track];
  const double moved = distance_between(t, regions_[region].box);
  const SameExtents same = same_extents(t, regions_[region].box);
  if (moved > parameters_.leap * t.size() || too_fast(t, moved) || !same.width || !same.height) return;
  matches_[track].region = static_cast<int>(region);
  matches_[track].leapt = true;
  owner_[region] = static_cast<int>(track);
}

// Regions left over that lie where an object is expected are fragments of it: they complete its region or, where it has
// none (a person who stands and moves an arm), they are its region.
void DataAssociation::gather_fragments() {
  const Parameters& q = parameters_;
  for (std::size_t j = 0; j < regions_.size(); ++j) {
    if (owner_[j] >= 0 || is_person_like(regions_[j])) continue;
    const Box& fragment = regions_[j].box;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      Match& match = matches_[i];
      if (turn_of(tracks_[i]) != Turn::in_view) continue;
      if (match.region >= 0 && is_person_like(regions_[match.region])) continue;
      const Box expected = tracks_[i].box();
      if (overlap_area(expected, fragment) < q.inside * fragment.area()) continue;
      if (match.region < 0) {
        match.region = static_cast<int>(j);
        owner_[j] = static_cast<int>(i);
        break;
      }
      Region& main = regions_[match.region];
      if (side_by_side(main.box, fragment, expected)) {
        match.reshaped = true;
        break;
      }
      fragment_[j] = 1;
      main.box = bounding(main.box, fragment);
      appearances_->recompute(match.region, main.box);
      break;
    }
  }
}

// Is the track behind the one whose region this is? They are two objects, as they look different or came different
// ways.
bool DataAssociation::occludes(const TrackHypothesis& front, const TrackHypothesis& t,
                               const Box& region) const {
  return turn_of(front) == Turn::in_view && t.has_appearance() &&
         (look_different(t, front) || went_apart(t, front)) &&
         intersection_over_union(t.visible(frame_.size), region) > parameters_.occluded_overlap;
}

// Two objects, one region: a confirmed track without region of its own shares a blob that is larger than its owner and
// that it is expected in, and is occluded behind another track. A stopped track stays where it is: a region that passes
// would take it along.
void DataAssociation::share_regions() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const TrackHypothesis& t = tracks_[i];
    Match& match = matches_[i];
    if (match.region >= 0 || turn_of(t) != Turn::in_view || t.stands()) continue;
    const Box box = t.visible(frame_.size);
    for (std::size_t j = 0; j < regions_.size() && match.region < 0; ++j) {
      if (owner_[j] < 0) continue;
      const TrackHypothesis& owner = tracks_[owner_[j]];
      const Box& blob = regions_[j].box;
      if (turn_of(owner) == Turn::tentative || overlap_area(box, blob) < parameters_.inside * box.area())
        continue;
      const bool above = one_above_another(t.box(), owner.box(), blob);
      const bool occluded = !above && occludes(owner, t, blob);
      if (above || occluded ||
          (!is_person_like(regions_[j]) && (is_larger(blob, owner.box()) || is_larger(blob, box)))) {
        match.region = static_cast<int>(j);
        match.occluded = occluded;
      }
    }
  }
}

// Tracks in one region that have moved as one are fragments of one object where one lies above the other, where one is a
// small part of the other, and where together they fill only a small part of the region: the oldest becomes that object and
// the others end.
void DataAssociation::merge_fragments() {
  for (std::size_t j = 0; j < regions_.size(); ++j) {
    const auto shares = [&](std::size_t i) {
      return matches_[i].region == static_cast<int>(j) && !matches_[i].occluded;
    };
    double filled = 0;
    int count = 0;
    std::size_t oldest = 0;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      if (!shares(i)) continue;
      filled += overlap_area(tracks_[i].box(), regions_[j].box);
      if (count++ == 0 || tracks_[i].age > tracks_[oldest].age) oldest = i;
    }
    const bool hollow = filled < parameters_.inside * regions_[j].box.area();
    const int all = count;
    for (std::size_t i = 0; i < tracks_.size() && all > 1; ++i) {
      const TrackHypothesis &t = tracks_[i], &whole = tracks_[oldest];
      if (i == oldest || !shares(i) || t.shared.time < t.parameters->lasts) continue;
      const bool above = one_above_another(t.box(), whole.box(), regions_[j].box);
      const bool fragment = is_part(t, whole) || (hollow && !look_different(t, whole));
      if (!above && (went_apart(t, whole) || !fragment)) continue;
      matches_[i].merged = true;
      if (above) matches_[oldest].reshaped = true;
      --count;
    }
    for (Match& match : matches_)
      if (match.region == static_cast<int>(j)) match.sharers = count;
  }
}

bool DataAssociation::others_expected(std::span<const TrackHypothesis> tracks, const TrackHypothesis& self,
                                      const Box& region, Size frame) const {
  return is_larger(region, self.box()) && std::ranges::any_of(tracks, [&](const TrackHypothesis& o) {
           if (&o == &self || !o.in_view()) return false;
           const Box box = o.visible(frame);
           return overlap_area(box, region) > parameters_.inside * box.area();
         });
}

bool DataAssociation::crowded(std::span<const TrackHypothesis> tracks, const TrackHypothesis& self,
                              const Box& region) const {
  return std::ranges::any_of(tracks, [&](const TrackHypothesis& o) {
    return &o != &self && o.in_view() &&
           overlap_area(o.box(), region) > o.parameters->covered * region.area();
  });
}

void DataAssociation::associate(std::span<const TrackHypothesis> tracks, std::span<Region> regions,
                                RegionAppearances& appearances, const Frame& frame) {
  tracks_ = tracks;
  regions_ = regions;
  appearances_ = &appearances;
  frame_ = frame;
  matches_.assign(tracks.size(), {});
  owner_.assign(regions.size(), -1);
  fragment_.assign(regions.size(), 0);
  assign(Turn::in_view);
  gather_fragments();
  assign(Turn::off_screen);
  assign(Turn::tentative);
  follow_leap();
  share_regions();
  merge_fragments();
  tracks_ = {};
  regions_ = {};
  appearances_ = nullptr;
}

void DataAssociation::reserve(std::size_t tracks, std::size_t regions) {
  matches_.reserve(tracks);
  rows_.reserve(tracks);
  unmatched_.reserve(tracks);
  owner_.reserve(regions);
  fragment_.reserve(regions);
  if (cost_.empty()) cost_.resize(tracks * regions);
  assignment_.reserve(static_cast<int>(tracks), static_cast<int>(regions));
}

std::size_t DataAssociation::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return of(matches_) + of(owner_) + of(fragment_) + of(cost_) + of(unmatched_) + of(rows_) +
         assignment_.bytes();
}

}  // namespace cerberus::vision
