// SPDX-License-Identifier: LGPL-2.1-or-later
// Whose a region is: one object's, a piece of one, or several people's.
#include <algorithm>
#include <cmath>

#include "vision/tracking/identity_swap.h"
#include "vision/tracking/tracker_state.h"

namespace cerberus::vision {
namespace {

constexpr double kLargestBack = 2;  // how much larger than when it left may be what comes back
// What a track without region costs, and the most that a pair does. Who has a region that fits keeps it when somebody
// else has none: without it, two would rather share two regions that fit neither.
constexpr double kWorst = 1.99, kUnmatched = 2;
constexpr double kShared = 1;  // what it costs to live on in a blob of several
// What two look like: see appearance_distance(). The same person seen again is .16 off in the median and .28 in one look of ten; two
// people are .36 apart in the median.
constexpr double kUsual = 0.15;     // nothing to pay for
constexpr double kLookPrice = 3.0;  // for the whole difference beyond that
// A region that looks so much less like the body than what was seen of it last is not taken. Who walks into the shade
// gets darker step by step.
constexpr double kSudden = 0.45;
constexpr double kAwayUnlike = 0.35;  // who comes back must look as before
// Of two who walk side by side: how much taller than wide, and the gap between them in widths, at least.
constexpr double kUpright = 1.3, kGap = 0.3;
constexpr double kSmall = 0.2;  // of somebody's area: nobody else
// Of pieces of one person above one another: the share of the smaller one's height that they have in common at most, of
// its width at least; and how many times as tall as wide their region is at most.
constexpr double kApartRows = 0.3, kSameColumns = 0.8, kLean = 5;
constexpr double kTogether = 0.3;  // s in one region before pieces are taken for one

Box bounding(const Box& a, const Box& b) {
  const double x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

bool is_upright(const Box& b) {
  return b.height > kUpright * b.width;
}

// Two upright boxes of one size with a clear gap between them, as tall as what they come from, are two people who walk
// side by side, not pieces of one.
bool side_by_side(const Box& a, const Box& b, const Box& expected) {
  const auto alike = [](double p, double q) { return std::min(p, q) > 0.6 * std::max(p, q); };
  const double clear = std::max(a.x, b.x) - std::min(a.right(), b.right());
  const double low = std::max(a.y, b.y), high = std::min(a.bottom(), b.bottom());
  return is_upright(a) && is_upright(b) && alike(a.width, b.width) && alike(a.height, b.height) &&
         high - low > 0.6 * expected.height && clear > kGap * std::min(a.width, b.width);
}

// Are they pieces, one above the other, of somebody whose region this is? Who walks straight up or down the picture is
// seen in fronts before he is seen whole: head, waist and feet. Two people in a region have rows in common; where they
// have not, one far behind the other, both are upright, or the region is taller than anybody.
bool are_one_above_another(const Box& a, const Box& b, const Box& region) {
  const double columns = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double rows = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  return is_upright(region) && region.height < kLean * region.width &&
         rows < kApartRows * std::min(a.height, b.height) &&
         columns > kSameColumns * std::min(a.width, b.width) && !(is_upright(a) && is_upright(b));
}

// Is it a small thing that lies within the other, all but for its rim?
bool small_part(const Box& part, const Box& whole) {
  return part.area() < kSmall * whole.area() && overlap_area(part, whole) > 0.6 * part.area();
}

}  // namespace

double Tracker::State::pair_cost(const TrackHypothesis& b, std::size_t j) const {
  const Region& region = regions[j];
  const double distance = b.ahead ? b.distance(region.box, frame) : -1;
  if (distance < 0) return Assignment::kForbidden;
  if (b.away && region.box.area() > kLargestBack * b.box().area()) return Assignment::kForbidden;
  if (options.maximum_speed > 0) {
    const double moved = std::hypot(region.box.x + region.box.width / 2 - b.x.position,
                                    region.box.y + region.box.height / 2 - b.y.position);
    if (moved > options.maximum_speed * (seconds + b.unseen) + 0.5 * b.size()) return Assignment::kForbidden;
  }
  const double price = look_price(b, j);
  if (price < 0) return Assignment::kForbidden;
  return std::min(distance + price, kWorst);
}

// What it costs that the region does not look like the body; negative: it cannot be it. Only a region of the body's own
// extent shows all of it and nobody else; with the others nothing is said.
double Tracker::State::look_price(const TrackHypothesis& b, std::size_t j) const {
  const Box expected = b.away ? b.visible(frame) : b.box(), &seen = regions[j].box;
  if (!b.well_known() || !compare_extents(expected.x, expected.right(), seen.x, seen.right()).same_extent ||
      !compare_extents(expected.y, expected.bottom(), seen.y, seen.bottom()).same_extent)
    return 0;
  const double difference = appearance_distance(b.look, sightings.of(j));
  if (difference > (b.away ? kAwayUnlike : b.unlikeness + kSudden)) return -1;
  return kLookPrice * std::max(0.0, difference - kUsual);
}

// Is it a blob of several that the body is expected in?
bool Tracker::State::may_hold(const Region& region, const TrackHypothesis& b) const {
  if (region.confidence >= kWhole || sort_of(b) != Sort::here) return false;
  const Box box = b.visible(frame);
  return region.box.area() > 1.3 * box.area() && overlap_area(box, region.box) > 0.5 * box.area();
}

void Tracker::State::associate(Sort sort) {
  rows.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (sort_of(bodies[i]) == sort) rows.push_back(static_cast<int>(i));
  const auto columns = static_cast<int>(regions.size());
  if (cost.size() < rows.size() * regions.size()) cost.resize(rows.size() * regions.size());
  unmatched.assign(rows.size(), kUnmatched);
  for (std::size_t c = 0; c < regions.size(); ++c) {
    double least = Assignment::kForbidden;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      double& pair = cost[r * regions.size() + c];
      pair = owner[c] >= 0 || used[c] ? Assignment::kForbidden : pair_cost(bodies[rows[r]], c);
      least = std::min(least, pair);
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
      if (cost[r * regions.size() + c] > least && may_hold(regions[c], bodies[rows[r]]))
        unmatched[r] = kShared;
  }
  const auto partner = assignment.solve(cost, static_cast<int>(rows.size()), columns, unmatched);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (partner[r] < 0) continue;
    bodies[rows[r]].region = partner[r];
    owner[partner[r]] = rows[r];
  }
}

// Leftover regions that lie where an object is expected are pieces of it: they complete its region or, where it has
// none (somebody standing who moves an arm), they are all there is of it.
void Tracker::State::gather_fragments() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (owner[j] >= 0 || regions[j].confidence >= kWhole) continue;
    const Box& piece = regions[j].box;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      TrackHypothesis& b = bodies[i];
      if (sort_of(b) != Sort::here || (b.region >= 0 && regions[b.region].confidence >= kWhole)) continue;
      const Box expected = b.box();
      if (overlap_area(expected, piece) < 0.6 * piece.area() || piece.area() > 0.7 * expected.area())
        continue;
      if (b.region < 0) {
        b.region = static_cast<int>(j);
        owner[j] = static_cast<int>(i);
        break;
      }
      Region& main = regions[b.region];
      if (side_by_side(main.box, piece, expected)) {
        b.parted = true;
        break;
      }
      used[j] = 1;
      const Box both = bounding(main.box, piece);
      if (both.width < 1.25 * expected.width && both.height < 1.25 * expected.height) {
        main.box = both;
        sightings.look_again(b.region, both);
      }
      break;
    }
  }
}

