// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "vision/assignment.h"
#include "vision/body.h"
#include "vision/identities.h"
#include "vision/sightings.h"

namespace cerberus::vision {
namespace {

constexpr double kDefaultSeconds = 1.0 / 25;  // until a frame distance is known
// S: an object is published once it has moved by this; the hole somebody left in what was taken for the scene, and a
// lamp that was switched on, never do.
constexpr double kLeastTravel = 0.12;
// s until what the camera has turned to is no longer new. What stands out there does so because it moves: nothing was
// learnt of the place that could have left a hole.
constexpr double kNew = 0.5;
constexpr double kLargestBack = 2;  // how much larger than when it left may be what comes back
// What a track without region costs, and the most that a pair does. Who has a region that fits keeps it when somebody
// else has none: without it, two would rather share two regions that fit neither.
constexpr double kWorst = 1.99, kUnmatched = 2;
constexpr double kShared = 1;       // what it costs to live on in a blob of several
constexpr double kProvenTimes = 3;  // times confirm_time that a track was seen before it is published unseen
constexpr double kCrossing = 3;     // s that two who came different ways may be in one place
constexpr std::size_t kMaximumTracks = 128;
constexpr std::size_t kMaximumRegions = 256;  // the largest; more is not a scene with objects in it

// What two look like: see unlike(). The same person seen again is .16 off in the median and .28 in one look of ten; two
// people are .36 apart in the median.
constexpr double kUsual = 0.15;     // nothing to pay for
constexpr double kLookPrice = 3.0;  // for the whole difference beyond that
// A region that looks so much less like the body than what was seen of it last is not taken. Who walks into the shade gets
// darker step by step.
constexpr double kSudden = 0.45;
constexpr double kAwayUnlike = 0.35;  // who comes back must look as before
constexpr double kBehind = 0.3;  // s for which somebody is believed to be where he went behind somebody else
// Of two who walk side by side: how much taller than wide, and the gap between them in widths, at least.
constexpr double kUpright = 1.3, kGap = 0.3;
constexpr double kTogether = 0.3;  // s in one region before pieces are taken for one

// What there is room for at first. When more come than ever, there is room for twice as many, up to the maximum.
constexpr std::size_t kUsualTracks = 16, kUsualRegions = 32;

// Whose turn it is to be found a region.
enum class Sort { here, away, unconfirmed };
Sort sort_of(const Body& b) {
  return b.id == 0 ? Sort::unconfirmed : b.away ? Sort::away : Sort::here;
}

Box bounding(const Box& a, const Box& b) {
  const double x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

}  // namespace

struct Tracker::State {
  TrackOptions options;
  std::vector<Body> bodies;
  std::vector<Region> regions;
  std::vector<int> owner;  // body of each region, -1 none
  std::vector<char> used;  // region explained
  std::vector<double> cost, unmatched;
  std::vector<int> rows;  // bodies taking part in an assignment
  std::vector<Track> published;
  Assignment assignment;
  std::uint32_t last_id = 0;
  double seconds = kDefaultSeconds;
  Size frame;
  Heading heading;
  Sightings sightings;
  Box known;             // of the picture, what has been in view for a while
  bool turning = false;  // the camera moved since the last frame

