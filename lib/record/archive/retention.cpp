// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/retention.h"

#include <algorithm>
#include <limits>

namespace cerberus::record {

bool Retention::clock_is_trusted(std::span<const Candidate> recordings, const Surroundings& now) {
  bool jumped = false;
  if (before_) {
    const Time drift = (now.utc - before_->utc) - (now.steady - before_->steady);
    jumped = drift > parameters_.jump || drift < -parameters_.jump;
  } else if (!recordings.empty()) {
    const auto newest = std::ranges::max_element(recordings, {}, &Candidate::end);
    jumped = now.utc - newest->end > parameters_.absence;
  }
  before_ = now;
  if (jumped) trusted_from_ = now.steady + parameters_.settling;
  return !trusted_from_ || now.steady >= *trusted_from_;
}

std::vector<std::int64_t> Retention::expired(std::span<const Candidate> recordings, const Limits& limits,
                                             const Surroundings& now) {
  const bool by_age = clock_is_trusted(recordings, now) && limits.age > Time::zero();
  std::uint64_t total = 0, free = now.free_bytes.value_or(std::numeric_limits<std::uint64_t>::max());
  for (const Candidate& each : recordings) total += each.bytes;
  std::vector<std::int64_t> ids;
  Time end = Time::min() / 2;
  for (const Candidate& each : recordings) {
    if (each.end <= now.utc) end = std::max(end, each.end);
    if (each.keep || each.open) continue;
    const bool old = by_age && each.end <= now.utc && now.utc - end > limits.age;
    const bool too_much = limits.total_bytes && total > limits.total_bytes;
    const bool no_room = limits.free_bytes && free < limits.free_bytes;
    if (!old && !too_much && !no_room) continue;
    ids.push_back(each.id);
    total -= each.bytes;
    free += std::min(each.bytes, std::numeric_limits<std::uint64_t>::max() - free);
  }
  return ids;
}

}  // namespace cerberus::record
