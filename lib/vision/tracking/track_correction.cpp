// SPDX-License-Identifier: LGPL-2.1-or-later
// What a region says of the object that it was matched with: its place, its extent, how far it has gone.
#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {
void TrackHypothesis::correct(const Region& region, bool alone, double seconds, Size frame,
                              const std::optional<Point>& found) {
  const Box& seen = region.box;
  const Comparison how = compare(seen, alone && region.kind != RegionKind::group, frame);
  const double before = size();
  uncut.leaving = (how.cut_x && seen.width < uncut.width) || (how.cut_y && seen.height < uncut.height);
  if (!how.fits && alone && outgrown(region, how.cut(), seconds)) {
    replace_extent(seen, how.cut());
  } else if (found) {
    move_to(*found, seconds);
  } else {
    move_by(how, seconds, frame);
    if (alone && how.fits) refine_extent(seen, how, seconds, frame);
  }
  if (alone) last = seen;
  take_kind(region.kind, alone, how.fits, seconds);
  if (!alone && !match.occluded && !how.stays) shrink_into(seen);
  if (!how.cut()) uncut.velocity = {x.velocity, y.velocity};
  if (!how.at_edge && alone && fit.misfit == 0) note_whole();
  uncut.width = std::max(uncut.width, width());
  uncut.height = std::max(uncut.height, height());
  note_seen(region.confidence, before, seconds);
}

// A group's kind is taken where the track's box is the group's and its regions have been groups for some time: bodies that
// fail to explain one person, and a blob that touches another for some frames, look like a group, too. That time is shorter
// for a thing that was not a person a moment ago. Within a larger group it cannot be told, after that time, where the object
// is.
void TrackHypothesis::take_kind(RegionKind seen, bool alone, bool fits, double seconds) {
  const bool group = seen == RegionKind::group;
  in_group = group ? in_group + seconds : 0;
  since_person = alone && seen == RegionKind::person_like ? 0 : since_person + seconds;
  if (alone && !group) kind = seen;
  const bool thing = kind == RegionKind::thing && since_person >= parameters->settled;
  const double least = thing ? parameters->thing_group : parameters->settled;
  const bool own = (alone || fits) && in_group >= least;
  const bool within = !alone && shared.time + seconds >= least;
  if (group && (own || within)) kind = seen;
}

TrackHypothesis::Comparison TrackHypothesis::compare(const Box& seen, bool alone, Size frame) const {
  const Box b = box();
  Comparison c;
  c.x = compare_extents(b.x, b.right(), seen.x, seen.right(), *parameters);
  c.y = compare_extents(b.y, b.bottom(), seen.y, seen.bottom(), *parameters);
  // A track of its own region follows a walker's width through the stride.
  if (alone && c.y.same_extent && seen.width > b.width &&
      seen.width < parameters->stride * std::min(seen.height, b.height))
    c.x = {centre(seen).x - centre(b).x, true};
  c.fits = c.x.same_extent && c.y.same_extent;
  c.within_x = seen.x >= b.x && seen.right() <= b.right();
  c.within_y = seen.y >= b.y && seen.bottom() <= b.bottom();
  // Where the edge cuts a region off it changes because the object comes or goes, unless the object is seen to stand
  // there and only its moving part became smaller.
  c.stays = stays();
  const bool at_side = is_cut(seen.x, seen.right(), uncut.width, frame.width);
  const bool at_end = is_cut(seen.y, seen.bottom(), uncut.height, frame.height);
  c.at_edge = at_side || at_end;
  if (!c.stays) {
    c.cut_x = at_side;
    c.cut_y = at_end;
    return c;
  }
  const bool fragment = !c.fits && seen.area() < b.area();
  if (c.within_x || fragment) c.x.distance = 0;
  if (c.within_y || fragment) c.y.distance = 0;
  return c;
}

// Does the picture's edge cut a region off? Not the ends of an object that fills the picture from side to side.
bool TrackHypothesis::is_cut(double from, double to, double largest, int side) const {
  const double margin = parameters->cut_margin * side;
  return (from < margin || to > side - margin) && largest < side;
}

// One object, one region, extents that disagree: does the region's extent replace the track's?
//   cut by the picture's edge: yes, the object comes or goes.
//   person-like: at once if the track's box was that of a group or of an unknown object, else when it lasts.
//   larger: when it lasts. Only a part was seen before, or the object runs off and its region stretches from the place
//     where it stood, which stays foreground until the background model has learnt it.
//   smaller: a fragment (an arm) of a standing object, as long as it stays in place. When it lasts if the object moved, if
//     its extent was never well known, or if the fragment walks away on its own.
bool TrackHypothesis::outgrown(const Region& region, bool cut, double seconds) {
  const TrackParameters& q = *parameters;
  const Box& seen = region.box;
  if (fit.misfit == 0) {
    fit.misfit_from = centre(seen);
    fit.was_still = slow > 0 || stands();
  }
  fit.misfit += seconds;
  if (cut || match.reshaped) return true;
  if (is_person_like(region)) return kind != RegionKind::person_like || fit.misfit >= q.lasts;
  if (seen.area() > box().area()) return fit.misfit >= q.lasts;
  // While the camera moves a smaller region is believed in its second frame.
  if (camera_moved ? fit.misfit <= seconds : fit.misfit < q.lasts) return false;
  const double gone = std::hypot(centre(seen).x - fit.misfit_from.x, centre(seen).y - fit.misfit_from.y);
  return !fit.was_still || fit.time < q.extent_known || gone > q.travelled * size();
}

