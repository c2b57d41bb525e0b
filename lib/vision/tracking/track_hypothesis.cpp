// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/track_hypothesis.h"

#include "sensing/angles.h"

namespace cerberus::vision {
namespace {

constexpr double kHalfPixel = 0.5;  // boxes count from pixels' corners, transforms from their centres

double square(double v) {
  return v * v;
}

Point centre(const Box& b) {
  return {b.x + b.width / 2, b.y + b.height / 2};
}

}  // namespace

Residual compare_extents(double expected_from, double expected_to, double from, double to,
                         const TrackParameters& parameters) {
  const double extent = expected_to - expected_from, seen = to - from;
  if (seen > parameters.same_extent_least * extent && seen < parameters.same_extent_most * extent)
    return {(from + to - expected_from - expected_to) / 2, true};
  const double low = from - expected_from, high = to - expected_to;
  if (seen <= extent) return {low < 0 ? low : std::max(high, 0.0), false};
  return {low > 0 ? low : std::min(high, 0.0), false};
}

TrackHypothesis TrackHypothesis::first_seen(const Region& region, const TrackParameters& parameters) {
  TrackHypothesis b;
  b.parameters = &parameters;
  b.adopt(region.box);
  const double s = b.size();
  for (MovingValue* a : {&b.x, &b.y}) {
    a->pp = square(parameters.position_noise * s);
    a->vv = square(parameters.birth_speed * s);
  }
  b.origin = {b.x.position, b.y.position};
  b.hits = b.frames = 1;
  b.confidence = 0.5 * region.confidence;
  b.kind = region.kind;
  return b;
}

void TrackHypothesis::confirm(std::uint32_t identity) {
  state = State::confirmed;
  id = identity;
  top_speed = speed();
}

void TrackHypothesis::stop() {
  state = State::stopped;
  stop_data = {};
  x.velocity = y.velocity = 0;
}

void TrackHypothesis::leave(const CameraOrientation& camera) {
  // The velocity of the part at the picture's edge is not used: its centre lags behind the object's.
  const bool still = state == State::stopped || slow > 0;
  x.velocity = still ? 0 : free_velocity.x;
  y.velocity = still ? 0 : free_velocity.y;
  if (leaving) {
    w.value = std::log(widest);
    h.value = std::log(tallest);
  }
  misfit.time = 0;
  off_screen = {};
  off_screen.stopped = state == State::stopped;
  off_screen.direction = camera.direction({x.position, y.position});
  off_screen.magnification = camera.magnification(off_screen.direction);
  state = State::off_screen;
}

void TrackHypothesis::come_back(const Box& seen) {
  if (off_screen.stopped) stop_data = {};
  state = off_screen.stopped ? State::stopped : State::coasted;
  adopt(
      seen);  // the extent before was a guess where the picture's edge had cut it, and may have been a group's
}

void TrackHypothesis::resume_stop() {
  stop_data.absent = off_screen.absent;
  state = State::stopped;
}

Box TrackHypothesis::box() const {
  const double bw = width(), bh = height();
  return {x.position - bw / 2, y.position - bh / 2, bw, bh};
}

Box TrackHypothesis::visible(Size frame) const {
  const Box b = box();
  const double least = parameters->least_visible;
  const double x0 = std::max(b.x, 0.0), y0 = std::max(b.y, 0.0);
  const double x1 = std::min<double>(b.right(), frame.width), y1 = std::min<double>(b.bottom(), frame.height);
  if (x1 - x0 < least * b.width || y1 - y0 < least * b.height) return b;
  return {x0, y0, x1 - x0, y1 - y0};
}

bool TrackHypothesis::at_border(Size frame) const {
  const Box b = box();
  const double margin = parameters->border * size();
  return b.x < margin || b.y < margin || b.right() > frame.width - margin ||
         b.bottom() > frame.height - margin;
}

// Does the picture's edge cut a region off? Not the ends of an object that fills the picture from side to side.
bool TrackHypothesis::is_cut(double from, double to, double largest, int side) const {
  const double margin = parameters->cut_margin * side;
  return (from < margin || to > side - margin) && largest < parameters->cut_most * side;
}

bool TrackHypothesis::predict(double seconds) {
  const TrackParameters& q = *parameters;
  const double s = size();
  if (stands()) {
    x.velocity = y.velocity = 0;
    for (MovingValue* a : {&x, &y})
      a->pp = std::min(a->pp + square(q.stopped_wander * s) * seconds,
                       std::max(square(q.stopped_uncertainty * s), a->pp));
  } else {
    for (MovingValue* a : {&x, &y}) a->predict(seconds, q.acceleration * s * s);
  }
  for (SlowValue* e : {&w, &h}) e->predict(seconds, q.size_wander);
  age += seconds;
  ++frames;
  match = {};
  appearance.since_contact += seconds;
  return std::isfinite(x.position) && std::isfinite(y.position);
}

// Scales all lengths but the velocities, which the caller turns as well.
void TrackHypothesis::magnify(double scale) {
  for (MovingValue* a : {&x, &y})
    for (double* p : {&a->pp, &a->pv, &a->vv}) *p *= scale * scale;
  for (double* e : {&w.value, &h.value, &first_log_width, &first_log_height}) *e += std::log(scale);
  for (double* l : {&widest, &tallest, &top_rise, &bottom_drop}) *l *= scale;
}

// How far, in S, its edges have gone because it came nearer or went away: the centre of an object that walks straight
// towards the camera stays where it is. Both extents must agree: a place that is uncovered, and an object that appears
// part by part, grow along one axis.
double TrackHypothesis::approach() const {
  const double wider = w.value - first_log_width, taller = h.value - first_log_height;
  if (wider * taller <= 0) return 0;
  return 0.5 * (1 - std::exp(-std::min(std::abs(wider), std::abs(taller))));
}

// How far, in S, its lower end has gone down, or its upper end up, while the other end stayed. A person who stood there
// when the scene began is part of the background model: where he walks straight up or down the picture, his place is
// foreground for as long as he covers a part of it. Before a moving camera ends move for other reasons.
double TrackHypothesis::stretch() const {
  return height() > parameters->upright * width() ? std::abs(bottom_drop - top_rise) / size() : 0;
}

// An end that goes on steadily is a walker's. One that jumps reveals more of the object.
void TrackHypothesis::follow_ends(const Box& seen, double seconds, Size frame) {
  const double most = parameters->end_speed * size() * seconds + parameters->grain * frame.width;
  const auto follow = [most](double& gone, double step) {
    gone = step > most ? 0 : std::max(0.0, gone + step);
  };
  follow(top_rise, last.y - seen.y);
  follow(bottom_drop, seen.bottom() - last.bottom());
}

// A region that grows by so much from one frame to the next has met another object, or reveals more of its own.
bool TrackHypothesis::jumps(const Box& seen, double seconds) const {
  return std::max(
             {last.x - seen.x, seen.right() - last.right(), last.y - seen.y, seen.bottom() - last.bottom()}) >
         (parameters->jump + parameters->jump_speed * seconds) * size();
}

// To first order around the centre: J = d(motion)/d(point), velocity := J velocity, lengths scale by sqrt(det J).
bool TrackHypothesis::carry(const Transform& motion, Size frame) {
  if (motion.is_identity()) return true;
  // The camera's motion is known to about a pixel of the analysed picture.
  for (MovingValue* a : {&x, &y}) a->pp += square(parameters->grain * frame.width);
  const Point p{x.position - kHalfPixel, y.position - kHalfPixel};
  const Point q = motion.apply(p), right = motion.apply({p.x + 1, p.y}), down = motion.apply({p.x, p.y + 1});
  const double xx = right.x - q.x, yx = right.y - q.y, xy = down.x - q.x, yy = down.y - q.y;
  const double det = xx * yy - xy * yx;
  constexpr double kSingular = 1e-3;  // an area that shrinks to less is no view of the same object
  if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(det) || !(det > kSingular)) return false;
  const auto turned = [&](Point v) { return Point{xx * v.x + xy * v.y, yx * v.x + yy * v.y}; };
  const double top = motion.apply({p.x, last.y - kHalfPixel}).y,
               left = motion.apply({last.x - kHalfPixel, p.y}).x;
  const double bottom = motion.apply({p.x, last.bottom() - kHalfPixel}).y,
               end = motion.apply({last.right() - kHalfPixel, p.y}).x;
  last = {left + kHalfPixel, top + kHalfPixel, end - left, bottom - top};
  if (std::hypot(q.x - p.x, q.y - p.y) > parameters->camera_still * frame.width) top_rise = bottom_drop = 0;
  const Point velocity = turned({x.velocity, y.velocity});
  x.position = q.x + kHalfPixel;
  y.position = q.y + kHalfPixel;
  x.velocity = velocity.x;
  y.velocity = velocity.y;
  free_velocity = turned(free_velocity);
  magnify(std::sqrt(det));
  for (Point* place : {&origin, &misfit.from}) *place = motion.apply(*place);
  return true;
}

