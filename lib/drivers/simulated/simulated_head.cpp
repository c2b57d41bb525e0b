// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/simulated/simulated_head.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "text/numbers.h"

namespace cerberus::drivers {

namespace {

using motion::AxisCommand;
using motion::AxisLimits;
using motion::AxisState;
using motion::kNever;
using motion::Plan;

constexpr motion::Time kMostLatency = std::chrono::seconds(5);  // see kKept
constexpr double kZoomSpeed = 1. / 3;                           // of its range, a second
// While the zoom moves, a pose holds for so long.
constexpr motion::Time kZoomPiece = std::chrono::milliseconds(40);

// The hash function of splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
std::uint64_t scramble(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

// Converts to (0, 1].
double uniform(std::uint64_t x) {
  return (static_cast<double>(x >> 11) + 1) * 0x1p-53;
}

// Returns the camera's position after the motor moved monotonically to `motor`.
double dragged(double camera, double motor, double play) {
  return std::clamp(camera, motor - play, motor + play);
}

// Returns the measured position, which is never beyond a stop unless the head is (the stops were moved).
double noisy(double position, double noise, const AxisLimits& limits) {
  return std::clamp(position + noise, std::min(limits.from, position), std::max(limits.to, position));
}

// Returns the time at which the motor, in a piece from `state`, first reaches `position`, seconds from now; infinite:
// not in this piece.
//   position - p = v t + a t^2 / 2
double arrival(const AxisState& state, double position) {
  const double way = position - state.position, v = state.speed, a = state.acceleration;
  constexpr double kNone = HUGE_VAL;
  if (a == 0) return v != 0 && way / v > 0 ? way / v : kNone;
  const double root = v * v + 2 * a * way;
  if (root < 0) return kNone;
  double first = kNone;
  for (const double t : {(-v - std::sqrt(root)) / a, (-v + std::sqrt(root)) / a})
    if (t > 0 && t < first) first = t;
  return first;
}

}  // namespace

std::string SimulatedHead::check(const HeadSetup& setup) const {
  if (std::string wrong = motion::check(setup.limits); !wrong.empty()) return wrong;
  for (const auto& [value, name] :
       {std::pair{setup.step, "step-size"}, {setup.backlash, "backlash"}, {setup.noise, "noise"}})
    if (!(value >= 0 && value < HUGE_VAL))
      return std::string(name) + " must be 0 or more, and is " +
             text::significant(sensing::degrees(value), 6).string() + " degrees";
  if (setup.latency < Time::zero() || setup.latency > kMostLatency)
    return "latency must be 0 to 5 s, and is " +
           text::significant(motion::seconds(setup.latency), 6).string() + " s";
  return motion::check_start(setup.limits, setup.pan, setup.tilt);
}

std::string SimulatedHead::open(const HeadSetup& setup) {
  if (std::string wrong = check(setup); !wrong.empty()) return wrong;
  setup_ = setup;
  commanded_ = placed_ = Time::zero();
  next_ = count_ = 1;
  chapters_[0] = {Time::min(), {Plan(setup.pan), setup.pan}, {Plan(setup.tilt), setup.tilt}, {}};
  return {};
}

void SimulatedHead::close() noexcept {
  count_ = 0;
}

void SimulatedHead::stop(Time now) noexcept {
  if (count_ > 0) obey({std::max(now, commanded_), {}, {}});
}

std::string SimulatedHead::command(const HeadCommand& command) {
  if (count_ == 0) return "the simulated head is not open";
  if (command.time < commanded_) return "a stale command: it was given before the last one";
  return obey(command);
}

// Returns the chapter at `time`, and in `end` the begin of the next one.
const SimulatedHead::Chapter& SimulatedHead::chapter_at(Time time, Time& end) const {
  end = kNever;
  unsigned n = 0;
  const auto nth = [this](unsigned k) -> const Chapter& {
    return chapters_[(next_ + kKept - 1 - k) % kKept];
  };
  while (n + 1 < count_ && nth(n).from > time) end = nth(n++).from;
  return nth(n);
}

SimulatedHead::Leg SimulatedHead::follow(const Leg& leg, Time from, const AxisCommand& command,
                                         const AxisLimits& limits) const {
  Time until;
  const double position = camera(leg, from, until).position;
  return {Plan::make(from, leg.plan.at(from), command, limits, setup_.step), position};
}

std::string SimulatedHead::obey(const HeadCommand& command) {
  commanded_ = command.time;
  const Chapter& last = nth_last(0);
  if (command.pan == last.command.pan && command.tilt == last.command.tilt && !command.zoom)
    return {};  // the command is already being executed
  HeadCommand next = command;
  next.time = std::max(next.time, placed_);
  return begin(next);
}

std::string SimulatedHead::limit(Time now, const motion::Limits& limits) {
  if (count_ == 0) return "the simulated head is not open";
  HeadCommand again = nth_last(0).command;
  commanded_ = std::max(commanded_, now);
  again.time = std::max(commanded_, placed_);
  const motion::Limits before = std::exchange(setup_.limits, limits);
  std::string wrong = begin(again);
  if (!wrong.empty()) setup_.limits = before;
  return wrong;
}

std::string SimulatedHead::place(Time now, const motion::PanTilt& by, bool holds) {
  if (count_ == 0) return "the simulated head is not open";
  HeadCommand again = nth_last(0).command;
  if (holds) again.pan = again.tilt = {};
  const bool goes_on = again.pan == nth_last(0).command.pan && again.tilt == nth_last(0).command.tilt;
  if (goes_on && by.pan == 0 && by.tilt == 0) return {};
  const auto shift = [](Leg& leg, double way) {
    leg.plan.shift(way);
    leg.camera += way;
  };
  for (unsigned n = 0; n < count_; ++n) {
    shift(nth_last(n).pan, by.pan);
    shift(nth_last(n).tilt, by.tilt);
  }
  again.time = placed_ = std::max({placed_, commanded_, now});
  const motion::Limits limits = setup_.limits;
  Time end;
  const Chapter& here = chapter_at(again.time + setup_.latency, end);
  const auto widen = [&](motion::AxisLimits& axis, const AxisCommand& command, const Leg& leg) {
    if (command.kind != AxisCommand::Kind::hold) return;
    const double position = leg.plan.at(again.time + setup_.latency).position;
    axis.from = std::min(axis.from, position);
    axis.to = std::max(axis.to, position);
  };
  widen(setup_.limits.pan, again.pan, here.pan);
  widen(setup_.limits.tilt, again.tilt, here.tilt);
  std::string wrong = begin(again);
  setup_.limits = limits;
  return wrong;
}

// Begins a new trajectory from the head's position at the time when the command takes effect.
std::string SimulatedHead::begin(const HeadCommand& command) {
  const Time from = command.time + setup_.latency;
  if (count_ == kKept && nth_last(kKept - 2).from > command.time)
    return "too many commands on their way to the simulated head";
  Time end;
  const Chapter& before = chapter_at(from, end);
  Chapter next{from, follow(before.pan, from, command.pan, setup_.limits.pan),
               follow(before.tilt, from, command.tilt, setup_.limits.tilt), command, before.zoom};
  if (command.zoom) next.zoom = {from, before.zoom.at(from), *command.zoom};
  next.command.zoom.reset();  // it is not given again with the rest
  if (before.from == from) {  // of two commands of one time the later one counts
    nth_last(0) = next;
    return {};
  }
  chapters_[next_] = next;
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
  return {};
}

// Returns the state of the camera behind the play. No piece of a plan reverses, so that the extremes of the motor's
// trajectory lie at the ends of pieces.
AxisState SimulatedHead::camera(const Leg& leg, Time time, Time& until) const {
  const AxisState motor = leg.plan.at(time);
  until = leg.plan.piece_end(time);
  const double play = setup_.backlash / 2;
  if (play == 0) return motor;
  double position = leg.camera;
  for (Time end = leg.plan.start(); end < time; end = leg.plan.piece_end(end))
    position = dragged(position, leg.plan.at(end).position, play);
  position = dragged(position, motor.position, play);
  const double direction = motor.speed != 0 ? motor.speed : motor.acceleration;
  if (direction == 0) return {position, 0, 0};
  const double contact = direction > 0 ? position + play : position - play;
  constexpr double kTouching = 1e-12;
  if (std::abs(contact - motor.position) < kTouching) return {position, motor.speed, motor.acceleration};
  const double wait = arrival(motor, contact);
  if (wait < 1e9) until = std::min(until, time + Time(static_cast<Time::rep>(std::ceil(wait * 1e9))));
  return {position, 0, 0};
}

double SimulatedHead::Zoom::at(Time time) const {
  const double most = time > from ? kZoomSpeed * motion::seconds(time - from) : 0;
  return begin + std::clamp(end - begin, -most, most);
}

void SimulatedHead::look_through(const Zoom& zoom, Time time, motion::Pose& pose) const {
  if (setup_.zoom_table.empty()) return;
  const double position = zoom.at(time);
  pose.field_of_view = setup_.zoom_table.field_of_view(position);
  if (position != zoom.end) pose.until = std::min(pose.until, time + kZoomPiece);
}

// Gaussian by Box and Muller, a new value every millisecond.
double SimulatedHead::noise(Time time, unsigned axis) const {
  if (setup_.noise == 0) return 0;
  const auto tick = static_cast<std::uint64_t>(std::chrono::floor<std::chrono::milliseconds>(time).count());
  const std::uint64_t x = scramble(scramble(setup_.seed) ^ (2 * tick + axis));
  return setup_.noise * std::sqrt(-2 * std::log(uniform(x))) *
         std::cos(2 * std::numbers::pi * uniform(scramble(x)));
}

std::string SimulatedHead::state(Time time, motion::Pose& pose) {
  if (count_ == 0) return "the simulated head is not open";
  Time end, pan_end, tilt_end;
  const Chapter& chapter = chapter_at(time, end);
  pose = {};
  pose.from = time;
  pose.pan = camera(chapter.pan, time, pan_end);
  pose.tilt = camera(chapter.tilt, time, tilt_end);
  pose.until = std::min({end, pan_end, tilt_end});
  pose.settled = pose.until == kNever && !pose.moving();
  look_through(chapter.zoom, time, pose);
  pose.measured = setup_.noise > 0;
  if (pose.measured) {
    pose.pan.position = noisy(pose.pan.position, noise(time, 0), setup_.limits.pan);
    pose.tilt.position = noisy(pose.tilt.position, noise(time, 1), setup_.limits.tilt);
  }
  return {};
}

}  // namespace cerberus::drivers
