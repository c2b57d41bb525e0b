// SPDX-License-Identifier: LGPL-2.1-or-later
// Lengths are measured in body lengths S = max(width, height) of the object itself: a standing person is
// about 1.7 m, so a walk of 1.4 m/s is 0.8 S a second at any distance and any picture size. Noises below
// follow from that.
#include "vision/tracks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vision/assignment.h"
#include "vision/kalman.h"

namespace cerberus::vision {
namespace {

constexpr double kDefaultSeconds = 1.0 / 25;  // until a frame distance is known
constexpr std::size_t kMaximumTracks = 128;
constexpr std::size_t kMaximumRegions = 256;  // the largest; more is not a scene with objects in it

// People start, stop and turn within about a second: velocity wanders by 0.8 S/s in one.
constexpr double kAcceleration = 0.8 * 0.8;  // S^2 / s^3
constexpr double kBirthSpeed = 3.0;          // S/s, standard deviation of the unknown first velocity
constexpr double kPositionNoise = 0.05;      // S: a region's centre flickers by this
constexpr double kSizeNoise = 0.15;          // of the logarithm: a region's extent flickers by 15 %
constexpr double kSizeWander = 0.15 * 0.15;  // 1/s: and truly changes by 15 % in a second
constexpr double kBorderWander = 1.5 * 1.5;  // 1/s: what is cut by the border grows and shrinks fast
constexpr double kWhole = 0.5;       // regions from this confidence on are one object with its true extent
constexpr double kStandSpeed = 0.3;  // S/s: slower than this (0.5 m/s) may have stopped

struct Body {
  std::uint32_t id = 0;  // 0: not confirmed yet
  MovingValue x, y;      // centre
  SlowValue w, h;        // logarithms of the extent
  Point origin;          // where it was first seen, carried with the scene
  double age = 0, unseen = 0, shared = 0;
  double fitted = 0;  // s during which the region had the track's extent: how well the extent is known
  double slow = 0;    // s it has been seen going slower than kStandSpeed, up to now
  double misfit = 0;  // s since it had, and what was seen in the meantime
  Box misfit_from, misfit_last;
  double travelled = 0;  // largest distance from the origin, S
  double confidence = 0;
  double top_speed = 0;  // pixels a second
  int hits = 0, frames = 0;
  int region = -1;
  bool stopped = false, dead = false;

  double width() const { return std::exp(w.value); }
  double height() const { return std::exp(h.value); }
  double size() const { return std::max(width(), height()); }
  Box box() const {
    const double bw = width(), bh = height();
    return {x.position - bw / 2, y.position - bh / 2, bw, bh};
  }
};

double overlap(const Box& a, const Box& b) {
  const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  return w > 0 && h > 0 ? w * h : 0;
}

Box bounding(const Box& a, const Box& b) {
  const double x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

// One axis of a region against one axis of a track. Where the extents agree the centres are compared. Where
// they do not (a fragment of the object, or a blob of several) only this much is known: the smaller lies
// inside the larger.
struct Residual {
  double distance = 0;
  bool same_extent = true;
};
Residual compare(double track_from, double track_to, double from, double to) {
  const double extent = track_to - track_from, seen = to - from;
  if (seen > 0.65 * extent && seen < 1.5 * extent) return {(from + to - track_from - track_to) / 2, true};
  const double low = from - track_from, high = to - track_to;
  if (seen <= extent) return {low < 0 ? low : std::max(high, 0.0), false};
  return {low > 0 ? low : std::min(high, 0.0), false};
}

}  // namespace

struct Tracker::State {
  TrackOptions options;
  std::vector<Body> bodies;
  std::vector<Region> regions;
  std::vector<int> owner;  // body of each region, -1 none
  std::vector<char> used;  // region explained
  std::vector<double> cost;
  std::vector<int> rows;  // bodies taking part in an assignment
  std::vector<Track> published;
  Assignment assignment;
  std::uint32_t last_id = 0;
  double seconds = kDefaultSeconds;
  Size frame;

