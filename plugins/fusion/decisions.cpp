// SPDX-License-Identifier: LGPL-2.1-or-later
#include "decisions.hpp"

#include <algorithm>
#include <utility>

#include "settings.hpp"
#include "shared/tracks.hpp"

namespace cerberus::plugin {
namespace {

// The camera's last word is none after this.
constexpr Time kBetween = std::chrono::seconds(1);

}  // namespace

bool Decisions::Change::replaces(const Change& newer, const Change& older) {
  const CerberusFusion &a = newer.fusion, &b = older.fusion;
  return a.rule == b.rule && a.rule_name == b.rule_name && a.action == b.action;
}

void Decisions::configure(const fusion::FuserOptions& options, const fusion::RuleTable& table) {
  const std::lock_guard guard(lock_);
  fuser_.set_table(table);
  fuser_.set_options(options);
}

fusion::Interval Decisions::limits() const {
  const std::lock_guard guard(lock_);
  return fuser_.options().limits;
}

void Decisions::restart() {
  fuser_.reset();
  last_.reset();
  heard_ = Time::zero();
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
  news_.clear();
}

CerberusFusion Decisions::decide(const Frame& frame, Time at) {
  const SensorSnapshot& moment = frame.moment;
  if (moment.count > 0) {
    sensing::Geometry geometry;
    geometry.set(std::span(moment.bearings).first(moment.count),
                 std::span(moment.fields_of_view).first(moment.count));
    fuser_.set_geometry(geometry);
  }
  const fusion::Decision& decision = fuser_.update({.time = frame.time,
                                                    .heard = heard_,
                                                    .tracks = tracks_,
                                                    .sensors = std::span(moment.sensors).first(moment.count),
                                                    .pan = sensing::radians(moment.pan_degrees),
                                                    .base_yaw_rate = sensing::radians(moment.base_degrees)});
  CerberusFusion fusion = as_fusion(decision, moment, rule_name_);
  fusion.decided = clock_time(heard_);
  if (decision.changed) news_.put({at, fusion});
  return fusion;
}

Decisions::Told Decisions::frame(GstBuffer* buffer, Time time, Time heard, const std::string& head, bool live,
                                 bool by_event) {
  const std::lock_guard guard(lock_);
  // Whoever asked for a later moment meanwhile is not contradicted; by more, running time began anew.
  if (live && heard < heard_ && heard_ - heard < Timeline<Reading>::kDisorder) heard = heard_;
  heard_ = heard;
  const Frame frame{time, heard, inputs_.at(time, heard, head, by_event, buffer)};
  read_tracks(buffer, tracks_);
  const CerberusFusion fusion = decide(frame, time);
  last_.reset();
  if (live && !inputs_.flushing()) last_ = frame;
  return {fusion, frame.moment};
}

std::optional<Decisions::Told> Decisions::between(Time heard, const std::string& head) {
  const std::lock_guard guard(lock_);
  if (!last_ || heard - last_->heard > kBetween) return std::nullopt;
  heard = std::max(heard, heard_);
  Frame frame = *last_;
  inputs_.listen(heard, frame.time, head, frame.moment);
  const auto same = [&](auto part) {
    return std::ranges::equal(std::span(frame.moment.*part).first(frame.moment.count),
                              std::span(last_->moment.*part).first(last_->moment.count));
  };
  // Other sensors are for the next frame.
  if (!same(&SensorSnapshot::bearings) || !same(&SensorSnapshot::fields_of_view)) return std::nullopt;
  if (same(&SensorSnapshot::sensors)) return std::nullopt;
  heard_ = std::max(heard, heard_ + Time(1));
  last_ = frame;
  return Told{decide(frame, heard_), frame.moment};
}

void Decisions::tell(const std::function<void(Time, const CerberusFusion&)>& tell) {
  news_.tell([&](const Change& change) { tell(change.time, change.fusion); });
}

}  // namespace cerberus::plugin
