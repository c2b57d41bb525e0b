// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/track_hypothesis.h"

#include "sensing/angles.h"

namespace cerberus::vision {
namespace {

// People start, stop and turn within about a second: velocity wanders by 0.8 S/s in one.
constexpr double kAcceleration = 0.5 * 0.5;  // S^2 / s^3
constexpr double kBirthSpeed = 3.0;          // S/s, standard deviation of the unknown first velocity
constexpr double kPositionNoise = 0.05;      // S: a region's centre flickers by this
constexpr double kGateNoise = 0.15;          // S: what a place may be wrong by, beyond the filter's own doubt
constexpr double kGrain = 1.0 / 320;         // of the frame's width: pixels of the picture that was analysed
constexpr double kSizeNoise = 0.15;          // of the logarithm: a region's extent flickers by 15 %
constexpr double kSizeWander = 0.15 * 0.15;  // 1/s: and truly changes by 15 % in a second
constexpr double kBorderWander = 1.5 * 1.5;  // 1/s: what is cut by the border grows and shrinks fast
constexpr double kEndSpeed = 1.0;            // S/s: an end that goes faster shows that more of it is seen
constexpr double kLeap = 0.15;               // S: an end that goes on by more from one frame to the next,
constexpr double kRun = 2.5;                 // S/s: and faster than a runner's, has leapt
constexpr double kUpright = 1.3;             // times as tall as wide, at least
constexpr double kStandsBy = 0.5 * kGrain;   // of the frame's width: as far a standing camera seems to move
constexpr double kStandSpeed = 0.3;          // S/s: slower than this (0.5 m/s) may have stopped
constexpr double kFarthest = 4.0;            // standard deviations of the place at which a region may be
constexpr double kFarthestAway = 3.0;        // and where nobody was looked for meanwhile, who else may come
constexpr double kPiece = 0.2;               // of its area: as little may be a piece of it,
constexpr double kFarthestPiece = 1.5;       // and lies where it is, or very near
constexpr double kCoastBrake = 1.0;          // s in which what is not seen is believed to slow down
constexpr double kAwayBrake = 3.0;           // s, for who walked on when the camera turned away
constexpr double kPieceBrake = 0.4;          // s, when only a piece of it moves
constexpr double kFade = 20.0;               // how much less a shrinking extent counts while standing
constexpr double kLookTime = 2.0;            // s in which somebody may turn round and look different
constexpr double kFoundNoise = 0.1;          // S: how well a look tells where in a group somebody is
constexpr double kFoundBrake = 0.5;          // s: it does not tell how high
constexpr int kRecent = 3;                   // frames from which on it is known what somebody looks like now,
constexpr double kRecentTime = 0.5;          // s of which that counts
constexpr double kDoubt = 2.0;               // s after which who is who would have been told
constexpr double kFreeze = 0.5;   // s after somebody else was close in which nothing is learnt of a look
constexpr double kChanged = 0.3;  // looks as different now may be two people's,
constexpr double kRelearn = 4.0;  // for so long: then they are one's who has changed
constexpr double kSettled = 1.0;  // s: who has stood for less is not taken for a part of the scene
constexpr int kLooks = 3;         // from which on a look is known
// Of a place's pixels: as many look different because of noise, folds and arms.
constexpr double kSamePlace = 0.15;
constexpr double kHalfPixel = 0.5;  // boxes count from pixels' corners, transforms from their centres

double square(double v) {
  return v * v;
}

// Does the picture's edge cut a region off? Not the ends of somebody who fills the picture from one side to the other.
bool cut(double from, double to, double largest, int side) {
  const double margin = 0.01 * side;
  return (from < margin || to > side - margin) && largest < 0.7 * side;
}

Point centre(const Box& b) {
  return {b.x + b.width / 2, b.y + b.height / 2};
}

}  // namespace

Residual compare_extents(double expected_from, double expected_to, double from, double to) {
  const double extent = expected_to - expected_from, seen = to - from;
  if (seen > 0.65 * extent && seen < 1.5 * extent)
    return {(from + to - expected_from - expected_to) / 2, true};
  const double low = from - expected_from, high = to - expected_to;
  if (seen <= extent) return {low < 0 ? low : std::max(high, 0.0), false};
  return {low > 0 ? low : std::min(high, 0.0), false};
}

TrackHypothesis TrackHypothesis::first_seen(const Region& region) {
  TrackHypothesis b;
  b.adopt(region.box);
  const double s = b.size();
  for (MovingValue* a : {&b.x, &b.y}) {
    a->pp = square(kPositionNoise * s);
    a->vv = square(kBirthSpeed * s);
  }
  b.origin = {b.x.position, b.y.position};
  b.hits = b.frames = 1;
  b.confidence = 0.5 * region.confidence;
  return b;
}

Box TrackHypothesis::box() const {
  const double bw = width(), bh = height();
  return {x.position - bw / 2, y.position - bh / 2, bw, bh};
}

Box TrackHypothesis::visible(Size frame) const {
  const Box b = box();
  const double x0 = std::max(b.x, 0.0), y0 = std::max(b.y, 0.0);
  const double x1 = std::min<double>(b.right(), frame.width), y1 = std::min<double>(b.bottom(), frame.height);
  if (x1 - x0 < 0.1 * b.width || y1 - y0 < 0.1 * b.height) return b;
  return {x0, y0, x1 - x0, y1 - y0};
}

bool TrackHypothesis::at_border(Size frame) const {
  const Box b = box();
  const double margin = 0.1 * size();
  return b.x < margin || b.y < margin || b.right() > frame.width - margin ||
         b.bottom() > frame.height - margin;
}

bool TrackHypothesis::predict(double seconds) {
  const double s = size();
  if (stopped) {
    // Stands still; where exactly is less and less sure, but never by more than half a body.
    x.velocity = y.velocity = 0;
    for (MovingValue* a : {&x, &y})
      a->pp = std::min(a->pp + square(0.1 * s) * seconds, std::max(square(0.5 * s), a->pp));
  } else {
    for (MovingValue* a : {&x, &y}) a->predict(seconds, kAcceleration * s * s);
  }
  for (SlowValue* e : {&w, &h}) e->predict(seconds, kSizeWander);
  age += seconds;
  ++frames;
  region = -1;
  hidden = parted = false;
  clear += seconds;
  return std::isfinite(x.position) && std::isfinite(y.position);
}

// All lengths but the velocities, which the caller turns as well.
void TrackHypothesis::magnify(double scale) {
  for (MovingValue* a : {&x, &y})
    for (double* p : {&a->pp, &a->pv, &a->vv}) *p *= scale * scale;
  for (double* e : {&w.value, &h.value, &born_width, &born_height}) *e += std::log(scale);
  for (double* l : {&widest, &tallest, &risen, &sunk}) *l *= scale;
}

// How far, in S, its edges have gone because it came nearer or went away. Who walks straight towards the camera grows
// and his middle stays where it is. Both ways alike: a place that somebody uncovers, and a piece of which more and more
// is seen, grow one way.
double TrackHypothesis::neared() const {
  const double wider = w.value - born_width, taller = h.value - born_height;
  if (wider * taller <= 0) return 0;
  return 0.5 * (1 - std::exp(-std::min(std::abs(wider), std::abs(taller))));
}

// How far, in S, its feet have gone down, or its head up, while the other end stayed. Who stood there when the scene
// began is in the memory: he walks straight up or down, and his place shows for as long as he covers a part of it.
// Before a camera that moves ends go for other reasons.
double TrackHypothesis::stretched() const {
  return height() > kUpright * width() ? std::abs(sunk - risen) / size() : 0;
}

// A walker's end goes on steadily. One that leaps shows that more of him is seen.
void TrackHypothesis::follow_ends(const Box& seen, double seconds, Size frame) {
  const double most = kEndSpeed * size() * seconds + kGrain * frame.width;
  const auto follow = [most](double& gone, double step) {
    gone = step > most ? 0 : std::max(0.0, gone + step);
  };
  follow(risen, last.y - seen.y);
  follow(sunk, seen.bottom() - last.bottom());
}

// What grows by as much from one frame to the next has met somebody, or shows what it had not.
bool TrackHypothesis::leaps(const Box& seen, double seconds) const {
  return std::max({last.x - seen.x, seen.right() - last.right(), last.y - seen.y,
                   seen.bottom() - last.bottom()}) > (kLeap + kRun * seconds) * size();
}

// To first order around the centre: J = d(motion)/d(point), velocity := J velocity, lengths scale by sqrt(det J).
bool TrackHypothesis::carry(const Transform& motion, Size frame) {
  if (motion.is_identity()) return true;
  // The camera's motion is known to about a pixel of the analysed picture.
  for (MovingValue* a : {&x, &y}) a->pp += square(kGrain * frame.width);
  const Point p{x.position - kHalfPixel, y.position - kHalfPixel};
  const Point q = motion.apply(p), right = motion.apply({p.x + 1, p.y}), down = motion.apply({p.x, p.y + 1});
  const double xx = right.x - q.x, yx = right.y - q.y, xy = down.x - q.x, yy = down.y - q.y;
  const double det = xx * yy - xy * yx;
  if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(det) || !(det > 1e-3)) return false;
  const auto turned = [&](Point v) { return Point{xx * v.x + xy * v.y, yx * v.x + yy * v.y}; };
  const double top = motion.apply({p.x, last.y - kHalfPixel}).y,
               left = motion.apply({last.x - kHalfPixel, p.y}).x;
  const double bottom = motion.apply({p.x, last.bottom() - kHalfPixel}).y,
               end = motion.apply({last.right() - kHalfPixel, p.y}).x;
  last = {left + kHalfPixel, top + kHalfPixel, end - left, bottom - top};
  if (std::hypot(q.x - p.x, q.y - p.y) > kStandsBy * frame.width) risen = sunk = 0;
  const Point velocity = turned({x.velocity, y.velocity});
  x.position = q.x + kHalfPixel;
  y.position = q.y + kHalfPixel;
  x.velocity = velocity.x;
  y.velocity = velocity.y;
  walk = turned(walk);
  magnify(std::sqrt(det));
  for (Point* place : {&origin, &misfit_from}) *place = motion.apply(*place);
  return true;
}

