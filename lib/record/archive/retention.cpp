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

std::string Retention::take_fault() {
  if (fault_ == taken_) return {};
  return taken_ = fault_;
}

std::vector<std::int64_t> Retention::expired(std::span<const Candidate> recordings, const Limits& limits,
                                             const Surroundings& now) {
  const bool by_age = clock_is_trusted(recordings, now) && limits.age > Time::zero();
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  const auto add = [](std::uint64_t& sum, std::uint64_t bytes) { sum += std::min(bytes, kMost - sum); };
  std::uint64_t total = 0, kept = 0, free = now.free_bytes.value_or(kMost);
  std::uint64_t most_free = free;
  std::optional<std::int64_t> newest;
  for (const Candidate& each : recordings)
    if (!each.open) newest = each.id;
  for (const Candidate& each : recordings) {
    add(total, each.bytes);
    if (each.keep) add(kept, each.bytes);
    if (!each.keep && !each.open && each.id != newest) add(most_free, each.bytes);
  }
  const bool size_reachable = kept <= limits.total_bytes, room_reachable = most_free >= limits.free_bytes;
  fault_.clear();
  if (limits.total_bytes && !size_reachable)
    fault_ = "retention-size: the recordings that are kept are larger, so none is deleted for it";
  if (!recordings.empty() && !room_reachable)
    fault_ += std::string(fault_.empty() ? "" : "; ") +
              "retention-free: deleting recordings cannot make so much room, so none is deleted for it";
  std::vector<std::int64_t> ids;
  Time end = Time::min() / 2;
  for (const Candidate& each : recordings) {
    if (each.end <= now.utc) end = std::max(end, each.end);
    if (each.keep || each.open) continue;
    const bool old = by_age && each.end <= now.utc && now.utc - end > limits.age;
    const bool too_much =
        each.id != newest && size_reachable && limits.total_bytes && total > limits.total_bytes;
    const bool no_room = each.id != newest && room_reachable && free < limits.free_bytes;
    if (!old && !too_much && !no_room) continue;
    ids.push_back(each.id);
    total -= each.bytes;
    add(free, each.bytes);
  }
  return ids;
}

}  // namespace cerberus::record
