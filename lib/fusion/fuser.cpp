// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/fuser.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "fusion/follower.h"
#include "fusion/search/doubt_search.h"
#include "sensing/own_motion.h"

namespace cerberus::fusion {

using sensing::Arc;
using sensing::PulseDoubt;

namespace {

// Tolerance at the edges of a sweep: heads stop a little before them (dead band, steps).
constexpr double kEdge = sensing::radians(2);
// The field of a sensor of whose direction nothing is known.
constexpr Arc kAround{-std::numbers::pi, 2 * std::numbers::pi};

SensorBits bit(int sensor) {
  return static_cast<SensorBits>(1U << sensor);
}

// Returns whether two values are equal; two unknown ones (NaN) are.
bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

FuserOptions sane(FuserOptions options) {
  const auto least = [](auto& value, auto limit) { value = value > limit ? value : limit; };  // NaN too
  least(options.camera_hold, Time::zero());
  least(options.return_delay, Time::zero());
  least(options.hold_stopped, Time::zero());
  least(options.dwell, Time::zero());
  least(options.hysteresis, 0.0);
  options.lens = options.lens >= 0 && options.lens < std::numbers::pi ? options.lens : 0;
  const Interval& limits = options.limits;
  if (!std::isfinite(limits.from) || !std::isfinite(limits.to) || limits.from > limits.to)
    options.limits = kDefaultLimits;
  return options;
}

}  // namespace

FuserOptions paper_options() {
  return {.rules = RuleSet::table,
          .camera_hold = Time::zero(),
          .return_delay = Time::zero(),
          .hold_stopped = Time::zero(),
          .hysteresis = 0};
}

struct Fuser::State {
  FuserOptions options = sane({});
  Geometry geometry;
  RuleTable table = paper_rules();

  // The state that reset() clears.
  struct Memory {
    bool begun = false;
    Time time{}, sensor_time = kLongAgo;

    Follower follower;  // the camera's part

    // Sensors.
    SensorBits fired = 0, invalid = 0, doubtful = 0;
    std::array<PulseDoubt, kMaxSensors> doubts;
    std::array<int, kMaxSensors> order{};  // the higher, the later it fired
    int fire_count = 0;
    Time detected{};  // last time camera or sensors found something; before that the first frame's

    // complete: the places to search, in their order when the sensors last changed.
    Places places;
    SensorBits asked = 0;   // the sensors that gave these places
    double lens = 0;        // in force
    bool outdated = false;  // lens or limits have changed since
    int place = 0;
    bool inside = false, seen_left = false, seen_right = false;
    Time arrived{};
    DoubtSearch search;

    // table: the band in force, for hysteresis.
    RuleTable::Match match;
    bool match_camera = false;
    SensorBits match_fired = 0;
  } memory;

  Decision decision;
  std::string old_name;  // name of the decision's rule after its table was replaced