void TrackHypothesis::leave(const CameraOrientation& gaze) {
  // It is not the piece at the picture's edge that comes back, whose middle lagged behind.
  const bool stands = stopped || slow > 0;
  x.velocity = stands ? 0 : walk.x;
  y.velocity = stands ? 0 : walk.y;
  if (leaving) {
    w.value = std::log(widest);
    h.value = std::log(tallest);
  }
  away = ahead = true;
  absent = misfit = 0;
  where = gaze.direction({x.position, y.position});
  magnification = gaze.magnification(where);
}

void TrackHypothesis::predict_away(double seconds, const CameraOrientation& gaze) {
  const Point before{x.position, y.position};
  predict(seconds);
  const double pixels = gaze.lens.focal_length() * magnification;  // a radian, about there
  where.bearing = sensing::wrap(where.bearing + (x.position - before.x) / pixels);
  where.elevation -= (y.position - before.y) / pixels;
  const auto seen = gaze.project(where);
  ahead = seen.has_value();
  x.position = ahead ? seen->x : before.x;
  y.position = ahead ? seen->y : before.y;
  origin.x += x.position - before.x;
  origin.y += y.position - before.y;
  const double now = gaze.magnification(where), scale = now / magnification;
  magnification = now;
  for (double* v : {&x.velocity, &y.velocity, &walk.x, &walk.y}) *v *= scale;
  magnify(scale);
}