  State() {
    bodies.reserve(kMaximumTracks);
    regions.reserve(kMaximumRegions);
    published.reserve(kMaximumTracks);
    rows.reserve(kMaximumTracks);
    owner.reserve(kMaximumRegions);
    used.reserve(kMaximumRegions);
  }

  void take(std::span<const Region> input);
  void predict(const Transform& motion);
  double pair_cost(const Body& body, const Region& region) const;
  void associate(bool confirmed);
  void gather_fragments();
  void share_regions();
  void adopt(Body& body, const Box& seen);
  bool outgrown(Body& body, const Box& seen, bool whole);
  void correct(Body& body, const Box& seen, double confidence, bool alone);
  void give_birth();
  void age();
  void remove_duplicates();
  void publish();
  bool has_stopped(const Body& body) const;
  bool at_border(const Body& body) const;
};

void Tracker::State::take(std::span<const Region> input) {
  regions.clear();
  for (const Region& r : input) {
    if (!(r.box.width > 0 && r.box.height > 0)) continue;
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

// First along its own velocity, then with the camera: both from frame k-1's coordinates into frame k's.
void Tracker::State::predict(const Transform& motion) {
  for (Body& b : bodies) {
    const double s = b.size();
    const double noise = kAcceleration * s * s;
    if (b.stopped) {
      // Stands still; where exactly is less and less sure, but never by more than half a body.
      b.x.velocity = b.y.velocity = 0;
      const double limit = 0.25 * s * s;
      for (MovingValue* a : {&b.x, &b.y})
        a->pp = std::min(a->pp + 0.01 * s * s * seconds, std::max(limit, a->pp));
    } else {
      b.x.predict(seconds, noise);
      b.y.predict(seconds, noise);
    }
    const double wander = at_border(b) ? kBorderWander : kSizeWander;
    b.w.predict(seconds, wander);
    b.h.predict(seconds, wander);
    b.age += seconds;
    ++b.frames;
    b.region = -1;
    if (motion.is_identity()) continue;
    const Point p{b.x.position, b.y.position};
    const Point q = motion.apply(p), right = motion.apply({p.x + 1, p.y}),
                down = motion.apply({p.x, p.y + 1});
    const double a = right.x - q.x, c = right.y - q.y, e = down.x - q.x, d = down.y - q.y;  // Jacobian
    const double det = a * d - c * e;
    if (!(std::isfinite(q.x) && std::isfinite(q.y) && det > 0)) {
      b.dead = true;
      continue;
    }
    const double scale = std::sqrt(det);
    b.x.position = q.x;
    b.y.position = q.y;
    const double vx = a * b.x.velocity + e * b.y.velocity, vy = c * b.x.velocity + d * b.y.velocity;
    b.x.velocity = vx;
    b.y.velocity = vy;
    for (MovingValue* m : {&b.x, &b.y}) {
      m->pp *= det;
      m->pv *= det;
      m->vv *= det;
    }
    b.w.value += std::log(scale);
    b.h.value += std::log(scale);
    b.origin = motion.apply(b.origin);
  }
  std::erase_if(bodies, [](const Body& b) { return b.dead; });
}

double Tracker::State::pair_cost(const Body& b, const Region& region) const {
  const Box box = b.box(), &seen = region.box;
  const double s = b.size();
  const Residual rx = compare(box.x, box.right(), seen.x, seen.right());
  const Residual ry = compare(box.y, box.bottom(), seen.y, seen.bottom());
  const double noise = kPositionNoise * s * kPositionNoise * s * 4;
  const double d2 =
      rx.distance * rx.distance / (b.x.pp + noise) + ry.distance * ry.distance / (b.y.pp + noise);
  if (d2 > 16) return Assignment::kForbidden;
  if (options.maximum_speed > 0) {
    const double reach = options.maximum_speed * (seconds + b.unseen) + 0.5 * s;
    if (std::hypot(rx.distance, ry.distance) > reach) return Assignment::kForbidden;
  }
  const double sizes =
      std::abs(std::log(seen.width) - b.w.value) + std::abs(std::log(seen.height) - b.h.value);
  if (sizes > 3.2) return Assignment::kForbidden;  // less than a fifth, each way: something else
  const double centre =
      std::hypot(seen.x + seen.width / 2 - b.x.position, seen.y + seen.height / 2 - b.y.position);
  return 1 - intersection_over_union(box, seen) + 0.5 * sizes + centre / s + 0.1 * std::sqrt(d2);
}

void Tracker::State::associate(bool confirmed) {
  rows.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if ((bodies[i].id != 0) == confirmed) rows.push_back(static_cast<int>(i));
  const auto columns = static_cast<int>(regions.size());
  cost.resize(rows.size() * regions.size());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < regions.size(); ++c)
      cost[r * regions.size() + c] =
          owner[c] >= 0 || used[c] ? Assignment::kForbidden : pair_cost(bodies[rows[r]], regions[c]);
  const auto partner = assignment.solve(cost, static_cast<int>(rows.size()), columns);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (partner[r] < 0) continue;
    bodies[rows[r]].region = partner[r];
    owner[partner[r]] = rows[r];
  }
}

// Leftover regions that lie where an object is expected are pieces of it.
void Tracker::State::gather_fragments() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (owner[j] >= 0 || used[j] || regions[j].confidence >= kWhole) continue;
    const Box& piece = regions[j].box;
    for (Body& b : bodies) {
      if (b.region < 0 || b.id == 0 || regions[b.region].confidence >= kWhole) continue;
      const Box expected = b.box();
      if (overlap(expected, piece) < 0.6 * piece.area() || piece.area() > 0.7 * expected.area()) continue;
      used[j] = 1;
      Region& main = regions[b.region];
      const Box both = bounding(main.box, piece);
      if (both.width < 1.25 * b.width() && both.height < 1.25 * b.height()) main.box = both;
      break;
    }
  }
}