void TrackHypothesis::predict_off_screen(double seconds, const CameraOrientation& camera) {
  const Point before{x.position, y.position};
  predict(seconds);
  Direction& direction = off_screen.direction;
  const double pixels = camera.lens.focal_length() * off_screen.magnification;  // a radian, about there
  direction.bearing = sensing::wrap(direction.bearing + (x.position - before.x) / pixels);
  direction.elevation -= (y.position - before.y) / pixels;
  const auto seen = camera.project(direction);
  off_screen.in_front = seen.has_value();
  x.position = seen ? seen->x : before.x;
  y.position = seen ? seen->y : before.y;
  origin.x += x.position - before.x;
  origin.y += y.position - before.y;
  const double now = camera.magnification(direction), scale = now / off_screen.magnification;
  off_screen.magnification = now;
  for (double* v : {&x.velocity, &y.velocity, &free_velocity.x, &free_velocity.y}) *v *= scale;
  magnify(scale);
}

bool TrackHypothesis::expected_in(Size frame) const {
  const Box b = box();
  return off_screen.in_front && b.x > 0 && b.y > 0 && b.right() < frame.width && b.bottom() < frame.height;
}

double TrackHypothesis::distance(const Box& seen, Size frame) const {
  const TrackParameters& q = *parameters;
  const bool returns = state == State::off_screen;
  const Box b = returns ? visible(frame) : box();
  const double s = size();
  const Residual rx = compare_extents(b.x, b.right(), seen.x, seen.right(), q);
  const Residual ry = compare_extents(b.y, b.bottom(), seen.y, seen.bottom(), q);
  const double noise = square(q.gate_noise * s);
  const double d2 = square(rx.distance) / (x.pp + noise) + square(ry.distance) / (y.pp + noise);
  const double gate = returns                                    ? q.off_screen_gate
                      : seen.area() < q.fragment_area * b.area() ? q.fragment_gate
                                                                 : q.gate;
  if (d2 > square(gate)) return -1;
  const double sizes = std::abs(std::log(seen.width / b.width)) + std::abs(std::log(seen.height / b.height));
  if (sizes > 2 * std::log(q.largest_ratio)) return -1;
  const Point c = centre(seen);
  return 1 - intersection_over_union(b, seen) + q.size_cost * sizes +
         std::hypot(c.x - b.x - b.width / 2, c.y - b.y - b.height / 2) / s + q.gate_cost * std::sqrt(d2);
}