void TrackHypothesis::come_back(const Box& seen) {
  away = false;
  adopt(seen);  // what it was when the picture's edge cut it was a guess, and may have been a group
}

bool TrackHypothesis::expected_in(Size frame) const {
  const Box b = box();
  return ahead && b.x > 0 && b.y > 0 && b.right() < frame.width && b.bottom() < frame.height;
}

double TrackHypothesis::distance(const Box& seen, Size frame) const {
  const Box b = away ? visible(frame) : box();
  const double s = size();
  const Residual rx = compare_extents(b.x, b.right(), seen.x, seen.right());
  const Residual ry = compare_extents(b.y, b.bottom(), seen.y, seen.bottom());
  const double noise = square(kGateNoise * s);
  const double d2 = square(rx.distance) / (x.pp + noise) + square(ry.distance) / (y.pp + noise);
  const double farthest = away ? kFarthestAway : seen.area() < kPiece * b.area() ? kFarthestPiece : kFarthest;
  if (d2 > square(farthest)) return -1;
  const double sizes = std::abs(std::log(seen.width / b.width)) + std::abs(std::log(seen.height / b.height));
  if (sizes > 2 * std::log(10.0)) return -1;  // a tenth or ten times each way is something else
  const Point c = centre(seen);
  return 1 - intersection_over_union(b, seen) + 0.5 * sizes +
         std::hypot(c.x - b.x - b.width / 2, c.y - b.y - b.height / 2) / s + 0.1 * std::sqrt(d2);
}

