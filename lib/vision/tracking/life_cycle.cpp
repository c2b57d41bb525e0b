// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/life_cycle.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

void LifeCycle::confirm(TrackHypothesis& t, std::uint32_t id) {
  t.life = Confirmed{};
  t.id = id;
  t.top_speed = t.speed();
}

void LifeCycle::coast(TrackHypothesis& t) {
  t.life = Coasted{};
}

void LifeCycle::stop(TrackHypothesis& t) {
  t.life = Stopped{};
  t.x.velocity = t.y.velocity = 0;
}

void LifeCycle::see(TrackHypothesis& t) {
  t.life = Confirmed{};
}

void LifeCycle::leave(TrackHypothesis& t, const CameraOrientation& camera) {
  const bool stopped = t.is(TrackPhase::stopped), still = stopped || t.slow > 0;
  // The velocity of the part at the picture's edge is not used: its centre lags behind the object's.
  t.x.velocity = still ? 0 : t.uncut.velocity.x;
  t.y.velocity = still ? 0 : t.uncut.velocity.y;
  t.restore_whole();
  t.fit.misfit = 0;
  const Direction direction = camera.direction({t.x.position, t.y.position});
  t.life = OffScreen{direction, camera.magnification(direction), true, stopped, 0};
}

// However slow the part at the picture's edge was, the object is outside by now.
void LifeCycle::walk_out(TrackHypothesis& t, const CameraOrientation& camera) {
  const Box part = t.box();
  const double end = camera.lens.frame().width, margin = t.parameters->border * t.size();
  const bool left = part.x < margin;
  const bool right = end - part.right() < margin;
  leave(t, camera);
  if (left && !right) t.x.position = std::min(t.x.position, -t.width() / 2);
  if (right && !left) t.x.position = std::max(t.x.position, end + t.width() / 2);
  t.x.velocity = t.y.velocity = 0;
  OffScreen& data = std::get<OffScreen>(t.life);
  data.direction = camera.direction({t.x.position, t.y.position});
  data.magnification = camera.magnification(data.direction);
  data.stopped = false;
  data.walked_out = true;
}

// The extent before was a guess where the picture's edge had cut it, and may have been a group's.
void LifeCycle::come_back(TrackHypothesis& t, const Box& seen) {
  if (std::get<OffScreen>(t.life).stopped)
    t.life = Stopped{};
  else
    t.life = Coasted{};
  t.note_whole();
  t.adopt(seen);
}

void LifeCycle::resume_stop(TrackHypothesis& t) {
  t.life = Stopped{std::get<OffScreen>(t.life).absent};
  t.note_whole();
}

void LifeCycle::lose(TrackHypothesis& t) {
  t.life = Lost{};
}

void LifeCycle::advance(std::span<TrackHypothesis> tracks, const Frame& frame, const TrackOptions& options) {
  tracks_ = tracks;
  frame_ = frame;
  options_ = options;
  for (TrackHypothesis& t : tracks) {
    if (t.match.region >= 0) {
      if (t.is(TrackPhase::tentative) && is_confirmed(t)) confirm(t, ++last_id_);
      continue;
    }
    if (t.is(TrackPhase::confirmed)) coast(t);
    t.miss(frame.seconds);
    switch (t.phase()) {
      case TrackPhase::tentative:
        advance_tentative(t);
        break;
      case TrackPhase::coasted:
        advance_coasted(t);
        break;
      case TrackPhase::stopped:
        advance_stopped(t);
        break;
      case TrackPhase::off_screen:
        advance_off_screen(t);
        break;
      case TrackPhase::confirmed:
      case TrackPhase::lost:
        break;
    }
  }
  tracks_ = {};
}

bool LifeCycle::is_confirmed(const TrackHypothesis& t) const {
  const Parameters& q = parameters_;
  const Tentative& data = std::get<Tentative>(t.life);
  if (options_.confirm_time <= 0) return true;
  const bool enough =
      data.hits >= q.least_hits || (data.hits > 1 && t.age >= q.least_hits * options_.confirm_time);
  return enough && t.travel.most >= q.least_travel && t.age >= q.confirm_slack * options_.confirm_time &&
         data.hits >= q.hit_share * data.frames;
}

// Lost when it has been without region for a while, and mostly was.
void LifeCycle::advance_tentative(TrackHypothesis& t) {
  const Parameters& q = parameters_;
  const Tentative& data = std::get<Tentative>(t.life);
  if (t.unseen > q.hit_share * options_.confirm_time && data.hits < q.hit_share * data.frames) lose(t);
}

// Stops, or departs when it has been coasted for too long or its centre has left the picture.
void LifeCycle::advance_coasted(TrackHypothesis& t) {
  if (has_stopped(t)) {
    stop(t);
    advance_stopped(t);
    return;
  }
  fade(t, options_.coast_time);
  const double longest = t.at_border(frame_.size) ? parameters_.coast_share * coast_time(t) : coast_time(t);
  if (outside(t) || t.unseen > longest) depart(t);
}