// A person who stands dissolves from the mask piece by piece without getting smaller; an object that the picture's edge
// cuts shows more or less of itself with every frame.
void TrackHypothesis::resize(SlowValue& extent, double seen, bool is_cut, double seconds) {
  const TrackParameters& q = *parameters;
  const bool fades = !is_cut && speed() < q.stand_speed * size() && std::log(seen) < extent.value;
  if (is_cut) extent.variance += q.border_wander * seconds;
  extent.correct(std::log(seen), square(q.size_noise) * (fades ? q.fade : 1));
}

// The region's extent replaces the track's.
void TrackHypothesis::adopt(const Box& seen) {
  w = {std::log(seen.width), square(parameters->size_noise)};
  h = {std::log(seen.height), square(parameters->size_noise)};
  first_log_width = w.value;
  first_log_height = h.value;
  x.position = centre(seen).x;
  y.position = centre(seen).y;
  misfit.time = fitted = 0;
  last = seen;
  top_rise = bottom_drop = 0;
}

// One object, one region, extents that disagree: does the region's extent replace the track's?
//   cut by the picture's edge: yes, the object comes or goes.
//   person-like: after whole_misfit.
//   larger: soon. Only a part was seen before, or the object runs off and its region stretches from the place where it
//     stood, which stays foreground until the background model has learnt it. Later if the region jumped: it may be a group.
//   smaller: a fragment (an arm) of a standing object, as long as it stays in place. Yes if the object moved, if its
//     extent was never well known, or if the fragment walks away on its own.
bool TrackHypothesis::outgrown(const Box& seen, bool whole, bool cut, double seconds) {
  const TrackParameters& q = *parameters;
  if (misfit.time == 0) {
    misfit.from = centre(seen);
    misfit.was_still = slow > 0 || stands();
    misfit.jumped = false;
  }
  misfit.jumped = misfit.jumped || jumps(seen, stands() ? seconds : seconds + unseen);
  misfit.time += seconds;
  if (cut || match.reshaped) return true;
  if (whole) return misfit.time >= q.whole_misfit;
  if (seen.area() > box().area())
    return misfit.time >= (fitted < q.extent_known || !misfit.jumped ? q.growing_misfit : q.jumped_misfit);
  const Point to = centre(seen);
  const double gone = std::hypot(to.x - misfit.from.x, to.y - misfit.from.y);
  return misfit.time >= q.shrinking_misfit &&
         (!misfit.was_still || fitted < q.extent_known || gone > q.fragment_walk * size());
}

