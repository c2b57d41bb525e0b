// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/sensor_history.h"

#include <algorithm>

namespace cerberus::fusion {

void SensorHistory::append(Time time, std::span<const std::uint8_t> values) {
  Reading reading;
  reading.array = array_;
  reading.values.fill(kInvalid);
  const auto count = static_cast<std::size_t>(array_ ? array_->count : 0);
  std::ranges::transform(values.first(std::min(values.size(), count)), reading.values.begin(),
                         [](std::uint8_t value) { return std::min(value, kInvalid); });

  const auto* last = readings_.last();
  if (last && time < last->time - sensing::Timeline<Reading>::kDisorder)
    covered_ = Time::min();  // time began anew
  // Heartbeats repeat the last reading: of equal readings in a row the first and the last are kept.
  const auto* before = readings_.last(1);
  if (before && time >= last->time && last->value == reading && before->value == reading)
    readings_.postpone_last(time);
  else
    readings_.insert(time, std::move(reading));
  ended_ = false;
  covered_ = std::max(covered_, time + Time(1));
}

void SensorHistory::cover(Time until) {
  ended_ = false;
  covered_ = std::max(covered_, until);
}

void SensorHistory::clear() {
  readings_.clear();
  covered_ = Time::min();
  ended_ = false;
}

Reading SensorHistory::at(Time time) const {
  if (const Reading* reading = readings_.at(time)) return *reading;
  Reading none;
  const Reading* first = readings_.first();
  none.array = first ? first->array : array_;
  none.values.fill(kInvalid);
  return none;
}

}  // namespace cerberus::fusion
