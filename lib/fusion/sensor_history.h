// SPDX-License-Identifier: LGPL-2.1-or-later
// The readings of one group of PIR sensors by running time, and the time up to which they are complete. A stream that
// is not live waits until covers(frame's running time) and reads at that time; a live one reads at the time when the
// frame arrived, which may be later. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "fusion/fuser.h"
#include "sensing/sectors.h"
#include "sensing/timeline.h"

namespace cerberus::fusion {

// The sensors of one group.
struct SensorArray {
  int count = 0;
  std::array<double, sensing::kMaxSensors> bearings{};  // radians
  double field_of_view = 0;                             // radians
};

constexpr std::uint8_t kInvalid = 2;  // as in the PIR caps

// Their values at one time.
struct Reading {
  std::shared_ptr<const SensorArray> array;               // nullptr: not known yet
  std::array<std::uint8_t, sensing::kMaxSensors> values;  // 0, 1, kInvalid
  bool operator==(const Reading&) const = default;
};

class SensorHistory {
 public:
  // Sets the sensors of readings to come; stored readings keep theirs.
  void set_array(std::shared_ptr<const SensorArray> array) { array_ = std::move(array); }
  // Appends a reading, which is valid from `time` on. Missing values are invalid.
  void append(Time time, std::span<const std::uint8_t> values);
  // Records that nothing changes before `until` (a GAP event).
  void cover(Time until);
  // Records that no more readings come (EOS). append() and cover() revoke it.
  void end() { ended_ = true; }
  bool ended() const { return ended_; }
  void clear();

  // Returns true when no reading that is valid at `time` can still come (from a stream in order).
  bool covers(Time time) const { return ended_ || covered_ > time; }
  // Returns the newest reading not later than `time`; all invalid if there is none.
  Reading at(Time time) const;
  void forget_before(Time time) { readings_.forget_before(time); }
  // Returns the time for a reading that has none: that of the newest reading.
  Time newest() const { return readings_.last() ? readings_.last()->time : Time::zero(); }
  std::size_t size() const { return readings_.size(); }

 private:
  sensing::Timeline<Reading> readings_;
  std::shared_ptr<const SensorArray> array_;
  Time covered_ = Time::min();  // the readings are complete up to this time
  bool ended_ = false;
};

}  // namespace cerberus::fusion
