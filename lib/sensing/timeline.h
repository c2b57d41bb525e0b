// SPDX-License-Identifier: LGPL-2.1-or-later
// Stores values by running time and returns the newest one not later than a given time: for poses the time of the
// frame, for PIR readings of a live stream the time at which the frame arrived.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <utility>

namespace cerberus::sensing {

template <typename T>
class Timeline {
 public:
  using Time = std::chrono::nanoseconds;
  struct Entry {
    Time time;
    T value;
  };
  // Entries that come late by at most this are inserted in order of time. A larger step back means that running
  // time began anew (a seek of a live pipeline): the stored entries are dropped.
  static constexpr Time kDisorder = std::chrono::seconds(1);
  // Largest number of entries: beyond it the oldest is dropped.
  static constexpr std::size_t kMost = 4096;

  // Inserts an entry; it replaces an entry of the same time.
  void insert(Time time, T value) {
    if (!entries_.empty() && time < entries_.back().time - kDisorder) entries_.clear();
    const auto after = std::upper_bound(entries_.begin(), entries_.end(), time,
                                        [](Time t, const Entry& entry) { return t < entry.time; });
    if (after != entries_.begin() && std::prev(after)->time == time) {
      std::prev(after)->value = std::move(value);
      return;
    }
    entries_.insert(after, Entry{time, std::move(value)});
    if (entries_.size() > kMost) entries_.pop_front();
  }

  // Returns the newest entry not later than `time`; nullptr if there is none.
  const Entry* entry_at(Time time) const {
    const auto after = std::upper_bound(entries_.begin(), entries_.end(), time,
                                        [](Time t, const Entry& entry) { return t < entry.time; });
    return after == entries_.begin() ? nullptr : &*std::prev(after);
  }
  const T* at(Time time) const {
    const Entry* entry = entry_at(time);
    return entry ? &entry->value : nullptr;
  }
  const T* first() const { return entries_.empty() ? nullptr : &entries_.front().value; }
  // Returns the last entry, or the one `before` entries before it; nullptr if there is none.
  const Entry* last(std::size_t before = 0) const {
    return entries_.size() > before ? &entries_[entries_.size() - 1 - before] : nullptr;
  }
  // Moves the last entry to a later time, at which it was repeated.
  void postpone_last(Time time) { entries_.back().time = time; }

  // Drops the entries that at(`time`) and later times cannot return.
  void forget_before(Time time) {
    while (entries_.size() > 1 && entries_[1].time <= time) entries_.pop_front();
  }
  void clear() { entries_.clear(); }
  std::size_t size() const { return entries_.size(); }

 private:
  std::deque<Entry> entries_;
};

}  // namespace cerberus::sensing