  SensorBits read_sensors(const Input& input);
  double lens(const Input& input) const;
  bool cover_view(SensorBits sensors, const Input& input) const;
  Decision decide(const Input& input);
  Decision complete(const Input& input, Decision next);
  Decision by_table(const Input& input, Decision next);
  void look_at(int place);
  void forget_places();
  void watch_sweep(const Input& input);
};

// Returns the sensors that begin to detect.
SensorBits Fuser::State::read_sensors(const Input& input) {
  Memory& m = memory;
  const int known =
      std::clamp(options.rules == RuleSet::table ? table.sensors : geometry.count(), 0, kMaxSensors);
  const int count = static_cast<int>(std::min(input.sensors.size(), static_cast<std::size_t>(known)));
  SensorBits ones = 0;
  m.invalid = 0;
  for (int i = 0; i < count; ++i) {
    const std::uint8_t value = input.sensors[static_cast<unsigned>(i)];
    if (value == 1) ones |= bit(i);
    if (value > 1) m.invalid |= bit(i);
  }

  m.doubtful = 0;
  for (int i = 0; i < count; ++i) {
    const Arc field = i < geometry.count() ? geometry.sector(i) : kAround;
    const double passing = passing_rate(field, {input.base_yaw_rate, input.base_speed});
    PulseDoubt& doubt = m.doubts[static_cast<unsigned>(i)];
    doubt.update(input.sensor_time, (ones & bit(i)) != 0, passing > sensing::kDoubtfulTurn);
    if (doubt.doubtful()) m.doubtful |= bit(i);
  }

  const auto fired = static_cast<SensorBits>(ones & ~m.doubtful);
  const auto rising = static_cast<SensorBits>(fired & ~m.fired);
  if (rising != 0) ++m.fire_count;
  for (int i = 0; i < known; ++i)
    if (rising >> i & 1) m.order[static_cast<unsigned>(i)] = m.fire_count;
  m.fired = fired;
  return rising;
}

double Fuser::State::lens(const Input& input) const {
  return input.lens > 0 && input.lens < std::numbers::pi ? input.lens : options.lens;
}

// Whether one of the sensors covers a part of the picture. Of an unknown pan the camera looks ahead, an unknown lens sees all.
bool Fuser::State::cover_view(SensorBits sensors, const Input& input) const {
  const double view = lens(input), pan = std::isfinite(input.pan) ? input.pan : 0;
  if (view == 0) return sensors != 0;
  for (int i = 0; i < kMaxSensors; ++i) {
    if (!(sensors & bit(i))) continue;
    if (i >= geometry.count() ||
        std::abs(sensing::wrap(geometry.bearing(i) - pan)) < (geometry.field_of_view(i) + view) / 2)
      return true;
  }
  return false;
}

void Fuser::State::look_at(int place) {
  memory.place = place;
  memory.inside = memory.seen_left = memory.seen_right = false;
}

void Fuser::State::forget_places() {
  memory.places.count = 0;
  memory.asked = 0;
  memory.outdated = false;
}

// Selects the next place after the present one was swept from edge to edge without success. Without this, of two people
// in two sectors, or of a sector that the stops cut in two, only one half would ever be searched.
void Fuser::State::watch_sweep(const Input& input) {
  Memory& m = memory;
  const Interval& sweep = m.places[m.place].sweep;
  m.seen_left = m.seen_left || input.pan <= sweep.from + kEdge;
  m.seen_right = m.seen_right || input.pan >= sweep.to - kEdge;
  if (m.places.count < 2 || !m.seen_left || !m.seen_right || input.sensor_time - m.arrived < options.dwell)
    return;
  look_at((m.place + 1) % m.places.count);
}

Decision Fuser::State::complete(const Input& input, Decision next) {
  Memory& m = memory;
  const auto say = [&next](Action action, int rule, std::string_view name) {
    next.action = action;
    next.rule = rule;
    next.rule_name = name;
    return next;
  };
  const double lens = this->lens(input);
  m.search.see(input.sensor_time, input.pan, lens, input.base_yaw_rate);
  if (next.camera_found) {
    forget_places();
    m.search.forget();
    next.target = m.follower.target();
    return say(next.target != 0 ? Action::track : Action::hold, 1, "camera");
  }
  if (std::exchange(m.lens, lens) != lens && m.places.count > 0) m.outdated = true;
  if ((m.fired != 0 && m.fired != m.asked) || m.outdated) {
    const bool same_place = m.places.count > 0;
    const Place old = same_place ? m.places[m.place] : Place{};
    if (m.fired != 0) m.asked = m.fired;
    m.places = places(geometry, m.asked, input.pan, m.order, m.lens, options.limits);
    m.outdated = false;
    const Interval& wanted = m.places[0].wanted;
    if (!same_place || wanted.from != old.wanted.from || wanted.to != old.wanted.to)
      look_at(0);
    else
      m.place = 0;
  }
  if (m.fired == 0 && !within(options.return_delay, m.detected, input.sensor_time)) {
    forget_places();
    const DoubtSearch::View view{input.pan, m.lens, options.limits, options.hysteresis};
    if (const auto look = m.search.look(geometry, m.doubtful, view)) {
      next.sector = look->action == Action::search ? look->place.sweep : look->place.wanted;
      next.limited = look->place.limited;
      return say(look->action, 0, "doubt");
    }
    next.limited = !options.limits.holds(0);
    return say(Action::zero, 7, "zero");
  }
  m.search.forget();
  if (m.places.count == 0) return say(Action::hold, 0, "return");  // the camera lost its target a moment ago

  if (m.inside) watch_sweep(input);
  const Place& place = m.places[m.place];
  const double pan = std::clamp(input.pan, options.limits.from, options.limits.to);  // NaN stays NaN
  const Action action = approach(place, pan, m.inside, options.hysteresis);
  const bool inside = action == Action::search;
  if (inside && !m.inside) m.arrived = input.sensor_time;
  m.inside = inside;
  next.sector = inside ? place.sweep : place.wanted;
  next.limited = place.limited;
  const std::string_view why = m.fired == 0                         ? "return"
                               : std::has_single_bit(place.sensors) ? "sector"
                                                                    : "overlap";
  return say(action, 0, why);
}

Decision Fuser::State::by_table(const Input& input, Decision next) {
  Memory& m = memory;
  RuleTable::Match match = table.evaluate(next.camera_found, m.fired, input.pan);
  const bool same_case =
      m.match.rule != nullptr && m.match_camera == next.camera_found && m.match_fired == m.fired;
  if (same_case && match.band != m.match.band && options.hysteresis > 0) {
    for (const double away : {-options.hysteresis, options.hysteresis})
      if (table.evaluate(next.camera_found, m.fired, input.pan + away).band == m.match.band) {
        match = m.match;
        break;
      }
  }
  m.match = match;
  m.match_camera = next.camera_found;
  m.match_fired = m.fired;
  if (match.rule == nullptr) return next;  // hold: pan is unknown, or the table was not checked

  next.rule = match.rule->number;
  next.rule_name = match.rule->name;
  next.action = match.band->action;
  const Interval& limits = options.limits;
  switch (next.action) {
    case Action::track:
      next.target = m.follower.target();
      if (next.target == 0) next.action = Action::hold;  // "Camera Tracking" without a target is hold
      break;
    case Action::turn_left:
      next.limited = input.pan <= limits.from;
      break;
    case Action::turn_right:
      next.limited = input.pan >= limits.to;
      break;
    case Action::search: {
      const Interval& sweep = match.band->search;
      next.sector = {std::clamp(sweep.from, limits.from, limits.to),
                     std::clamp(sweep.to, limits.from, limits.to)};
      next.limited = sweep.from < limits.from || sweep.to > limits.to;
      break;
    }
    case Action::zero:
      next.limited = !limits.holds(0);
      if (within(options.return_delay, m.detected, input.sensor_time)) {
        next.action = Action::hold;
        next.rule = 0;
        next.rule_name = "return";
        next.limited = false;
      } else {
        next.immediate = true;
      }
      break;
    case Action::hold:
      next.immediate = true;
      break;
  }
  return next;
}

Decision Fuser::State::decide(const Input& input) {
  Memory& m = memory;
  const SensorBits onsets = read_sensors(input);
  m.follower.watch(input.tracks, input.time, options.choice, options.hold_stopped);

  Decision next;
  next.pan = input.pan;
  next.fired = m.fired;
  next.onset_in_view = cover_view(onsets, input);
  next.doubtful = m.doubtful;
  next.invalid = m.invalid;
  next.camera_found = m.follower.found(options.camera_hold, input.time);
  if (next.camera_found || m.fired != 0) m.detected = input.sensor_time;
  next = options.rules == RuleSet::table ? by_table(input, next) : complete(input, next);

  // A person who stopped is detected neither by the camera nor by the PIR sensors, but is still there: rule 7 waits.
  if (next.action == Action::zero && m.follower.stands(options.hold_stopped, input.time)) {
    next.action = Action::hold;
    next.rule = 0;
    next.rule_name = "stopped";
    next.limited = next.immediate = false;
  }
  return next;
}

Fuser::Fuser() : state_(std::make_unique<State>()) {}
Fuser::~Fuser() = default;
Fuser::Fuser(Fuser&&) noexcept = default;
Fuser& Fuser::operator=(Fuser&&) noexcept = default;

void Fuser::set_options(const FuserOptions& options) {
  const FuserOptions old = std::exchange(state_->options, sane(options));
  const FuserOptions& now = state_->options;
  if (now.rules != old.rules) state_->forget_places();
  // A search continues, with new places.
  if (now.lens == old.lens && now.limits == old.limits) return;
  if (state_->memory.places.count > 0) state_->memory.outdated = true;
  state_->memory.search.forget();
}

const FuserOptions& Fuser::options() const {
  return state_->options;
}

void Fuser::set_geometry(const Geometry& geometry) {
  if (geometry == state_->geometry) return;
  state_->geometry = geometry;
  state_->forget_places();
  state_->memory.search.forget();
}

void Fuser::set_table(RuleTable table) {
  if (table == state_->table) return;
  state_->memory.match = {};
  state_->old_name = state_->decision.rule_name;
  state_->decision.rule_name = state_->old_name;
  state_->table = std::move(table);
}

void Fuser::reset() {
  state_->memory = {};
  state_->decision = {};
}

const Decision& Fuser::update(const Input& input) {
  State& state = *state_;
  if (state.memory.begun && input.time < state.memory.time) reset();
  const bool first = !state.memory.begun;
  Input now = input;
  now.sensor_time = std::max({input.sensor_time, input.time, state.memory.sensor_time});
  if (first)
    state.memory.detected =
        now.sensor_time;  // a detection before the first frame is possible, so return_delay starts here
  state.memory.begun = true;
  state.memory.time = now.time;
  state.memory.sensor_time = now.sensor_time;

  const Decision next = state.decide(now);
  const Decision& old = state.decision;
  const bool changed = first || next.action != old.action || next.rule != old.rule ||
                       next.rule_name != old.rule_name || next.target != old.target ||
                       !same(next.sector.from, old.sector.from) || !same(next.sector.to, old.sector.to) ||
                       next.limited != old.limited || next.camera_found != old.camera_found ||
                       next.fired != old.fired || next.doubtful != old.doubtful ||
                       next.invalid != old.invalid || next.immediate != old.immediate;
  state.decision = next;
  state.decision.changed = changed;
  return state.decision;
}

}  // namespace cerberus::fusion