// Is the body behind the one whose region this is? Two they are, as they look different or came different ways.
bool Tracker::State::hides(const TrackHypothesis& first, const TrackHypothesis& b, const Box& region) const {
  return sort_of(first) == Sort::here && b.well_known() && b.lost < kCrossing &&
         (strangers(b, first) || apart(b, first)) && intersection_over_union(b.visible(frame), region) > 0.3;
}

// Two objects, one region: a confirmed track without region of its own lives on in a blob larger than its owner that it
// is expected in, and unseen behind somebody else. Who stopped stays where he is: a region that passes would take him
// along.
void Tracker::State::share_regions() {
  for (TrackHypothesis& b : bodies) {
    if (b.region >= 0 || sort_of(b) != Sort::here || b.stopped) continue;
    const Box box = b.visible(frame);
    for (std::size_t j = 0; j < regions.size() && b.region < 0; ++j) {
      if (owner[j] < 0) continue;
      const TrackHypothesis& first = bodies[owner[j]];
      const Box& blob = regions[j].box;
      if (first.id == 0 || overlap_area(box, blob) < 0.5 * box.area()) continue;
      if (are_one_above_another(b.box(), first.box(), blob)) {
        b.region = static_cast<int>(j);
        continue;
      }
      if (hides(first, b, blob)) {
        b.region = static_cast<int>(j);
        b.hidden = true;
        continue;
      }
      if (regions[j].confidence >= kWhole) continue;
      if (blob.area() > 1.3 * first.box().area() || blob.area() > 1.3 * box.area())
        b.region = static_cast<int>(j);
    }
  }
}