// The region's extent replaces the track's.
void Tracker::State::adopt(Body& b, const Box& seen) {
  b.w = {std::log(seen.width), kSizeNoise * kSizeNoise};
  b.h = {std::log(seen.height), kSizeNoise * kSizeNoise};
  b.x.position = seen.x + seen.width / 2;
  b.y.position = seen.y + seen.height / 2;
  b.misfit = b.fitted = 0;
}

// One object, one region, extents that disagree. A larger region soon is right: the object came into view, or only a
// piece of it was seen before. A smaller one is a piece of an object that hardly moves (an arm) as long as it stays
// in place; it is right when the old extent was never well known, or when the piece walks away on its own.
bool Tracker::State::outgrown(Body& b, const Box& seen, bool whole) {
  if (b.misfit == 0) b.misfit_from = seen;
  b.misfit += seconds;
  b.misfit_last = seen;
  if (whole) return b.misfit >= 0.2;
  const bool larger = seen.width * seen.height > b.width() * b.height();
  if (larger) return b.misfit >= (b.fitted < 0.5 ? 0.2 : 0.6) || at_border(b);
  const double walked = std::hypot(seen.x + seen.width / 2 - b.misfit_from.x - b.misfit_from.width / 2,
                                   seen.y + seen.height / 2 - b.misfit_from.y - b.misfit_from.height / 2);
  return b.misfit >= 0.5 && (b.fitted < 0.5 || walked > 0.5 * b.size());
}

void Tracker::State::correct(Body& b, const Box& seen, double confidence, bool alone) {
  const Box box = b.box();
  const double s = b.size();
  const Residual rx = compare(box.x, box.right(), seen.x, seen.right());
  const Residual ry = compare(box.y, box.bottom(), seen.y, seen.bottom());
  const double noise = kPositionNoise * s * kPositionNoise * s, size_noise = kSizeNoise * kSizeNoise;
  b.stopped = false;
  const bool fits = rx.same_extent && ry.same_extent;
  if (!fits && alone && outgrown(b, seen, confidence >= kWhole)) {
    adopt(b, seen);
  } else {
    b.x.correct(rx.distance, rx.same_extent ? noise : 6 * noise);
    b.y.correct(ry.distance, ry.same_extent ? noise : 6 * noise);
    if (fits && alone) {
      b.w.correct(std::log(seen.width), size_noise);
      b.h.correct(std::log(seen.height), size_noise);
      b.misfit = 0;
      b.fitted += seconds;
    }
  }
  ++b.hits;
  b.unseen = 0;
  const double keep = std::exp(-seconds / 0.5);
  b.confidence = keep * b.confidence + (1 - keep) * (0.5 + 0.5 * confidence) * (fits ? 1 : 0.7);
  b.travelled = std::max(b.travelled, std::hypot(b.x.position - b.origin.x, b.y.position - b.origin.y) / s);
  b.slow = std::hypot(b.x.velocity, b.y.velocity) < kStandSpeed * s ? b.slow + seconds : 0;
  if (b.id != 0) b.top_speed = std::max(b.top_speed, std::hypot(b.x.velocity, b.y.velocity));
}

