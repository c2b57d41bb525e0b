// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/track_hypothesis.h"

#include <type_traits>

#include "sensing/angles.h"

namespace cerberus::vision {
namespace {

// phase_of() takes an alternative's index for its phase.
template <TrackPhase phase, class Data>
constexpr bool kHasData =
    std::is_same_v<std::variant_alternative_t<static_cast<std::size_t>(phase), TrackLife>, Data>;
static_assert(kHasData<TrackPhase::tentative, Tentative> && kHasData<TrackPhase::confirmed, Confirmed> &&
              kHasData<TrackPhase::coasted, Coasted> && kHasData<TrackPhase::stopped, Stopped> &&
              kHasData<TrackPhase::off_screen, OffScreen> && kHasData<TrackPhase::lost, Lost> &&
              std::variant_size_v<TrackLife> == 6);

constexpr double kHalfPixel = 0.5;  // boxes count from pixels' corners, transforms from their centres

}  // namespace

Residual compare_extents(double expected_from, double expected_to, double from, double to,
                         const TrackParameters& parameters) {
  const double extent = expected_to - expected_from, seen = to - from;
  if (seen * parameters.same_extent > extent && seen < parameters.same_extent * extent)
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
  b.travel.origin = {b.x.position, b.y.position};
  b.confidence = 0.5 * region.confidence;
  b.kind = region.kind;
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
  if (!(x1 > x0 && y1 > y0)) return b;
  return {x0, y0, x1 - x0, y1 - y0};
}

bool TrackHypothesis::at_border(Size frame) const {
  const Box b = box();
  const double margin = parameters->border * size();
  return b.x < margin || b.y < margin || b.right() > frame.width - margin ||
         b.bottom() > frame.height - margin;
}

bool TrackHypothesis::predict(double seconds, bool camera_moves) {
  const TrackParameters& q = *parameters;
  const double s = size();
  camera_moved = camera_moves;
  if (stands()) {
    x.velocity = y.velocity = 0;
  } else if (!walked_out()) {
    const double acceleration = camera_moves ? q.panned_acceleration : q.acceleration;
    const double faster = std::max(1.0, speed() / (q.fast * s));
    for (MovingValue* a : {&x, &y}) a->predict(seconds, acceleration * square(faster * s));
  }
  for (SlowValue* e : {&w, &h}) e->predict(seconds, square(q.size_noise));
  age += seconds;
  if (auto* data = std::get_if<Tentative>(&life)) ++data->frames;
  match = {};
  return std::isfinite(x.position) && std::isfinite(y.position);
}

// Scales all lengths but the velocities, which the caller turns as well.
void TrackHypothesis::magnify(double scale) {
  for (MovingValue* a : {&x, &y})
    for (double* p : {&a->pp, &a->pv, &a->vv}) *p *= scale * scale;
  for (double* e : {&w.value, &h.value, &travel.log_width, &travel.log_height}) *e += std::log(scale);
  for (double* l : {&uncut.width, &uncut.height, &uncut.whole_width, &uncut.whole_height, &travel.top_rise,
                    &travel.bottom_drop})
    *l *= scale;
}

// How far, in S, its edges have gone because it came nearer or went away: the centre of an object that walks straight
// towards the camera stays where it is. Both extents must agree: a place that is uncovered, and an object that appears
// part by part, grow along one axis.
double TrackHypothesis::approach() const {
  const double wider = w.value - travel.log_width, taller = h.value - travel.log_height;
  if (wider * taller <= 0) return 0;
  return 0.5 * (1 - std::exp(-std::min(std::abs(wider), std::abs(taller))));
}

// How far, in S, its lower end has gone down, or its upper end up, while the other end stayed. A person who stood there
// when the scene began is part of the background model: where he walks straight up or down the picture, his place is
// foreground for as long as he covers a part of it. Before a moving camera ends move for other reasons.
double TrackHypothesis::stretch() const {
  return height() > parameters->upright * width() ? std::abs(travel.bottom_drop - travel.top_rise) / size()
                                                  : 0;
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
  if (std::hypot(q.x - p.x, q.y - p.y) > parameters->grain * frame.width)
    travel.top_rise = travel.bottom_drop = 0;
  const Point velocity = turned({x.velocity, y.velocity});
  x.position = q.x + kHalfPixel;
  y.position = q.y + kHalfPixel;
  x.velocity = velocity.x;
  y.velocity = velocity.y;
  uncut.velocity = turned(uncut.velocity);
  magnify(std::sqrt(det));
  for (Point* place : {&travel.origin, &fit.misfit_from}) *place = motion.apply(*place);
  return true;
}

// Where an off-screen track is looked for. One that walked out may have come nearer since: it is just outside the picture,
// on its side, however far the camera has turned from there.
Direction TrackHypothesis::expected(const Direction& kept, const CameraOrientation& camera) const {
  if (!walked_out()) return kept;
  const Size frame = camera.lens.frame();
  const double middle = frame.height / 2.0;
  const auto aside = [&](double bearing) { return sensing::wrap(bearing - camera.pan); };
  const double left = aside(camera.direction({-width() / 2, middle}).bearing);
  const double right = aside(camera.direction({frame.width + width() / 2, middle}).bearing);
  return {camera.pan + std::clamp(aside(kept.bearing), left, right), kept.elevation};
}

void TrackHypothesis::predict_off_screen(double seconds, const CameraOrientation& camera) {
  OffScreen& data = std::get<OffScreen>(life);
  const Point before{x.position, y.position};
  predict(seconds);
  const double pixels = camera.lens.focal_length() * data.magnification;  // a radian, about there
  data.direction.bearing = sensing::wrap(data.direction.bearing + (x.position - before.x) / pixels);
  data.direction.elevation -= (y.position - before.y) / pixels;
  const Direction direction = expected(data.direction, camera);
  const auto seen = camera.project(direction);
  data.in_front = seen.has_value();
  x.position = seen ? seen->x : before.x;
  y.position = seen ? seen->y : before.y;
  travel.origin.x += x.position - before.x;
  travel.origin.y += y.position - before.y;
  const double now = camera.magnification(direction), scale = now / data.magnification;
  data.magnification = now;
  for (double* v : {&x.velocity, &y.velocity, &uncut.velocity.x, &uncut.velocity.y}) *v *= scale;
  magnify(scale);
}

bool TrackHypothesis::expected_in(Size frame) const {
  const Box b = box();
  return std::get<OffScreen>(life).in_front && b.x > 0 && b.y > 0 && b.right() < frame.width &&
         b.bottom() < frame.height;
}

void TrackHypothesis::restore_whole() {
  if (uncut.leaving) {
    const bool known = uncut.whole_width > 0;
    w.value = std::log(known ? uncut.whole_width : uncut.width);
    h.value = std::log(known ? uncut.whole_height : uncut.height);
  }
  for (MovingValue* a : {&x, &y}) {
    a->vv = std::min(a->vv, square(parameters->stand_speed * size()));
    a->pv = 0;
  }
}

void TrackHypothesis::note_whole() {
  uncut.whole_width = width();
  uncut.whole_height = height();
}

double TrackHypothesis::distance(const Box& seen, Size frame) const {
  const TrackParameters& q = *parameters;
  const bool returns = is(TrackPhase::off_screen);
  const Box b = returns ? visible(frame) : box();
  const double s = size();
  const Residual rx = compare_extents(b.x, b.right(), seen.x, seen.right(), q);
  const Residual ry = compare_extents(b.y, b.bottom(), seen.y, seen.bottom(), q);
  const double noise = square(q.gate_noise * s);
  const double d2 = square(rx.distance) / (x.pp + noise) + square(ry.distance) / (y.pp + noise);
  const bool fragment = !returns && seen.area() < q.fragment * b.area();
  const double gate = fragment ? q.fragment_gate : q.gate;
  if (d2 > square(gate)) return -1;
  const double sizes = std::abs(std::log(seen.width / b.width)) + std::abs(std::log(seen.height / b.height));
  const Point c = centre(seen);
  // Rounding makes the overlap of equal boxes more than 1.
  return std::max(0.0, 1 - intersection_over_union(b, seen)) + q.size_cost * sizes +
         std::hypot(c.x - b.x - b.width / 2, c.y - b.y - b.height / 2) / s + q.gate_cost * std::sqrt(d2);
}

void TrackHypothesis::miss(double seconds) {
  const double brake = std::exp(-seconds / parameters->brake);
  unseen += seconds;
  in_group = 0;
  x.velocity *= brake;
  y.velocity *= brake;
}

bool TrackHypothesis::stays() const {
  return (stands() || slow >= parameters->settled) && there;
}

bool TrackHypothesis::has_appearance() const {
  return appearance.frames >= parameters->appearance_frames;
}

void TrackHypothesis::remember(const AppearanceModel& seen, double seconds, bool isolated) {
  const TrackParameters& q = *parameters;
  Appearance& a = appearance;
  if (a.frames > 0) a.change = std::max(0.0, appearance_distance(a.model, seen));
  if (!isolated) return;
  if (++a.frames == 1)
    a.model = seen;
  else
    a.model.learn(seen, std::max(1.0 / a.frames, 1 - std::exp(-seconds / q.appearance_time)));
  a.learnt += seconds;
}

bool went_apart(const TrackHypothesis& a, const TrackHypothesis& b) {
  const double both = std::min(a.age, b.age);
  if (!(both > 0)) return false;
  const double x = (a.x.position - a.travel.origin.x) / a.age - (b.x.position - b.travel.origin.x) / b.age;
  const double y = (a.y.position - a.travel.origin.y) / a.age - (b.y.position - b.travel.origin.y) / b.age;
  return std::hypot(x, y) * both > a.parameters->apart * std::max(a.size(), b.size());
}

bool look_different(const TrackHypothesis& a, const TrackHypothesis& b) {
  return a.has_appearance() && b.has_appearance() &&
         appearance_distance(a.appearance.model, b.appearance.model) > a.parameters->different;
}

}  // namespace cerberus::vision