// Who stands dissolves from the mask piece by piece without getting smaller; who is cut by the picture's edge shows
// more or less of himself with every frame.
void TrackHypothesis::resize(SlowValue& extent, double seen, bool is_cut, double seconds) {
  const bool fades = !is_cut && speed() < kStandSpeed * size() && std::log(seen) < extent.value;
  if (is_cut) extent.variance += kBorderWander * seconds;
  extent.correct(std::log(seen), square(kSizeNoise) * (fades ? kFade : 1));
}

// The region's extent replaces the track's.
void TrackHypothesis::adopt(const Box& seen) {
  w = {std::log(seen.width), square(kSizeNoise)};
  h = {std::log(seen.height), square(kSizeNoise)};
  born_width = w.value;
  born_height = h.value;
  x.position = centre(seen).x;
  y.position = centre(seen).y;
  misfit = fitted = 0;
  last = seen;
  risen = sunk = 0;
}

// One object, one region, extents that disagree: is the region right? One that is cut by the picture's edge is, as the
// object comes or goes, and a whole one is after two looks. A larger one soon is: only a piece was seen before, or
// somebody runs off and stretches from where he stood, which shows until the memory knows the place. A smaller one is a
// piece of an object that stands (an arm) as long as it stays in place; it is right when the object was on the way,
// when its extent was never well known, or when the piece walks away on its own.
bool TrackHypothesis::outgrown(const Box& seen, bool whole, bool cut, double seconds) {
  if (misfit == 0) {
    misfit_from = centre(seen);
    stood = slow > 0 || stopped;
    leapt = false;
  }
  leapt = leapt || leaps(seen, stopped ? seconds : seconds + unseen);
  misfit += seconds;
  if (cut || parted) return true;
  if (whole) return misfit >= 0.2;
  if (seen.area() > box().area()) return misfit >= (fitted < 0.5 || !leapt ? 0.2 : 0.6);
  const Point to = centre(seen);
  const double gone = std::hypot(to.x - misfit_from.x, to.y - misfit_from.y);
  return misfit >= 0.5 && (!stood || fitted < 0.5 || gone > 0.5 * size());
}

