// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/retention.h"

#include <algorithm>
#include <limits>
#include <utility>

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
  if (!before_ || jumped) seen_from_ = now.steady;
  before_ = now;
  if (jumped) trusted_from_ = now.steady + parameters_.settling;
  return now.utc >= parameters_.least_utc && (!trusted_from_ || now.steady >= *trusted_from_);
}

// A recording's age is the sum of the times from each end to the next one and from the last one to now. Of a clock
// that is not synchronised, what lies before `seen_from_` counts as `absence` at most in each of them.
void Retention::find_ages(std::span<const Candidate> recordings, const Surroundings& now) {
  ages_.assign(recordings.size(), std::nullopt);
  Time end{};
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Time own = recordings[k].end;
    if (own <= now.utc && own >= parameters_.least_utc) end = std::max(end, own);
    if (end != Time::zero()) ages_[k] = end;
  }
  const Time seen_from = now.utc - (now.steady - seen_from_);
  std::optional<Time> age;
  Time older = now.utc;
  for (std::size_t k = recordings.size(); k-- > 0;) {
    if (ages_[k]) {
      const Time newer = std::exchange(older, *ages_[k]), seen = std::clamp(seen_from, older, newer);
      const Time unseen = seen - older;
      age = age.value_or(Time::zero()) + (newer - seen) +
            (now.synchronised ? unseen : std::min(unseen, parameters_.absence));
    }
    ages_[k] = age;  // a recording without a known time is as old as the next one at least
  }
}

// `sum`: of free and recorded bytes, which grows by what deletions free and falls by what others take.
bool Retention::may_clear(const Limits& limits, const Surroundings& now, std::uint64_t sum) {
  if (now.free_bytes >= limits.free_bytes) {
    clearing_.reset();
    cleared_again_ = Time::min();
    pause_ = Time::zero();
  } else if (clearing_ && now.steady - clearing_->at >= parameters_.effect) {
    const auto lost = static_cast<double>(clearing_->sum) - static_cast<double>(sum);
    if (lost <= (1 - parameters_.least_effect) * static_cast<double>(clearing_->bytes)) {
      clearing_.reset();
      pause_ = Time::zero();
    } else if (now.steady - clearing_->at >= parameters_.latest_effect) {
      clearing_.reset();
      pause_ = std::clamp(2 * pause_, parameters_.pause, parameters_.longest_pause);
      cleared_again_ = now.steady + pause_;
    }
  }
  return !clearing_ && now.steady >= cleared_again_;
}

std::string Retention::take_fault() {
  if (fault_ == taken_) return {};
  return taken_ = fault_;
}

std::vector<std::int64_t> Retention::expired(std::span<const Candidate> recordings, const Limits& limits,
                                             const Surroundings& now) {
  const bool by_age = clock_is_trusted(recordings, now) && limits.age > Time::zero();
  find_ages(recordings, now);
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
  std::uint64_t sum = total;
  add(sum, free);
  const bool may_clear = this->may_clear(limits, now, sum);
  const bool size_reachable = kept <= limits.total_bytes, room_reachable = most_free >= limits.free_bytes;
  fault_.clear();
  const auto complain = [this](const char* text) {
    fault_ += (fault_.empty() ? "" : "; ") + std::string(text);
  };
  if (limits.total_bytes && !size_reachable)
    complain("retention-size: the recordings that are kept are larger, so none is deleted for it");
  if (!recordings.empty() && !room_reachable)
    complain("retention-free: deleting recordings cannot make so much room, so none is deleted for it");
  else if (pause_ > Time::zero())
    complain(
        "retention-free: deleting recordings made no room, so hardly any is deleted for it: another program "
        "fills the "
        "disk or has deleted recordings open");
  std::vector<std::int64_t> ids;
  std::uint64_t bytes = 0;
  bool cleared = false;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Candidate& each = recordings[k];
    if (each.keep || each.open) continue;
    const bool old = by_age && each.end <= now.utc && ages_[k] && *ages_[k] > limits.age;
    const bool too_much =
        each.id != newest && size_reachable && limits.total_bytes && total > limits.total_bytes;
    const bool no_room = each.id != newest && room_reachable && may_clear && free < limits.free_bytes;
    if (!old && !too_much && !no_room) continue;
    cleared |= no_room;
    ids.push_back(each.id);
    total -= each.bytes;
    add(free, each.bytes);
    add(bytes, each.bytes);
  }
  if (cleared) clearing_ = {now.steady, bytes, sum};
  return ids;
}

}  // namespace cerberus::record