void TrackHypothesis::adopt(const Box& seen) {
  w = {std::log(seen.width), square(parameters->size_noise)};
  h = {std::log(seen.height), square(parameters->size_noise)};
  travel.log_width = w.value;
  travel.log_height = h.value;
  travel.top_rise = travel.bottom_drop = 0;
  x.position = centre(seen).x;
  y.position = centre(seen).y;
  fit.misfit = fit.time = 0;
  last = seen;
}

// Another extent is no distance travelled, unless the object came in meanwhile: what it has travelled, in S, stays.
void TrackHypothesis::replace_extent(const Box& seen, bool cut) {
  const double before = size();
  const Point was{x.position, y.position};
  adopt(seen);
  if (!is(TrackPhase::tentative) || cut) return;
  travel.origin = {x.position - (was.x - travel.origin.x) * size() / before,
                   y.position - (was.y - travel.origin.y) * size() / before};
}

// To the place in a group where the object was found by its appearance, which determines height poorly.
void TrackHypothesis::move_to(const Point& found, double seconds) {
  const double variance = square(parameters->found_noise * size());
  x.correct(found.x, variance);
  y.correct(found.y, variance);
  y.velocity *= std::exp(-seconds / parameters->brake);
}

// By the residual. A smaller region within the expected box is no distance travelled of a tentative track.
void TrackHypothesis::move_by(const Comparison& how, double seconds, Size frame) {
  const TrackParameters& q = *parameters;
  const double noise = square(q.position_noise * size()) + square(q.grain * frame.width);
  const double variance = how.fits && !match.occluded ? noise : q.blob_noise * noise;
  const Point was{x.position, y.position};
  if (match.leapt) {
    x.doubt_velocity(how.x.distance / seconds, seconds);
    y.doubt_velocity(how.y.distance / seconds, seconds);
  }
  x.correct(how.x.distance, variance);
  y.correct(how.y.distance, variance);
  if (!is(TrackPhase::tentative)) return;
  if (how.within_x) travel.origin.x += x.position - was.x;
  if (how.within_y) travel.origin.y += y.position - was.y;
}

// A region of the track's own extent, which no other track has.
void TrackHypothesis::refine_extent(const Box& seen, const Comparison& how, double seconds, Size frame) {
  if (is(TrackPhase::tentative)) follow_ends(seen, seconds + unseen, frame);
  if (!(how.stays && how.within_x)) resize(w, seen.width, how.cut_x, seconds);
  if (!(how.stays && how.within_y)) resize(h, seen.height, how.cut_y, seconds);
  fit.misfit = 0;
  fit.time += seconds;
  fit.longest = std::max(fit.longest, fit.time);
}

// A person who stands dissolves from the mask piece by piece without getting smaller; an object that the picture's edge
// cuts shows more or less of itself with every frame.
void TrackHypothesis::resize(SlowValue& extent, double seen, bool is_cut, double seconds) {
  const TrackParameters& q = *parameters;
  const double measured = std::log(seen);
  const bool fades = !is_cut && speed() < q.stand_speed * size() && measured < extent.value;
  if (is_cut) extent.variance += q.border_wander * seconds;
  extent.correct(measured, square(q.size_noise) * (fades ? q.fade : 1));
}

// An end that goes on steadily is a walker's. One that jumps reveals more of the object.
void TrackHypothesis::follow_ends(const Box& seen, double seconds, Size frame) {
  const double most = parameters->end_speed * size() * seconds + parameters->grain * frame.width;
  const auto follow = [most](double& gone, double step) {
    gone = step > most ? 0 : std::max(0.0, gone + step);
  };
  follow(travel.top_rise, last.y - seen.y);
  follow(travel.bottom_drop, seen.bottom() - last.bottom());
}

// A track is not larger than a region that it shares, if the region holds all of the object.
void TrackHypothesis::shrink_into(const Box& region) {
  if (region.width < width()) w.value = std::log(region.width);
  if (region.height < height()) h.value = std::log(region.height);
}

// size_before: S before the correction, frame pixels.
void TrackHypothesis::note_seen(double seen_confidence, double size_before, double seconds) {
  const TrackParameters& q = *parameters;
  unseen = 0;
  const double keep = std::exp(-seconds / q.extent_known);
  confidence = keep * confidence + (1 - keep) * (0.5 + 0.5 * seen_confidence);
  const double gone = std::hypot(x.position - travel.origin.x, y.position - travel.origin.y) / size_before;
  travel.most = std::max({travel.most, gone, approach(), stretch()});
  slow = speed() < q.stand_speed * size_before ? slow + seconds : 0;
  if (auto* data = std::get_if<Tentative>(&life))
    ++data->hits;
  else
    top_speed = std::max(top_speed, speed());
}

}  // namespace cerberus::vision
