// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/complete.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::fusion {

namespace {

using sensing::Arc;
using sensing::Arcs;
using sensing::wrap;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kSame = 1e-9;  // rad

// A place with the values that decide its rank.
struct Candidate {
  Place place;
  bool reachable = true;
  double distance = 0;
  int order = 0;

  bool before(const Candidate& other) const {
    if (reachable != other.reachable) return reachable;
    if (std::abs(distance - other.distance) > kSame) return distance < other.distance;
    return order > other.order;
  }
};

// Clockwise angle from one direction to another, [0, 2 pi).
double clockwise(double from, double to) {
  const double angle = wrap(to - from);
  return angle < 0 ? angle + kTurn : angle;
}

// Returns the stop nearest to an arc that no pan angle within the limits reaches.
double nearest_stop(const Arc& arc, const Interval& limits, double pan) {
  const double to_right = clockwise(limits.to, arc.from);
  const double to_left = clockwise(arc.from + arc.width, limits.from);
  if (std::abs(to_right - to_left) > kSame) return to_right < to_left ? limits.to : limits.from;
  return std::abs(pan - limits.to) < std::abs(pan - limits.from) ? limits.to : limits.from;
}

// Finds the places of an arc for a head at `pan`: the arc's positions on the pan axis (it repeats every turn; positions
// more than a turn away add nothing), cut to the limits. Calls take(place, whether it is reachable).
template <typename Take>
void for_each_place(const Arc& arc, SensorBits sensors, double pan, double lens, const Interval& limits,
                    Take&& take) {
  if (arc.width >= kTurn - kSame) {  // all around: no edges but the stops
    const double most = std::min(limits.width(), kTurn);
    const double left = std::clamp(pan - most / 2, limits.from, limits.to - most);
    const Interval around{left, left + most};
    take(Place{around, around, sensors, limits.width() < kTurn - lens - kSame}, true);
    return;
  }
  const double inset = lens / 2;
  const double first = arc.from + kTurn * (std::floor((pan - arc.from) / kTurn) - 1);
  bool reached = false;
  for (int turn = 0; turn < 4; ++turn) {
    const Interval whole{first + turn * kTurn, first + turn * kTurn + arc.width};
    if (whole.from > limits.to + kSame || whole.to < limits.from - kSame) continue;
    const Interval wanted{std::clamp(whole.from, limits.from, limits.to),
                          std::clamp(whole.to, limits.from, limits.to)};
    reached = true;
    Interval pulled_in{whole.from + inset, whole.to - inset};
    if (arc.width <= lens) pulled_in.from = pulled_in.to = whole.middle();
    const Interval sweep{std::clamp(pulled_in.from, wanted.from, wanted.to),
                         std::clamp(pulled_in.to, wanted.from, wanted.to)};
    const bool limited = sweep.from > pulled_in.from + kSame || sweep.to < pulled_in.to - kSame;
    take(Place{wanted, sweep, sensors, limited}, true);
  }
  if (reached) return;
  const double stop = nearest_stop(arc, limits, pan);
  take(Place{{stop, stop}, {stop, stop}, sensors, true}, false);
}

}  // namespace

Places places(const Geometry& geometry, SensorBits fired, double pan,
              const std::array<int, kMaxSensors>& order, double lens, const Interval& limits) {
  fired &= static_cast<SensorBits>((1U << geometry.count()) - 1);
  pan =
      std::isfinite(pan) ? std::clamp(pan, limits.from, limits.to) : std::clamp(0.0, limits.from, limits.to);
  sensing::FixedList<Candidate, kMaxPlaces> found;
  Places result;
  const auto flush = [&] {  // nearest first; found in order of sensor number, which a stable sort would keep
    for (int i = 0; i < found.count; ++i) {
      int best = i;
      for (int j = i + 1; j < found.count; ++j)
        if (found[j].before(found[best])) best = j;
      std::rotate(found.begin() + i, found.begin() + best, found.begin() + best + 1);
      result.push(found[i].place);
    }
    found.count = 0;
  };
  const auto add = [&](const Arc& arc, SensorBits sensors, int rank) {
    for_each_place(arc, sensors, pan, lens, limits, [&](const Place& place, bool reachable) {
      found.push({place, reachable, place.wanted.distance(pan), rank});
    });
  };

  for (const Arc& arc : overlap(geometry, fired)) add(arc, fired, 0);
  flush();
  if ((fired & (fired - 1)) == 0 && result.count > 0)
    return result;  // one sensor: its sector is the only place
  for (int i = 0; i < geometry.count(); ++i)
    if (fired >> i & 1)
      add(geometry.sector(i), static_cast<SensorBits>(1U << i), order[static_cast<unsigned>(i)]);
  flush();
  return result;
}

Action approach(const Place& place, double pan, bool inside, double hysteresis) {
  const Interval& wanted = place.wanted;
  const double away = wanted.distance(pan);
  // A motor does not stop exactly on a point: a narrow place is widened by the hysteresis.
  const double enter = wanted.width() < 2 * hysteresis ? hysteresis : kSame;
  if (!(away > (inside ? enter + hysteresis : enter))) return Action::search;  // also where pan is not known
  return pan < wanted.from ? Action::turn_right : Action::turn_left;
}

}  // namespace cerberus::fusion
