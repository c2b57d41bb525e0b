// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/search/doubt_search.h"

#include <algorithm>
#include <cmath>

namespace cerberus::fusion {

namespace {

// The part of a place. Its sweep is moved in by half a picture where it does not end with the place's own.
Place part_of(Place place, const Interval& part, double lens) {
  const double inset = std::min(lens, part.width()) / 2;
  Interval sweep{part.from + inset, part.to - inset};
  if (part.from == place.wanted.from) sweep.from = std::clamp(place.sweep.from, part.from, part.to);
  if (part.to == place.wanted.to) sweep.to = std::clamp(place.sweep.to, part.from, part.to);
  if (sweep.from > sweep.to) sweep.from = sweep.to = part.middle();
  place.wanted = part;
  place.sweep = sweep;
  return place;
}

}  // namespace

bool DoubtSearch::is_over(SensorBits doubtful) const {
  if ((place_->sensors & doubtful) == 0) return true;
  return inside_ && around_.unseen(place_->wanted, parameters_.ends).age < parameters_.ends;
}

// The unseen part of the sector that was seen least; of equal ones the nearest.
void DoubtSearch::choose(const Geometry& geometry, SensorBits doubtful, const View& view) {
  place_.reset();
  inside_ = false;
  Time oldest = parameters_.begins;
  for (int sensor = 0; sensor < geometry.count(); ++sensor) {
    const auto bit = static_cast<SensorBits>(1U << sensor);
    if (!(doubtful & bit)) continue;
    for (const Place& place : places(geometry, bit, view.pan, {}, view.lens, view.limits)) {
      const SeenAround::Unseen unseen = around_.unseen(place.wanted, parameters_.ends);
      if (unseen.part.from > unseen.part.to) continue;
      const bool nearer = place_ && unseen.part.distance(view.pan) < place_->wanted.distance(view.pan);
      if (unseen.age < oldest || (unseen.age == oldest && place_ && !nearer)) continue;
      oldest = unseen.age;
      place_ = part_of(place, unseen.part, view.lens);
    }
  }
}

std::optional<DoubtSearch::Look> DoubtSearch::look(const Geometry& geometry, SensorBits doubtful,
                                                   const View& view) {
  if (!std::isfinite(view.pan)) return std::nullopt;
  if (!place_ || is_over(doubtful)) choose(geometry, doubtful, view);
  if (!place_) return std::nullopt;
  const double pan = std::clamp(view.pan, view.limits.from, view.limits.to);
  const Action action = approach(*place_, pan, inside_, view.hysteresis);
  inside_ = action == Action::search;
  return Look{action, *place_};
}

}  // namespace cerberus::fusion