// Departs after hold-stopped; sooner from a place that looks for a while as before the object came, and is not covered.
void LifeCycle::advance_stopped(TrackHypothesis& t) {
  fade(t, options_.hold_stopped);
  double& absent = std::get<Stopped>(t.life).absent;
  absent = t.left && !covered(t) ? absent + frame_.seconds : 0;
  if (outside(t) || t.unseen > options_.hold_stopped || absent > parameters_.coast_share * coast_time(t))
    depart(t);
}

// A stopped track whose place is in view again is a stopped one again. Lost when it has been away for too long, or is
// not where it is expected.
void LifeCycle::advance_off_screen(TrackHypothesis& t) {
  OffScreen& data = std::get<OffScreen>(t.life);
  if (t.expected_in(frame_.size)) data.absent += frame_.seconds;
  const double longest = data.stopped || data.walked_out ? options_.hold_stopped : options_.away_time;
  if (t.unseen > longest || data.absent > options_.coast_time)
    lose(t);
  else if (data.stopped && data.absent > 0)
    resume_stop(t);
}

// Goes off-screen where the camera has turned away from a well-known object, or where that has walked out of the picture of
// a head, else it is lost.
void LifeCycle::depart(TrackHypothesis& t) {
  const bool known = t.fit.longest >= t.parameters->extent_known && t.travel.most >= t.parameters->travelled;
  const bool at_edge = outside(t) || t.at_border(frame_.size);
  if (!known || !at_edge || t.unseen >= options_.away_time)
    lose(t);
  else if (frame_.turning)
    leave(t, frame_.camera);
  else if (frame_.head)
    walk_out(t, frame_.camera);
  else
    lose(t);
}

// Has the object ceased to move, rather than left or gone behind another one? It was well seen before, slower and
// slower until nothing moved any more, uncovered, and is not a remnant of itself; its place must not look as before the
// object came.
bool LifeCycle::has_stopped(const TrackHypothesis& t) const {
  const Parameters& q = parameters_;
  const TrackParameters& of = *t.parameters;
  if (t.slow < of.lasts || t.fit.time < of.extent_known || t.travel.most < of.travelled ||
      t.seen_for() < q.seen || t.uncut.leaving)
    return false;
  const bool remnant = t.box().area() < of.fragment * t.uncut.width * t.uncut.height;
  return !remnant && !t.left && !covered(t);
}

// Does another track, one with a region, lie in front of it?
bool LifeCycle::covered(const TrackHypothesis& t) const {
  const Box box = t.box();
  return std::ranges::any_of(tracks_, [&](const TrackHypothesis& o) {
    return &o != &t && o.id != 0 && o.match.region >= 0 &&
           overlap_area(o.box(), box) > t.parameters->covered * box.area();
  });
}

bool LifeCycle::outside(const TrackHypothesis& t) const {
  return t.x.position < 0 || t.y.position < 0 || t.x.position > frame_.size.width ||
         t.y.position > frame_.size.height;
}

// Does the picture's left or right edge leave so little of it that most is outside? What is too low for a person there is
// a piece of one. Before a camera that turns it may be coming in.
bool LifeCycle::is_sliver(const TrackHypothesis& t) const {
  const Box box = t.box();
  const double margin = t.parameters->cut_margin * frame_.size.width;
  const bool at_edge = box.x < margin || box.right() > frame_.size.width - margin;
  return !frame_.turning && at_edge &&
         (t.kind == RegionKind::part ||
          box.width < t.parameters->fragment * std::max(t.uncut.height, box.height));
}

double LifeCycle::coast_time(const TrackHypothesis& t) const {
  return std::min(options_.coast_time, parameters_.coast_share * t.seen_for());
}

// The confidence of a track without region falls. time: time constant in s, may be 0.
void LifeCycle::fade(TrackHypothesis& t, double time) const {
  constexpr double kLeastTime = 1e-3;
  t.confidence *= std::exp(-frame_.seconds / std::max(time, kLeastTime));
}

std::optional<TrackState> LifeCycle::published(const TrackHypothesis& t) const {
  const Parameters& q = parameters_;
  if (t.match.occluded && t.shared.unlocated > t.parameters->lasts) return {};
  if (is_sliver(t)) return {};
  if (t.is(TrackPhase::confirmed)) return TrackState::seen;
  if (!t.in_view()) return {};
  if (t.is(TrackPhase::stopped)) return TrackState::stopped;
  // A coasted track: while its position is certain; away from the picture's edge, where it probably has left; if it was
  // seen for long enough not to be noise; and if it is not a piece of a person, who may have left it behind.
  if (t.kind == RegionKind::part || std::sqrt(t.x.pp) > q.certain * t.width() || t.at_border(frame_.size))
    return {};
  return TrackState::coasted;
}

}  // namespace cerberus::vision