  State() { make_room(kUsualTracks, kUsualRegions); }
  void make_room(std::size_t tracks, std::size_t seen);
  void look(const Transform& motion);
  void take(std::span<const Region> input);
  void predict(const Transform& motion);
  double pair_cost(const Body& body, std::size_t region) const;
  double look_price(const Body& body, std::size_t region) const;
  bool may_hold(const Region& region, const Body& body) const;
  void associate(Sort sort);
  void gather_fragments();
  bool hides(const Body& first, const Body& body, const Box& region) const;
  void share_regions();
  bool others_expected(const Body& body, const Region& region) const;
  bool crowded(const Body& body, const Region& region) const;
  void absorb_pieces();
  void remove_hollow();
  void drop_dead() {
    std::erase_if(bodies, [](const Body& b) { return b.dead; });
  }
  void give_birth();
  void age();
  void remove_duplicates();
  void publish();
  bool has_stopped(const Body& body) const;
};

// For what one frame may make of them; keeps what there is.
void Tracker::State::make_room(std::size_t tracks, std::size_t seen) {
  bodies.reserve(tracks);
  published.reserve(tracks);
  rows.reserve(tracks);
  unmatched.reserve(tracks);
  regions.reserve(seen);
  sightings.reserve(seen);
  owner.reserve(seen);
  used.reserve(seen);
  cost.resize(std::max(cost.size(), kUsualTracks * kUsualRegions));
  assignment.reserve(static_cast<int>(tracks), static_cast<int>(seen));
}

// The part in view moves with the scene, and what is new becomes known in about kNew.
void Tracker::State::look(const Transform& motion) {
  turning = !motion.is_identity();
  const Box whole{0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  if (!turning && known.area() == whole.area()) return;
  const Point low = motion.apply({known.x, known.y}), high = motion.apply({known.right(), known.bottom()});
  const double gain = std::min(1.0, seconds / kNew);
  const auto side = [&](double at, double edge, double most) {
    const double inside = std::clamp(std::isfinite(at) ? at : edge, 0.0, most);
    return inside + gain * (edge - inside);
  };
  const double x0 = side(low.x, 0, whole.width), x1 = side(high.x, whole.width, whole.width);
  const double y0 = side(low.y, 0, whole.height), y1 = side(high.y, whole.height, whole.height);
  known = {x0, y0, std::max(0.0, x1 - x0), std::max(0.0, y1 - y0)};
}

void Tracker::State::take(std::span<const Region> input) {
  regions.clear();
  if (input.size() > regions.capacity())
    make_room(bodies.capacity(), std::min(std::bit_ceil(input.size()), kMaximumRegions));
  for (const Region& r : input) {
    if (!(r.box.width > 0 && r.box.height > 0) || !std::isfinite(r.box.x + r.box.y + r.box.area())) continue;
    if (regions.size() < kMaximumRegions) {
      regions.push_back(r);
      continue;
    }
    const auto smallest = std::min_element(regions.begin(), regions.end(),
                                           [](const Region& a, const Region& b) { return a.area < b.area; });
    if (smallest->area < r.area) *smallest = r;
  }
  owner.assign(regions.size(), -1);
  used.assign(regions.size(), 0);
}

void Tracker::State::predict(const Transform& motion) {
  for (Body& b : bodies) {
    if (b.away)
      b.predict_away(seconds, heading.gaze());
    else
      b.dead = !b.predict(seconds) || !b.carry(motion, frame);
  }
  drop_dead();
}

double Tracker::State::pair_cost(const Body& b, std::size_t j) const {
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
double Tracker::State::look_price(const Body& b, std::size_t j) const {
  const Box expected = b.away ? b.visible(frame) : b.box(), &seen = regions[j].box;
  if (!b.well_known() || !compare_extents(expected.x, expected.right(), seen.x, seen.right()).same_extent ||
      !compare_extents(expected.y, expected.bottom(), seen.y, seen.bottom()).same_extent)
    return 0;
  const double difference = unlike(b.look, sightings.of(j));
  if (difference > (b.away ? kAwayUnlike : b.unlikeness + kSudden)) return -1;
  return kLookPrice * std::max(0.0, difference - kUsual);
}

// Is it a blob of several that the body is expected in?
bool Tracker::State::may_hold(const Region& region, const Body& b) const {
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

// Two upright boxes of one size with a clear gap between them are two people who walk side by side, not pieces of one.
bool side_by_side(const Box& a, const Box& b) {
  const auto upright = [](const Box& box) { return box.height > kUpright * box.width; };
  const auto alike = [](double p, double q) { return std::min(p, q) > 0.6 * std::max(p, q); };
  const double clear = std::max(a.x, b.x) - std::min(a.right(), b.right());
  const double low = std::max(a.y, b.y), high = std::min(a.bottom(), b.bottom());
  return upright(a) && upright(b) && alike(a.width, b.width) && alike(a.height, b.height) &&
         high - low > 0.6 * std::min(a.height, b.height) && clear > kGap * std::min(a.width, b.width);
}

// Leftover regions that lie where an object is expected are pieces of it: they complete its region or, where it has
// none (somebody standing who moves an arm), they are all there is of it.
void Tracker::State::gather_fragments() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (owner[j] >= 0 || regions[j].confidence >= kWhole) continue;
    const Box& piece = regions[j].box;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Body& b = bodies[i];
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
      if (side_by_side(main.box, piece)) {
        b.parted = true;
        break;
      }
      used[j] = 1;
      const Box both = bounding(main.box, piece);
      if (both.width < 1.25 * expected.width && both.height < 1.25 * expected.height) main.box = both;
      break;
    }
  }
}

// Is the body behind the one whose region this is? Two they are, as they look different or came different ways.
bool Tracker::State::hides(const Body& first, const Body& b, const Box& region) const {
  return sort_of(first) == Sort::here && b.well_known() && b.lost < kCrossing &&
         (strangers(b, first) || apart(b, first)) && intersection_over_union(b.visible(frame), region) > 0.3;
}

// Two objects, one region: a confirmed track without region of its own lives on in a blob larger than its owner that it is
// expected in, and unseen behind somebody else.
void Tracker::State::share_regions() {
  for (Body& b : bodies) {
    if (b.region >= 0 || sort_of(b) != Sort::here) continue;
    const Box box = b.visible(frame);
    for (std::size_t j = 0; j < regions.size() && b.region < 0; ++j) {
      if (owner[j] < 0) continue;
      const Body& first = bodies[owner[j]];
      const Box& blob = regions[j].box;
      if (first.id == 0 || overlap_area(box, blob) < 0.5 * box.area()) continue;
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
bool Tracker::State::others_expected(const Body& b, const Region& region) const {
  return region.box.area() > 1.3 * b.box().area() && std::ranges::any_of(bodies, [&](const Body& o) {
           if (&o == &b || o.dead || sort_of(o) != Sort::here) return false;
           const Box box = o.visible(frame);
           return overlap_area(box, region.box) > 0.5 * box.area();
         });
}

// Does somebody else cover a part of the region?
bool Tracker::State::crowded(const Body& b, const Region& region) const {
  return std::ranges::any_of(bodies, [&](const Body& o) {
    return &o != &b && !o.dead && sort_of(o) == Sort::here &&
           overlap_area(o.box(), region.box) > 0.2 * region.box.area();
  });
}

// Tracks that together fill only a small part of the blob they share and have moved as one were pieces of one object: the
// oldest becomes it and the others go.
void Tracker::State::absorb_pieces() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    const Region& r = regions[j];
    double filled = 0;
    int count = 0;
    Body* oldest = nullptr;
    for (Body& b : bodies) {
      if (b.region != static_cast<int>(j)) continue;
      if (b.hidden) continue;
      filled += overlap_area(b.box(), r.box);
      ++count;
      if (!oldest || b.age > oldest->age) oldest = &b;
    }
    if (count > 1 && filled < 0.4 * r.box.area())
      for (Body& b : bodies) {
        if (b.region != static_cast<int>(j) || &b == oldest || b.hidden || apart(b, *oldest)) continue;
        if (b.shared < kTogether || strangers(b, *oldest)) continue;
        b.dead = true;
        --count;
      }
    for (Body& b : bodies) {
      if (b.region != static_cast<int>(j) || b.dead) continue;
      const bool alone = count == 1 && !b.hidden && !others_expected(b, r);
      if (b.away) b.come_back(r.box);
      const bool larger = !alone && r.box.area() > 1.3 * b.box().area();
      const auto found = larger ? sightings.find(b, r.box) : std::nullopt;
      b.correct(r, alone, seconds, frame, found);
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

// A track without evidence whose box holds several regions was the blob they have come out of.
void Tracker::State::remove_hollow() {
  for (Body& b : bodies) {
    if (b.region >= 0 || sort_of(b) != Sort::here) continue;
    const Box box = b.box();
    const auto inside = std::count_if(regions.begin(), regions.end(), [&](const Region& r) {
      return overlap_area(r.box, box) > 0.6 * r.box.area() && r.box.area() > 0.1 * box.area();
    });
    b.dead = inside > 1;
  }
  drop_dead();
}

void Tracker::State::give_birth() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (owner[j] >= 0 || used[j] || bodies.size() >= kMaximumTracks) continue;
    if (bodies.size() == bodies.capacity()) make_room(2 * bodies.size(), regions.capacity());
    bodies.push_back(Body::first_seen(regions[j]));
    bodies.back().region = static_cast<int>(j);
    bodies.back().uncovered = overlap_area(regions[j].box, known) < 0.5 * regions[j].box.area();
  }
}

// Somebody who ceased to move, rather than left or went behind something: well seen before, slower and slower until
// nothing moved any more, in the open and with nobody else in the way.
bool Tracker::State::has_stopped(const Body& b) const {
  if (b.slow < 0.3 || b.fitted < 0.5 || b.travelled < 0.45 || b.age - b.unseen < 1.5 || b.leaving)
    return false;
  const Box box = b.box();
  return std::none_of(bodies.begin(), bodies.end(), [&](const Body& o) {
    return &o != &b && o.id != 0 && o.region >= 0 && overlap_area(o.box(), box) > 0.2 * box.area();
  });
}

void Tracker::State::age() {
  for (Body& b : bodies) {
    if (b.region >= 0) {
      const bool enough = b.hits >= 3 || (b.hits >= 2 && b.age >= 3 * options.confirm_time);
      const bool confirmed = enough && (b.uncovered || b.travelled >= kLeastTravel) &&
                             b.age >= 0.99 * options.confirm_time && b.hits >= 0.6 * b.frames;
      if (b.id == 0 && (confirmed || options.confirm_time <= 0)) {
        b.id = ++last_id;
        b.top_speed = b.speed();
      }
      continue;
    }
    b.miss(seconds);
    if (b.id == 0) {
      b.dead = b.unseen > 0.5 * options.confirm_time && b.hits < 0.6 * b.frames;
      continue;
    }
    if (b.away) {
      if (b.expected_in(frame)) b.absent += seconds;
      if (b.stopped && b.absent > 0) b.away = false;  // stands where it stood
      b.dead =
          b.unseen > (b.stopped ? options.hold_stopped : options.away_time) || b.absent > options.coast_time;
      continue;
    }
    const bool outside =
        b.x.position < 0 || b.y.position < 0 || b.x.position > frame.width || b.y.position > frame.height;
    if (!b.stopped && has_stopped(b)) {
      b.stopped = true;
      b.x.velocity = b.y.velocity = 0;
    }
    // Carried on for half as long as it was known, at most.
    const double coast = std::min(options.coast_time, 0.5 * (b.age - b.unseen));
    const double limit = b.stopped ? options.hold_stopped : b.at_border(frame) ? 0.3 * coast : coast;
    b.confidence *=
        std::exp(-seconds / std::max(b.stopped ? options.hold_stopped : options.coast_time, 1e-3));
    b.dead = outside || b.unseen > limit;
    if (b.dead && turning && (outside || b.at_border(frame)) && b.unseen < options.away_time &&
        b.proven >= 0.5 && b.travelled >= 0.45) {
      b.dead = false;
      b.leave(heading.gaze());
    }
  }
  drop_dead();
}

// Two tracks on one object: the one without evidence, or else the younger, goes.
void Tracker::State::remove_duplicates() {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      Body &a = bodies[i], &b = bodies[j];
      if (a.dead || b.dead || sort_of(a) != Sort::here || sort_of(b) != Sort::here) continue;
      if (intersection_over_union(a.box(), b.box()) < 0.7) continue;
      const bool twins = a.region == b.region && a.region >= 0;
      if (twins && strangers(a, b) && std::max(a.lost, b.lost) < kCrossing) continue;
      if (twins && std::max(a.shared, b.shared) < (apart(a, b) ? kCrossing : 1.0)) continue;
      if (!twins && a.region >= 0 && b.region >= 0) continue;
      if (!twins && std::max(a.unseen, b.unseen) < 0.5) continue;
      Body& weaker = a.unseen != b.unseen ? (a.unseen > b.unseen ? a : b) : (a.age < b.age ? a : b);
      weaker.dead = true;
    }
  drop_dead();
}

void Tracker::State::publish() {
  published.clear();
  for (const Body& b : bodies) {
    if (sort_of(b) != Sort::here || (b.hidden && b.lost > kBehind)) continue;
    const Box box = b.box();
    if (b.region < 0 && !b.stopped && std::sqrt(b.x.pp) > 0.4 * box.width)
      continue;  // where it is, nobody knows
    // Who is not seen at the picture's edge has left, as far as anybody knows; and what has hardly been seen may have been
    // nobody.
    if (b.region < 0 && !b.stopped &&
        (b.at_border(frame) || b.age - b.unseen < kProvenTimes * options.confirm_time))
      continue;
    const double x0 = std::clamp(box.x, 0.0, static_cast<double>(frame.width));
    const double y0 = std::clamp(box.y, 0.0, static_cast<double>(frame.height));
    const double x1 = std::clamp(box.right(), 0.0, static_cast<double>(frame.width));
    const double y1 = std::clamp(box.bottom(), 0.0, static_cast<double>(frame.height));
    if (x1 - x0 < 1 || y1 - y0 < 1) continue;
    if (b.top_speed < options.minimum_speed) continue;
    published.push_back({b.id,
                         {x0, y0, x1 - x0, y1 - y0},
                         b.x.velocity,
                         b.y.velocity,
                         b.top_speed,
                         b.age,
                         std::clamp(b.confidence, 0.0, 1.0),
                         b.stopped       ? TrackState::stopped
                         : b.region >= 0 ? TrackState::seen
                                         : TrackState::coasted});
  }
  std::sort(published.begin(), published.end(), [](const Track& a, const Track& b) { return a.id < b.id; });
}

Tracker::Tracker() : state_(std::make_unique<State>()) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::set_options(const TrackOptions& options) {
  state_->options = options;
}

void Tracker::reset() {
  state_->bodies.clear();
  state_->published.clear();
  state_->seconds = kDefaultSeconds;
  state_->heading.reset();
  state_->sightings.reset();
  state_->frame = {};
}

std::size_t Tracker::bytes() const {
  const State& s = *state_;
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof s + of(s.bodies) + of(s.regions) + of(s.owner) + of(s.used) + of(s.cost) + of(s.unmatched) +
         of(s.rows) + of(s.published) + s.assignment.bytes() + s.sightings.bytes();
}

std::span<const Track> Tracker::update(std::span<const Region> regions, const Transform& motion,
                                       double seconds, Size frame, const std::optional<Gaze>& gaze,
                                       const Sight& sight) {
  State& s = *state_;
  if (seconds > 0 && std::isfinite(seconds)) s.seconds = seconds;
  if (frame.width != s.frame.width || frame.height != s.frame.height)
    s.known = {0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  s.frame = frame;
  if (s.heading.update(gaze, motion, frame)) std::erase_if(s.bodies, [](const Body& b) { return b.away; });
  s.look(motion);
  s.take(regions);
  s.sightings.update(sight, s.regions, motion, frame);
  s.predict(motion);
  s.associate(Sort::here);
  s.gather_fragments();
  s.associate(Sort::away);
  s.associate(Sort::unconfirmed);
  s.share_regions();
  s.absorb_pieces();
  s.remove_hollow();
  settle_identities(s.bodies);
  s.give_birth();
  s.age();
  s.remove_duplicates();
  s.publish();
  return s.published;
}

}  // namespace cerberus::vision
