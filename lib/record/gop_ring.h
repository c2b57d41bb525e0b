// SPDX-License-Identifier: LGPL-2.1-or-later
// The newest part of an encoded video as whole GOPs (a keyframe and what follows up to the next one): what a file can
// begin with. Not thread-safe.
#pragma once

#include <cstddef>
#include <optional>

#include "record/numbered_queue.h"
#include "record/unit.h"

namespace cerberus::record {

class GopRing {
 public:
  // Appends a unit. Returns false and drops it where the ring is empty and it is no keyframe: it cannot be decoded.
  // `continues`: what went before it is in a file, so it is kept all the same.
  bool push(Unit unit, bool continues);
  void clear();

  bool empty() const { return units_.empty(); }
  Number begin() const { return units_.begin(); }
  Number end() const { return units_.end(); }
  const Unit& operator[](Number number) const { return units_[number]; }
  const Unit& newest() const { return units_.back(); }
  std::size_t bytes() const { return bytes_; }
  std::size_t gops() const { return static_cast<std::size_t>(keyframes_.end() - keyframes_.begin()); }

  // Returns the newest keyframe that is shown at or before `time`; the oldest of the ring if all are shown later. So a
  // file that begins there holds everything from `time` on, as far as the ring goes back. nullopt: the ring is empty.
  std::optional<Number> keyframe_at(Time time) const;
  // Returns the oldest keyframe with `number` or a later one.
  std::optional<Number> keyframe_from(Number number) const;

  // Drops every GOP that lies before the one of keyframe_at(time) and ends at or before `limit`.
  void keep_from(Time time, Number limit);
  // Drops what lies before the second keyframe (or before the first one, if that is not the oldest unit).
  void drop_gop();

 private:
  NumberedQueue<Unit> units_;
  NumberedQueue<Number> keyframes_;  // of units_, rising
  std::size_t bytes_ = 0;
};

}  // namespace cerberus::record
