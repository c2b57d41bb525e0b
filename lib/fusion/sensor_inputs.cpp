// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/sensor_inputs.h"

#include <algorithm>
#include <utility>

namespace cerberus::fusion {
namespace {

// A recording of readings is not read into memory as a whole: it stays so far ahead of the video at most.
constexpr Time kAhead = std::chrono::seconds(10);
constexpr Time kLongest = std::chrono::hours(24 * 365);  // the clock's own time must not overflow

bool is_missing(const SensorSource& source, Time time) {
  return source.linked && !source.given_up && !source.history.covers(time);
}

// Stands for a group whose geometry is not known, and for a place without a group. It is invalid, so its bearing and its
// field of view do not matter.
Reading unknown_sensor() {
  static const auto array = [] {
    auto one = std::make_shared<SensorArray>();
    one->count = 1;
    one->field_of_view = 1;
    return std::shared_ptr<const SensorArray>(std::move(one));
  }();
  Reading reading{.array = array, .values = {}};
  reading.values.fill(kInvalid);
  return reading;
}

}  // namespace

void SensorSource::forget() {
  history = {};
  sensors = 0;
  given_up = false;
  live.reset();
  spoken.reset();
}

void SensorInputs::set(bool& flag, bool value) {
  const std::lock_guard guard(lock_);
  flag = value;
  news_.notify_all();
}

bool SensorInputs::flushing() {
  const std::lock_guard guard(lock_);
  return flushing_;
}

void SensorInputs::begin_video() {
  const std::lock_guard guard(lock_);
  video_ended_ = false;
  video_ = Time::zero();
  for (SensorSource* source : sources_) source->spoken.reset();
}

void SensorInputs::begin_seek() {
  const std::lock_guard guard(lock_);
  ++seeks_;
}

void SensorInputs::end_seek() {
  const std::lock_guard guard(lock_);
  --seeks_;
}

bool SensorInputs::frame_came(Time time, Time max_wait, std::vector<SilentSource>& silent) {
  std::unique_lock guard(lock_);
  video_ = time;
  news_.notify_all();
  if (max_wait <= Time::zero()) return true;
  const auto ready = [&] {
    return flushing_ ||
           std::ranges::none_of(sources_, [&](const SensorSource* each) { return is_missing(*each, time); });
  };
  if (max_wait == Time::max()) {
    news_.wait(guard, ready);
  } else if (!news_.wait_for(guard, std::min(max_wait, kLongest), ready)) {
    for (SensorSource* source : sources_)
      if (is_missing(*source, time)) {
        source->given_up = true;
        silent.push_back({source->name, false});
      }
  }
  return !flushing_;
}

void SensorInputs::give_up_silent(Time sensor_time, Time patience, std::vector<SilentSource>& silent) {
  const std::lock_guard guard(lock_);
  for (SensorSource* source : sources_) {
    if (!source->linked || source->given_up || source->live == false) continue;
    if (!source->spoken) source->spoken = sensor_time;  // patience begins with the first frame
    if (sensor_time - *source->spoken <= patience) continue;
    source->given_up = true;
    silent.push_back({source->name, source->history.ended()});
  }
}

void SensorInputs::read(Time sensor_time, SensorSnapshot& snapshot) {
  snapshot.count = 0;
  snapshot.geometry_known = true;
  unsigned place = 0;
  for (SensorSource* source : sources_) {
    for (; place < source->index; ++place) {
      snapshot.add(unknown_sensor());
      snapshot.geometry_known = false;
    }
    ++place;
    Reading reading = source->history.at(sensor_time);
    if (seeks_ == 0) source->history.forget_before(sensor_time);
    if (!reading.array) {
      reading = unknown_sensor();
      snapshot.geometry_known = false;
    }
    if (!source->linked || source->given_up) reading.values.fill(kInvalid);
    snapshot.add(reading);
  }
}

void SensorInputs::forget() {
  video_ = Time::zero();
  video_ended_ = false;
}

void SensorInputs::add_reading(SensorSource& source, Time until) {
  source.spoken = until;
  source.given_up = false;
  news_.notify_all();
}

void SensorInputs::end(SensorSource& source) {
  source.history.end();
  if (source.live == false) source.given_up = false;
  news_.notify_all();
}

bool SensorInputs::wait_for_video(std::unique_lock<std::mutex>& guard, const SensorSource& source,
                                  Time time) {
  news_.wait(guard, [&] { return source.flushing || video_ended_ || time - video_ < kAhead; });
  return !video_ended_;
}

std::optional<unsigned> SensorInputs::free_place(std::optional<std::uint64_t> wanted) const {
  const auto taken = [&](std::uint64_t place) {
    return std::ranges::any_of(sources_, [&](const SensorSource* each) { return each->index == place; });
  };
  std::uint64_t place = wanted.value_or(0);
  if (wanted && taken(place)) return std::nullopt;
  while (taken(place)) ++place;
  if (place >= sensing::kMaxSensors) return std::nullopt;
  return static_cast<unsigned>(place);
}

void SensorInputs::add(SensorSource& source) {
  const auto after =
      std::ranges::find_if(sources_, [&](const SensorSource* each) { return each->index > source.index; });
  sources_.insert(after, &source);
}

void SensorInputs::drop(SensorSource& source) {
  std::erase(sources_, &source);
  news_.notify_all();
}

int SensorInputs::places_besides(const SensorSource& source) const {
  int sum = 0, place = 0;
  for (const SensorSource* each : sources_) {
    sum += static_cast<int>(each->index) - std::exchange(place, static_cast<int>(each->index) + 1);
    if (each != &source) sum += std::max(each->sensors, 1);
  }
  return sum;
}

}  // namespace cerberus::fusion
