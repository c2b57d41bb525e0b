// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/decisions.h"

#include <algorithm>

namespace cerberus::fusion {
namespace {

constexpr std::string_view kChosen = "chosen";
// Tracks that are older than this decide nothing between two frames.
constexpr Time kBetween = std::chrono::seconds(1);

}  // namespace

bool Decisions::Change::replaces(const Change& newer, const Change& older) {
  const Decision &a = newer.outcome.decision, &b = older.outcome.decision;
  return a.rule == b.rule && a.rule_name == b.rule_name && a.action == b.action;
}

void Decisions::configure(const FuserOptions& options, const RuleTable& table) {
  const std::lock_guard guard(lock_);
  fuser_.set_table(table);
  fuser_.set_options(options);
}

void Decisions::choose(std::uint32_t track) {
  const std::lock_guard guard(lock_);
  choice_.choose(track);
  chosen_ = TargetOverride::Answer::none;  // the last frame says nothing of this track
}

// While the chosen track is awaited a sensor's turn goes on: it may lead to it.
void Decisions::apply_choice(Decision& decision) const {
  const bool here = chosen_ == TargetOverride::Answer::here;
  const bool awaited = chosen_ == TargetOverride::Answer::awaited;
  if (!here && !(awaited && decision.action == Action::track)) return;
  decision.action = here ? Action::track : Action::hold;
  decision.rule = 0;
  decision.rule_name = kChosen;
  decision.target = here ? choice_.id() : 0;
  decision.sector = {kUnknown, kUnknown};
  decision.limited = decision.immediate = false;
}

Interval Decisions::limits() const {
  const std::lock_guard guard(lock_);
  return fuser_.options().limits;
}

void Decisions::restart() {
  fuser_.reset();
  choice_.restart();
  last_.reset();
  sensor_time_ = Time::zero();
}

void Decisions::begin_anew() {
  const std::lock_guard guard(lock_);
  restart();
}

void Decisions::end() {
  const std::lock_guard guard(lock_);
  last_.reset();
}

void Decisions::forget() {
  const std::lock_guard guard(lock_);
  restart();
  fuser_ = {};
  choice_.choose(0);
  chosen_ = TargetOverride::Answer::none;
  changes_.clear();
}

Decisions::Outcome Decisions::decide(const Frame& frame, Time at) {
  const SensorSnapshot& snapshot = frame.snapshot;
  if (snapshot.count > 0) {
    sensing::Geometry geometry;
    geometry.set(std::span(snapshot.bearings).first(snapshot.count),
                 std::span(snapshot.fields_of_view).first(snapshot.count));
    fuser_.set_geometry(geometry);
  }
  Outcome outcome{fuser_.update({.time = frame.time,
                                 .sensor_time = sensor_time_,
                                 .tracks = tracks_,
                                 .sensors = std::span(snapshot.sensors).first(snapshot.count),
                                 .pan = sensing::radians(snapshot.pan_degrees),
                                 .base_yaw_rate = sensing::radians(snapshot.base_degrees),
                                 .base_speed = snapshot.base_speed,
                                 .lens = snapshot.lens}),
                  snapshot, sensor_time_};
  Decision& decision = outcome.decision;
  apply_choice(decision);
  const auto of_choice = [](const Decision& one) { return one.rule_name == kChosen; };
  // The rules' own changes behind the choice are none.
  if (of_choice(decision) || of_choice(said_))
    decision.changed = decision.rule_name != said_.rule_name || decision.action != said_.action ||
                       decision.target != said_.target;
  // The name outlives the rule table.
  auto name = names_.find(outcome.decision.rule_name);
  if (name == names_.end()) name = names_.emplace(outcome.decision.rule_name).first;
  outcome.decision.rule_name = *name;
  said_ = outcome.decision;
  if (outcome.decision.changed) changes_.put({at, outcome});
  return outcome;
}

// A decision between two frames may have used later readings than this frame's: they stay in use. Where the difference
// is larger than any disorder, running time began anew.
Time Decisions::not_before_last(Time sensor_time, bool live) const {
  const bool later =
      sensor_time < sensor_time_ && sensor_time_ - sensor_time < sensing::Timeline<Reading>::kDisorder;
  return live && later ? sensor_time_ : sensor_time;
}

bool Decisions::may_follow(Time sensor_time) const {
  return last_ && sensor_time - last_->sensor_time <= kBetween;
}

Decisions::Outcome Decisions::decide_frame(const Frame& frame, bool live) {
  const bool here = std::ranges::find(tracks_, choice_.id(), &Track::id) != tracks_.end();
  chosen_ = choice_.watch(here, frame.time);
  Outcome outcome = decide(frame, frame.time);
  last_.reset();
  if (live && !inputs_.flushing()) last_ = frame;
  return outcome;
}

std::optional<Decisions::Outcome> Decisions::decide_between(const Frame& frame, Time sensor_time) {
  const auto same = [&](auto part) {
    return std::ranges::equal(std::span(frame.snapshot.*part).first(frame.snapshot.count),
                              std::span(last_->snapshot.*part).first(last_->snapshot.count));
  };
  // Other sensors are for the next frame.
  if (!same(&SensorSnapshot::bearings) || !same(&SensorSnapshot::fields_of_view)) return std::nullopt;
  if (same(&SensorSnapshot::sensors)) return std::nullopt;
  sensor_time_ = std::max(sensor_time, sensor_time_ + Time(1));
  last_ = frame;
  return decide(frame, sensor_time_);
}

}  // namespace cerberus::fusion