// Is somebody else expected in a region that is larger than the body, whichever region he was given?
bool Tracker::State::others_expected(const TrackHypothesis& b, const Region& region) const {
  return region.box.area() > 1.3 * b.box().area() &&
         std::ranges::any_of(bodies, [&](const TrackHypothesis& o) {
           if (&o == &b || o.dead || sort_of(o) != Sort::here) return false;
           const Box box = o.visible(frame);
           return overlap_area(box, region.box) > 0.5 * box.area();
         });
}

// Does somebody else cover a part of the region?
bool Tracker::State::crowded(const TrackHypothesis& b, const Region& region) const {
  return std::ranges::any_of(bodies, [&](const TrackHypothesis& o) {
    return &o != &b && !o.dead && sort_of(o) == Sort::here &&
           overlap_area(o.box(), region.box) > 0.2 * region.box.area();
  });
}

// Tracks that together fill only a small part of the blob they share and have moved as one were pieces of one object:
// the oldest becomes it and the others go.
void Tracker::State::absorb_pieces() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    const Region& r = regions[j];
    double filled = 0;
    int count = 0;
    TrackHypothesis* oldest = nullptr;
    for (TrackHypothesis& b : bodies) {
      if (b.region != static_cast<int>(j)) continue;
      if (b.hidden) continue;
      filled += overlap_area(b.box(), r.box);
      ++count;
      if (!oldest || b.age > oldest->age) oldest = &b;
    }
    if (count > 1)
      for (TrackHypothesis& b : bodies) {
        if (b.region != static_cast<int>(j) || &b == oldest || b.hidden) continue;
        if (b.shared < kTogether) continue;
        if (are_one_above_another(b.box(), oldest->box(), r.box)) {
          b.dead = true;
          oldest->parted = true;
          --count;
          continue;
        }
        if (apart(b, *oldest)) continue;
        // A part does not look like the whole.
        if (!small_part(b.box(), oldest->box()) && (filled >= 0.4 * r.box.area() || strangers(b, *oldest)))
          continue;
        b.dead = true;
        --count;
      }
    for (TrackHypothesis& b : bodies) {
      if (b.region != static_cast<int>(j) || b.dead) continue;
      const bool alone = count == 1 && !b.hidden && !others_expected(b, r);
      if (b.away) b.come_back(r.box);
      const bool larger = !alone && r.box.area() > 1.3 * b.box().area();
      const auto found = larger ? sightings.find(b, r.box) : std::nullopt;
      b.correct(r, alone, seconds, frame, found);
      b.settle(alone && b.misfit == 0 && b.slow > 0 ? sightings.place(b.box()) : AppearanceModel{}, seconds);
      b.lost = alone || found ? 0 : b.lost + seconds;
      b.shared = alone ? 0 : b.shared + seconds;
      if (alone && b.misfit == 0 && sightings.of(j).known())
        b.remember(sightings.of(j), seconds, !crowded(b, r));
      else if (!alone)
        b.mix();
    }
  }
  drop_dead();
}

}  // namespace cerberus::vision