// Two objects, one blob: a confirmed track without region of its own that is expected inside a blob larger than its
// owner lives on in it. But tracks that together fill only a small part of their blob were pieces of one object: the
// oldest becomes it and the others go.
void Tracker::State::share_regions() {
  for (Body& b : bodies) {
    if (b.region >= 0 || b.id == 0) continue;
    const Box box = b.box();
    for (std::size_t j = 0; j < regions.size(); ++j) {
      if (owner[j] < 0 || regions[j].confidence >= kWhole) continue;
      const Body& first = bodies[owner[j]];
      const Box& blob = regions[j].box;
      if (first.id == 0 || overlap(box, blob) < 0.5 * box.area()) continue;
      if (blob.area() < 1.3 * first.box().area() && blob.area() < 1.3 * box.area()) continue;
      b.region = static_cast<int>(j);
      break;
    }
  }
  for (std::size_t j = 0; j < regions.size(); ++j) {
    const Region& r = regions[j];
    double filled = 0;
    int count = 0;
    Body* oldest = nullptr;
    for (Body& b : bodies) {
      if (b.region != static_cast<int>(j)) continue;
      filled += overlap(b.box(), r.box);
      ++count;
      if (!oldest || b.age > oldest->age) oldest = &b;
    }
    const bool pieces = count > 1 && filled < 0.4 * r.box.area();
    for (Body& b : bodies) {
      if (b.region != static_cast<int>(j)) continue;
      if (pieces && &b != oldest) {
        b.dead = true;
        continue;
      }
      const bool alone = count == 1 || pieces;
      correct(b, r.box, r.confidence, alone);
      b.shared = alone ? 0 : b.shared + seconds;
    }
  }
  // A track without evidence whose box holds several others was the blob they have come out of.
  for (Body& b : bodies) {
    if (b.region >= 0 || b.id == 0) continue;
    const Box box = b.box();
    int inside = 0;
    for (const Region& r : regions)
      inside += overlap(r.box, box) > 0.6 * r.box.area() && r.box.area() > 0.1 * box.area();
    b.dead |= inside > 1;
  }
  std::erase_if(bodies, [](const Body& b) { return b.dead; });
}

void Tracker::State::give_birth() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (owner[j] >= 0 || used[j] || bodies.size() >= kMaximumTracks) continue;
    const Region& r = regions[j];
    Body b;
    const double s = std::max(r.box.width, r.box.height);
    const double noise = kPositionNoise * s * kPositionNoise * s;
    b.x = {r.box.x + r.box.width / 2, 0, noise, 0, kBirthSpeed * s * kBirthSpeed * s};
    b.y = {r.box.y + r.box.height / 2, 0, noise, 0, kBirthSpeed * s * kBirthSpeed * s};
    b.w = {std::log(r.box.width), kSizeNoise * kSizeNoise};
    b.h = {std::log(r.box.height), kSizeNoise * kSizeNoise};
    b.origin = {b.x.position, b.y.position};
    b.hits = b.frames = 1;
    b.confidence = 0.5 * r.confidence;
    b.region = static_cast<int>(j);
    bodies.push_back(b);
  }
}