void TrackHypothesis::correct(const Region& r, bool alone, double seconds, Size frame,
                              const std::optional<Point>& found) {
  const TrackParameters& q = *parameters;
  const bool tentative = state == State::tentative;
  const Box b = box(), &seen = r.box;
  const double s = size(), noise = square(q.position_noise * s) + square(q.grain * frame.width);
  Residual rx = compare_extents(b.x, b.right(), seen.x, seen.right(), q);
  Residual ry = compare_extents(b.y, b.bottom(), seen.y, seen.bottom(), q);
  const bool fits = rx.same_extent && ry.same_extent;
  // Where the edge cuts a region off it changes because the object comes or goes, unless the object is seen to stand
  // there and only its moving part became smaller.
  const bool stays_there = stays();
  const bool cut_x = !stays_there && is_cut(seen.x, seen.right(), widest, frame.width);
  const bool cut_y = !stays_there && is_cut(seen.y, seen.bottom(), tallest, frame.height);
  const bool within_x = seen.x >= b.x && seen.right() <= b.right();
  const bool within_y = seen.y >= b.y && seen.bottom() <= b.bottom();
  const bool fragment = !fits && seen.area() < b.area();
  if (stays_there && (within_x || fragment)) rx.distance = 0;
  if (stays_there && (within_y || fragment)) ry.distance = 0;
  const Point was{x.position, y.position};
  leaving = (cut_x && seen.width < q.leaving * widest) || (cut_y && seen.height < q.leaving * tallest);
  if (!fits && alone && outgrown(seen, is_person_like(r), cut_x || cut_y, seconds)) {
    adopt(seen);
    // Another extent is no distance travelled, unless the object came in meanwhile: what it has travelled, in S, stays.
    if (tentative && !cut_x && !cut_y)
      origin = {x.position - (was.x - origin.x) * size() / s, y.position - (was.y - origin.y) * size() / s};
  } else if (found) {
    x.correct(found->x, square(q.found_noise * s));
    y.correct(found->y, square(q.found_noise * s));
    y.velocity *= std::exp(-seconds / q.found_brake);
  } else {
    const double variance = fits && !match.occluded ? noise : q.blob_noise * noise;
    x.correct(rx.distance, variance);
    y.correct(ry.distance, variance);
    // Nor is a smaller region within the expected box.
    if (tentative && within_x) origin.x += x.position - was.x;
    if (tentative && within_y) origin.y += y.position - was.y;
    if (fits && alone) {
      if (tentative) follow_ends(seen, seconds + unseen, frame);
      if (!(stays_there && within_x)) resize(w, seen.width, cut_x, seconds);
      if (!(stays_there && within_y)) resize(h, seen.height, cut_y, seconds);
      misfit.time = 0;
      fitted += seconds;
      longest_fit = std::max(longest_fit, fitted);
    } else if (alone && seen.area() < b.area()) {
      const double brake = std::exp(-seconds / q.fragment_brake);
      if (!rx.same_extent) x.velocity *= brake;
      if (!ry.same_extent) y.velocity *= brake;
    }
  }
  if (alone) last = seen, kind = r.kind;
  // A track is not larger than a region that it shares, if the region holds all of the object.
  if (!alone && !match.occluded && !stays_there) {
    if (seen.width < width()) w.value = std::log(seen.width);
    if (seen.height < height()) h.value = std::log(seen.height);
  }
  if (!cut_x && !cut_y) free_velocity = {x.velocity, y.velocity};
  widest = std::max(widest, width());
  tallest = std::max(tallest, height());
  if (state == State::coasted || state == State::stopped) state = State::confirmed;
  ++hits;
  unseen = 0;
  const double keep = std::exp(-seconds / q.confidence_time);
  confidence = keep * confidence + (1 - keep) * (0.5 + 0.5 * r.confidence) * (fits ? 1 : q.misfit_confidence);
  travelled = std::max(
      {travelled, std::hypot(x.position - origin.x, y.position - origin.y) / s, approach(), stretch()});
  slow = speed() < q.stand_speed * s ? slow + seconds : 0;
  if (!tentative) top_speed = std::max(top_speed, speed());
}

