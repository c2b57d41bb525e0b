// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/pir_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::sensing {

namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr Time kMostDebounce = milliseconds(50);
constexpr Time kLongAgo = Time::min();

// Returns time + duration for a duration of at least 0; kNever if the sum overflows.
constexpr Time later(Time time, Time duration) {
  return time > Time::zero() && duration > kNever - time ? kNever : time + duration;
}

constexpr Time not_negative(Time time) {
  return std::max(time, Time::zero());
}

// The warm-up of AM312 and SK-11 and the angle of the AM312 are assumed from similar modules: the data sheets do not
// state them. stuck_after is far longer than the longest hold of any module.
constexpr PirPreset kPresets[] = {
    {.name = "hc-sr501",
     .options = {.warm_up = seconds(60)},
     .module_hold = {milliseconds(300), seconds(200)},
     .module_block = {milliseconds(200), seconds(4)},
     .range = 7,
     .field_of_view = radians(120)},
    {.name = "am312",
     .options = {.warm_up = seconds(30)},
     .module_hold = {seconds(2), seconds(2)},
     .module_block = {seconds(2), seconds(2)},
     .range = 5,
     .field_of_view = radians(100)},
    {.name = "sk-11",
     .options = {.active_low = true, .warm_up = seconds(60)},
     .module_hold = {},
     .module_block = {},
     .range = 12,
     .field_of_view = radians(120)},
};

}  // namespace

std::string_view describe(PirFault fault) {
  switch (fault) {
    case PirFault::stuck_on:
      return "stuck on";
    case PirFault::chattering:
      return "chattering";
    case PirFault::none:
      break;
  }
  return "";
}

std::span<const PirPreset> pir_presets() {
  return kPresets;
}

PirModel::PirModel(const PirOptions& options) : options_(options) {
  options_.debounce = std::clamp(options_.debounce, Time::zero(), kMostDebounce);
  options_.min_pulse = not_negative(options_.min_pulse);
  options_.hold = not_negative(options_.hold);
  options_.block = not_negative(options_.block);
  options_.warm_up = not_negative(options_.warm_up);
  options_.stuck_after = not_negative(options_.stuck_after);
  options_.chatter_edges = std::min(options_.chatter_edges, kRises);
  options_.chatter_window = not_negative(options_.chatter_window);
}

void PirModel::start(Time now, bool level) {
  now_ = changed_ = now;
  started_ = true;
  line_ = pulse_ = detecting_ = false;
  last_fall_ = pulse_end_ = hold_until_ = blocked_until_ = kLongAgo;
  warm_until_ = std::exchange(warms_until_, std::nullopt).value_or(later(now, options_.warm_up));
  warming_ = warm_until_ > now;
  presence_ = Presence::invalid;
  fault_ = PirFault::none;
  moves_ = false;
  doubt_ = {};
  rise_count_ = 0;
  line_ = level != options_.active_low;
  if (line_) {
    rise(now);
    begin_pulse(now);
  }
  settle(now);
}

void PirModel::forget_level() {
  const std::optional<Time> until = started_ ? std::optional(warm_until_) : warms_until_;
  *this = PirModel(options_);
  warms_until_ = until;
}

void PirModel::edge(Time time, bool level) {
  if (!started_) return start(time, level);
  advance(time);
  const bool line = level != options_.active_low;
  if (line == line_) return;
  line_ = line;
  if (line_) {
    rise(now_);
  } else {
    last_fall_ = now_;
    if (std::exchange(pulse_, false)) pulse_end_ = now_;
  }
  settle(now_);
}

Time PirModel::poll(Time now) {
  if (started_) advance(now);
  return deadline();
}

void PirModel::base(Time time, double passing) {
  if (!started_) return;
  advance(time);
  moves_ = std::abs(passing) > kDoubtfulTurn;  // false for NaN
  moves_until_ = later(now_, kBaseLifetime);
  settle(now_);
}

void PirModel::advance(Time until) {
  for (Time due = deadline(); due <= until && due != kNever; due = deadline()) {
    now_ = std::max(now_, due);
    settle(now_);
  }
  now_ = std::max(now_, until);
}