// Somebody who ceased to move, rather than left or went behind something: well seen before, slower and slower until
// nothing moved any more, in the open and with nobody else in the way.
bool Tracker::State::has_stopped(const Body& b) const {
  if (b.slow < 0.3 || b.fitted < 1.0 || b.travelled < 0.5 || at_border(b)) return false;
  const Box box = b.box();
  return std::none_of(bodies.begin(), bodies.end(), [&](const Body& o) {
    return &o != &b && o.id != 0 && o.region >= 0 && overlap(o.box(), box) > 0.2 * box.area();
  });
}

bool Tracker::State::at_border(const Body& b) const {
  const Box box = b.box();
  const double margin = 0.1 * b.size();
  return box.x < margin || box.y < margin || box.right() > frame.width - margin ||
         box.bottom() > frame.height - margin;
}

void Tracker::State::age() {
  for (Body& b : bodies) {
    if (b.region >= 0) {
      const bool enough = b.hits >= 3 || (b.hits >= 2 && b.age >= 3 * options.confirm_time);
      if (b.id == 0 && enough && b.age >= 0.99 * options.confirm_time && b.hits >= 0.6 * b.frames)
        b.id = ++last_id;
      continue;
    }
    b.unseen += seconds;
    if (b.id == 0) {
      b.dead = b.unseen > 0.5 * options.confirm_time && b.hits < 0.6 * b.frames;
      continue;
    }
    const bool outside =
        b.x.position < 0 || b.y.position < 0 || b.x.position > frame.width || b.y.position > frame.height;
    if (!b.stopped && has_stopped(b)) b.stopped = true;
    const double limit = b.stopped ? options.hold_stopped : options.coast_time;
    b.confidence *= std::exp(-seconds / (b.stopped ? options.hold_stopped : options.coast_time));
    b.dead = outside || b.unseen > limit || (!b.stopped && at_border(b) && b.unseen > 0.3 * limit);
  }
  std::erase_if(bodies, [](const Body& b) { return b.dead; });
}

// Two tracks on one object: the one without evidence, or else the younger, goes.
void Tracker::State::remove_duplicates() {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      Body &a = bodies[i], &b = bodies[j];
      if (a.dead || b.dead || a.id == 0 || b.id == 0) continue;
      if (intersection_over_union(a.box(), b.box()) < 0.7) continue;
      const bool twins = a.region == b.region && a.region >= 0;
      if (twins && std::max(a.shared, b.shared) < 1.0) continue;
      if (!twins && a.region >= 0 && b.region >= 0) continue;
      if (!twins && std::max(a.unseen, b.unseen) < 0.5) continue;
      Body& weaker = a.unseen != b.unseen ? (a.unseen > b.unseen ? a : b) : (a.age < b.age ? a : b);
      weaker.dead = true;
    }
  std::erase_if(bodies, [](const Body& b) { return b.dead; });
}

void Tracker::State::publish() {
  published.clear();
  for (const Body& b : bodies) {
    if (b.id == 0) continue;
    const Box box = b.box();
    if (b.region < 0 && !b.stopped && std::sqrt(b.x.pp) > 0.4 * box.width)
      continue;  // where it is, nobody knows
    const double x0 = std::clamp(box.x, 0.0, static_cast<double>(frame.width));
    const double y0 = std::clamp(box.y, 0.0, static_cast<double>(frame.height));
    const double x1 = std::clamp(box.right(), 0.0, static_cast<double>(frame.width));
    const double y1 = std::clamp(box.bottom(), 0.0, static_cast<double>(frame.height));
    if (x1 - x0 < 1 || y1 - y0 < 1) continue;
    const double speed = std::hypot(b.x.velocity, b.y.velocity);
    if (!b.stopped && speed < options.minimum_speed) continue;
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
}

std::span<const Track> Tracker::update(std::span<const Region> regions, const Transform& motion,
                                       double seconds, Size frame) {
  State& s = *state_;
  s.frame = frame;
  if (seconds > 0 && std::isfinite(seconds)) s.seconds = seconds;
  s.take(regions);
  s.predict(motion);
  s.associate(true);
  s.gather_fragments();
  s.associate(false);
  s.share_regions();
  s.give_birth();
  s.age();
  s.remove_duplicates();
  s.publish();
  return s.published;
}

}  // namespace cerberus::vision