void TrackHypothesis::miss(double seconds) {
  if (state == State::confirmed) state = State::coasted;
  unseen += seconds;
  const double brake = std::exp(
      -seconds / (state == State::off_screen ? parameters->off_screen_brake : parameters->coast_brake));
  x.velocity *= brake;
  y.velocity *= brake;
}

bool TrackHypothesis::stays() const {
  return (stands() || slow >= parameters->settled) && appearance.place_change >= 0 &&
         appearance.place_change < parameters->same_place;
}

void TrackHypothesis::learn_place(const AppearanceModel& all, double seconds) {
  if (slow == 0)
    appearance.place = {};
  else
    appearance.place.learn(all, 1 - std::exp(-seconds / parameters->appearance_time));
}

bool TrackHypothesis::has_appearance() const {
  return appearance.frames >= parameters->appearance_frames;
}

bool TrackHypothesis::has_recent_appearance() const {
  return appearance.recent_frames >= parameters->recent_frames;
}

bool TrackHypothesis::is_ambiguous() const {
  return appearance.since_contact < parameters->ambiguous_time ||
         appearance_distance(appearance.model, appearance.recent) > parameters->changed;
}

void TrackHypothesis::touch() {
  appearance.since_contact = 0;
  appearance.recent_frames = 0;
}

void TrackHypothesis::remember(const AppearanceModel& seen, double seconds, bool isolated) {
  const TrackParameters& q = *parameters;
  Appearance& a = appearance;
  if (a.frames > 0) a.change = std::max(0.0, appearance_distance(a.model, seen));
  if (!isolated) {
    touch();
    return;
  }
  const auto learn = [&](AppearanceModel& model, int& count, double time) {
    if (++count == 1)
      model = seen;
    else
      model.learn(seen, std::max(1.0 / count, 1 - std::exp(-seconds / time)));
  };
  learn(a.recent, a.recent_frames, q.recent_time);
  const bool frozen = a.since_contact < q.freeze ||
                      (a.since_contact < q.relearn && appearance_distance(a.model, a.recent) > q.changed);
  if (!has_appearance() || !frozen) learn(a.model, a.frames, q.appearance_time);
}

}  // namespace cerberus::vision