void PirModel::rise(Time now) {
  // A gap shorter than the debounce time does not interrupt the active time of a stuck line.
  if (rise_count_ == 0 || later(last_fall_, options_.debounce) <= now) active_since_ = now;
  rises_[rise_count_++ % kRises] = now;
  if (rise_count_ == 2 * kRises) rise_count_ = kRises;  // only "at least kRises" matters; never wraps to 0
  rose_ = now;
  if (detecting_ && later(pulse_end_, options_.debounce) > now) begin_pulse(now);  // it goes on
}

void PirModel::begin_pulse(Time now) {
  pulse_ = true;
  if (detecting_ && options_.retrigger) hold_until_ = std::max(hold_until_, later(now, options_.hold));
}

// Returns the time of the n-th last rise, n >= 1; kLongAgo if there were fewer rises.
Time PirModel::past_rise(unsigned n) const {
  return rise_count_ >= n ? rises_[(rise_count_ - n) % kRises] : kLongAgo;
}

// Returns the time from which fewer rises than half of chatter_edges are left in the window.
Time PirModel::calm_time() const {
  return later(past_rise(std::max(1U, options_.chatter_edges / 2)), options_.chatter_window);
}

// Returns the time at which the detection ends if no edge comes; kNever: not before the line falls.
Time PirModel::end_time() const {
  if (!options_.retrigger && options_.hold > Time::zero()) return hold_until_;
  return pulse_ ? kNever : std::max(later(pulse_end_, options_.debounce), hold_until_);
}

Time PirModel::deadline() const {
  if (!started_) return kNever;
  Time due = kNever;
  const auto at = [&due](bool expected, Time time) {
    if (expected) due = std::min(due, time);
  };
  at(warming_, warm_until_);
  at(line_ && !pulse_, later(rose_, options_.min_pulse));
  at(detecting_, end_time());
  at(!detecting_ && pulse_, blocked_until_);
  at(fault_ == PirFault::none && line_ && options_.stuck_after > Time::zero(),
     later(active_since_, options_.stuck_after));
  at(fault_ == PirFault::stuck_on && !line_, later(last_fall_, options_.debounce));
  at(fault_ == PirFault::chattering, calm_time());
  at(moves_, moves_until_);
  at(true, doubt_.due());
  return due;
}

// Updates the state to `now` and clears each deadline that has passed.
void PirModel::settle(Time now) {
  if (warming_ && now >= warm_until_) warming_ = false;

  if (line_ && !pulse_ && now >= later(rose_, options_.min_pulse)) begin_pulse(now);
  if (detecting_ && now >= end_time()) {
    detecting_ = false;
    blocked_until_ = options_.block > Time::zero() ? later(now, options_.block) : kLongAgo;
  }
  if (!detecting_ && pulse_ && now >= blocked_until_) {
    detecting_ = true;
    hold_until_ = later(now, options_.hold);
  }

  const PirFault old_fault = fault_;
  const unsigned limit = options_.chatter_edges;
  if (fault_ == PirFault::stuck_on && !line_ && now >= later(last_fall_, options_.debounce))
    fault_ = PirFault::none;
  if (fault_ == PirFault::chattering && now >= calm_time()) fault_ = PirFault::none;
  if (limit > 0 && rise_count_ >= limit && later(past_rise(limit), options_.chatter_window) > now)
    fault_ = PirFault::chattering;
  if (fault_ == PirFault::none && line_ && options_.stuck_after > Time::zero() &&
      now >= later(active_since_, options_.stuck_after))
    fault_ = PirFault::stuck_on;

  if (moves_ && now >= moves_until_) moves_ = false;
  doubt_.update(now, detecting_, moves_);

  const Presence old_presence = presence_;
  presence_ = warming_ || fault_ != PirFault::none ? Presence::invalid
              : detecting_                         ? Presence::detected
                                                   : Presence::none;
  if (presence_ != old_presence || fault_ != old_fault) changed_ = now;
}

}  // namespace cerberus::sensing
