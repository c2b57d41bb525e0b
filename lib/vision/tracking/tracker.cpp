// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "vision/tracking/identity_swap.h"
#include "vision/tracking/tracker_state.h"

namespace cerberus::vision {
namespace {

// S: an object is published once it has moved by this; the hole somebody left in what was taken for the scene, and a
// lamp that was switched on, never do.
constexpr double kLeastTravel = 0.12;
// s until what the camera has turned to is no longer new. What stands out there does so because it moves: nothing was
// learnt of the place that could have left a hole.
constexpr double kNew = 0.5;
constexpr double kProvenTimes = 3;  // times confirm_time that a track was seen before it is published unseen
constexpr double kEdgeCoast = 0.3;  // of the time to coast, at the picture's edge
constexpr std::size_t kMaximumTracks = 128;
constexpr std::size_t kMaximumRegions = 256;  // the largest; more is not a scene with objects in it

constexpr double kBehind = 0.3;  // s for which somebody is believed to be where he went behind somebody else

// What there is room for at first. When more come than ever, there is room for twice as many, up to the maximum.
constexpr std::size_t kUsualTracks = 8, kUsualRegions = 16;

}  // namespace

Tracker::State::State() {
  preallocate(kUsualTracks, kUsualRegions);
}

// Keeps what there is.
void Tracker::State::preallocate(std::size_t tracks, std::size_t seen) {
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
    preallocate(bodies.capacity(), std::min(std::bit_ceil(input.size()), kMaximumRegions));
  for (const Region& r : input) {
    if (!(r.box.width > 0 && r.box.height > 0) || !std::isfinite(r.box.x + r.box.y + r.box.area())) continue;
    if (regions.size() < kMaximumRegions) {
      regions.push_back(r);
      continue;
    }
    const auto area = [](const Region& region) { return region.box.area(); };
    const auto smallest = std::ranges::min_element(regions, {}, area);
    if (area(*smallest) < area(r)) *smallest = r;
  }
  owner.assign(regions.size(), -1);
  used.assign(regions.size(), 0);
}

void Tracker::State::predict(const Transform& motion) {
  for (TrackHypothesis& b : bodies) {
    if (b.away)
      b.predict_away(seconds, heading.gaze());
    else
      b.dead = !b.predict(seconds) || !b.carry(motion, frame);
  }
  drop_dead();
  for (TrackHypothesis& b : bodies) {
    if (turning) b.place = {};  // what stands around it is another thing now
    b.changed = sort_of(b) == Sort::here && b.place.known()
                    ? appearance_distance(b.place, sightings.place(b.box()))
                    : -1;
  }
}

// A track without evidence whose box holds several regions was the blob they have come out of.
void Tracker::State::remove_hollow() {
  for (TrackHypothesis& b : bodies) {
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
    if (bodies.size() == bodies.capacity()) preallocate(2 * bodies.size(), regions.capacity());
    bodies.push_back(TrackHypothesis::first_seen(regions[j]));
    bodies.back().region = static_cast<int>(j);
    bodies.back().uncovered = overlap_area(regions[j].box, known) < 0.5 * regions[j].box.area();
  }
}

// Is somebody else, who is seen, in the way?
bool Tracker::State::covered(const TrackHypothesis& b) const {
  const Box box = b.box();
  return std::any_of(bodies.begin(), bodies.end(), [&](const TrackHypothesis& o) {
    return &o != &b && o.id != 0 && o.region >= 0 && overlap_area(o.box(), box) > 0.2 * box.area();
  });
}

// Is he at the picture's edge, and his place looks otherwise?
bool Tracker::State::left_place(const TrackHypothesis& b) const {
  return b.changed >= 0 && !b.stays() && b.at_border(frame);
}

// Somebody who ceased to move, rather than left or went behind something: well seen before, slower and slower until
// nothing moved any more, in the open and with nobody else in the way; at the picture's edge, where the place tells.
bool Tracker::State::has_stopped(const TrackHypothesis& b) const {
  if (b.slow < 0.3 || b.fitted < 0.5 || b.travelled < 0.45 || b.age - b.unseen < 1.5 || b.leaving)
    return false;
  return !left_place(b) && !covered(b);
}

void Tracker::State::age() {
  for (TrackHypothesis& b : bodies) {
    if (b.region >= 0) {
      b.absent = 0;
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
    const double limit = b.stopped ? options.hold_stopped : b.at_border(frame) ? kEdgeCoast * coast : coast;
    b.confidence *=
        std::exp(-seconds / std::max(b.stopped ? options.hold_stopped : options.coast_time, 1e-3));
    // Somebody at the edge whose place looks like another, and nobody is in the way, has left.
    const bool left = b.stopped && left_place(b) && !covered(b);
    b.absent = left ? b.absent + seconds : 0;
    b.dead = outside || b.unseen > limit || b.absent > kEdgeCoast * coast;
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
      TrackHypothesis &a = bodies[i], &b = bodies[j];
      if (a.dead || b.dead || sort_of(a) != Sort::here || sort_of(b) != Sort::here) continue;
      if (intersection_over_union(a.box(), b.box()) < 0.7) continue;
      const bool twins = a.region == b.region && a.region >= 0;
      if (twins && strangers(a, b) && std::max(a.lost, b.lost) < kCrossing) continue;
      if (twins && std::max(a.shared, b.shared) < (apart(a, b) ? kCrossing : 1.0)) continue;
      if (!twins && a.region >= 0 && b.region >= 0) continue;
      // Somebody passes in front of who stands there.
      if (!twins && (a.stopped || b.stopped) && (strangers(a, b) || apart(a, b))) continue;
      if (!twins && std::max(a.unseen, b.unseen) < 0.5) continue;
      TrackHypothesis& weaker =
          a.unseen != b.unseen ? (a.unseen > b.unseen ? a : b) : (a.age < b.age ? a : b);
      weaker.dead = true;
    }
  drop_dead();
}

void Tracker::State::publish() {
  published.clear();
  for (const TrackHypothesis& b : bodies) {
    if (sort_of(b) != Sort::here || (b.hidden && b.lost > kBehind) || (b.region < 0 && b.lost >= kCrossing))
      continue;
    const Box box = b.box();
    if (b.region < 0 && !b.stopped && std::sqrt(b.x.pp) > 0.4 * box.width)
      continue;  // where it is, nobody knows
    // Who is not seen at the picture's edge has left, as far as anybody knows; and what has hardly been seen may have
    // been nobody.
    if (b.region < 0 && !b.stopped &&
        (b.at_border(frame) || b.age - b.unseen < kProvenTimes * options.confirm_time))
      continue;
    const double x0 = std::clamp(box.x, 0.0, static_cast<double>(frame.width));
    const double y0 = std::clamp(box.y, 0.0, static_cast<double>(frame.height));
    const double x1 = std::clamp(box.right(), 0.0, static_cast<double>(frame.width));
    const double y1 = std::clamp(box.bottom(), 0.0, static_cast<double>(frame.height));
    if (x1 - x0 < 1 || y1 - y0 < 1) continue;
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
  state_->seconds = State::kDefaultSeconds;
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
                                       double seconds, Size frame,
                                       const std::optional<CameraOrientation>& gaze, const Sight& sight) {
  State& s = *state_;
  if (seconds > 0 && std::isfinite(seconds)) s.seconds = seconds;
  if (frame.width != s.frame.width || frame.height != s.frame.height)
    s.known = {0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  s.frame = frame;
  if (s.heading.update(gaze, motion, frame))
    std::erase_if(s.bodies, [](const TrackHypothesis& b) { return b.away; });
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
  swap_mistaken_identities(s.bodies);
  s.give_birth();
  s.age();
  s.remove_duplicates();
  s.publish();
  s.sightings.done();
  return s.published;
}

}  // namespace cerberus::vision