void TrackHypothesis::correct(const Region& r, bool alone, double seconds, Size frame,
                              const std::optional<Point>& found) {
  const Box b = box(), &seen = r.box;
  const double s = size(), noise = square(kPositionNoise * s) + square(kGrain * frame.width);
  Residual rx = compare_extents(b.x, b.right(), seen.x, seen.right());
  Residual ry = compare_extents(b.y, b.bottom(), seen.y, seen.bottom());
  const bool fits = rx.same_extent && ry.same_extent;
  // Where the edge cuts a region off it changes because somebody comes or goes, unless he is seen to stand there and
  // only what moves of him got less.
  const bool stands = stays();
  const bool cut_x = !stands && cut(seen.x, seen.right(), widest, frame.width);
  const bool cut_y = !stands && cut(seen.y, seen.bottom(), tallest, frame.height);
  const bool within_x = seen.x >= b.x && seen.right() <= b.right();
  const bool within_y = seen.y >= b.y && seen.bottom() <= b.bottom();
  const bool piece = !fits && seen.area() < b.area();
  if (stands && (within_x || piece)) rx.distance = 0;
  if (stands && (within_y || piece)) ry.distance = 0;
  const Point was{x.position, y.position};
  leaving = (cut_x && seen.width < 0.7 * widest) || (cut_y && seen.height < 0.7 * tallest);
  if (!fits && alone && outgrown(seen, r.confidence >= kWhole, cut_x || cut_y, seconds)) {
    adopt(seen);
    // Another extent is no way that it went, if it did not come in meanwhile: what it has travelled, in S, stays.
    if (id == 0 && !cut_x && !cut_y)
      origin = {x.position - (was.x - origin.x) * size() / s, y.position - (was.y - origin.y) * size() / s};
  } else if (found) {
    x.correct(found->x, square(kFoundNoise * s));
    y.correct(found->y, square(kFoundNoise * s));
    y.velocity *= std::exp(-seconds / kFoundBrake);
  } else {
    x.correct(rx.distance, fits && !hidden ? noise : 6 * noise);
    y.correct(ry.distance, fits && !hidden ? noise : 6 * noise);
    // Nor is it one that less is seen within where it was expected.
    if (id == 0 && within_x) origin.x += x.position - was.x;
    if (id == 0 && within_y) origin.y += y.position - was.y;
    if (fits && alone) {
      if (id == 0) follow_ends(seen, seconds + unseen, frame);
      if (!(stands && within_x)) resize(w, seen.width, cut_x, seconds);
      if (!(stands && within_y)) resize(h, seen.height, cut_y, seconds);
      misfit = 0;
      fitted += seconds;
      proven = std::max(proven, fitted);
    } else if (alone && seen.area() < b.area()) {
      const double brake = std::exp(-seconds / kPieceBrake);
      if (!rx.same_extent) x.velocity *= brake;
      if (!ry.same_extent) y.velocity *= brake;
    }
  }
  if (alone) last = seen;
  // Nobody is larger than a region that he shares, if it is all that there is of him.
  if (!alone && !hidden && !stands) {
    if (seen.width < width()) w.value = std::log(seen.width);
    if (seen.height < height()) h.value = std::log(seen.height);
  }
  if (!cut_x && !cut_y) walk = {x.velocity, y.velocity};
  widest = std::max(widest, width());
  tallest = std::max(tallest, height());
  stopped = false;
  ++hits;
  unseen = 0;
  const double keep = std::exp(-seconds / 0.5);
  confidence = keep * confidence + (1 - keep) * (0.5 + 0.5 * r.confidence) * (fits ? 1 : 0.7);
  travelled = std::max(
      {travelled, std::hypot(x.position - origin.x, y.position - origin.y) / s, neared(), stretched()});
  slow = speed() < kStandSpeed * s ? slow + seconds : 0;
  if (id != 0) top_speed = std::max(top_speed, speed());
}

bool TrackHypothesis::stays() const {
  return (stopped || slow >= kSettled) && changed >= 0 && changed < kSamePlace;
}

void TrackHypothesis::settle(const AppearanceModel& all, double seconds) {
  if (slow == 0)
    place = {};
  else
    place.learn(all, 1 - std::exp(-seconds / kLookTime));
}

bool TrackHypothesis::well_known() const {
  return looked >= kLooks;
}

bool TrackHypothesis::knows_recent() const {
  return recently >= kRecent;
}

bool TrackHypothesis::doubted() const {
  return clear < kDoubt || appearance_distance(look, recent) > kChanged;
}

void TrackHypothesis::mix() {
  clear = 0;
  recently = 0;
}

void TrackHypothesis::remember(const AppearanceModel& seen, double seconds, bool nobody_near) {
  if (looked > 0) unlikeness = std::max(0.0, appearance_distance(look, seen));
  if (!nobody_near) {
    mix();
    return;
  }
  const auto learn = [&](AppearanceModel& what, int& count, double time) {
    if (++count == 1)
      what = seen;
    else
      what.learn(seen, std::max(1.0 / count, 1 - std::exp(-seconds / time)));
  };
  learn(recent, recently, kRecentTime);
  const bool frozen = clear < kFreeze || (clear < kRelearn && appearance_distance(look, recent) > kChanged);
  if (!well_known() || !frozen) learn(look, looked, kLookTime);
}

void TrackHypothesis::miss(double seconds) {
  unseen += seconds;
  const double brake = std::exp(-seconds / (away ? kAwayBrake : kCoastBrake));
  x.velocity *= brake;
  y.velocity *= brake;
}

}  // namespace cerberus::vision
