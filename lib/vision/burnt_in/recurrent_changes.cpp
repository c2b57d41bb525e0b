// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/recurrent_changes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace cerberus::vision {

namespace {

constexpr double kMilli = 1000;

}  // namespace

void RecurrentChanges::resize(const BlockGrid& grid) {
  blocks_.assign(grid.count(), {});
  changed_.assign(grid.count(), 0);
  bits_.assign(2 * static_cast<std::size_t>(grid.words), 0);
  grid_ = grid;
}

void RecurrentChanges::reset() {
  std::fill(blocks_.begin(), blocks_.end(), Block{});
}

double RecurrentChanges::rest() const {
  return std::max(parameters_.rest, parameters_.rest_frames * period_);
}

// Returns whether a change comes after the block's usual interval, or a few of them.
bool RecurrentChanges::keeps_time(Block& b, double seconds) const {
  const double usual = b.interval / kMilli, slack = parameters_.interval_slack * period_;
  const auto is_multiple = [&](double longer, double shorter) {
    const double times = std::round(longer / shorter);
    return times >= 1 && times <= parameters_.most_multiple && std::abs(longer - times * shorter) <= slack;
  };
  const bool same = usual > 0 && (is_multiple(seconds, usual) || is_multiple(usual, seconds));
  if (!same || seconds < usual) b.interval = static_cast<std::uint16_t>(std::lround(kMilli * seconds));
  return same;
}

void RecurrentChanges::set_time(double now, double period) {
  const auto ticks = static_cast<std::uint64_t>(std::llround(now / kTick));
  now_ = static_cast<Time>(ticks) ? static_cast<Time>(ticks) : Time{1};
  period_ = period;
}

// A change in one or two frames counts once it was followed by rest and the next one comes, if it comes in time.
void RecurrentChanges::note(Block& b) {
  const double ago = b.last ? seconds_since(b.last) : parameters_.stale;
  if (ago >= parameters_.stale) {
    b = {now_, now_, now_, 0, 1, 0};
    return;
  }
  if (ago < parameters_.in_a_row * period_) {
    if (b.frames < UINT8_MAX) ++b.frames;
    if (b.frames > parameters_.change_frames) b.changes = 0;
  } else {
    const bool at_once = b.frames <= parameters_.change_frames && ago >= rest();
    if (!at_once || !keeps_time(b, ago))
      b.changes = 0;
    else if (b.changes < UINT8_MAX)
      ++b.changes;
    if (b.changes == 0) b.first = b.last;
    b.frames = 1;
    if (ago >= rest()) b.since = now_;
  }
  b.last = now_;
}

void RecurrentChanges::forget_old() {
  // At low frame rates a row a call would take longer than the times count.
  for (int rows = std::min(period_ > kLongPeriod ? grid_.rows : 1, grid_.rows); rows > 0; --rows) {
    aged_ = (aged_ + 1) % grid_.rows;
    forget_old(aged_);
  }
}

void RecurrentChanges::forget_old(int row) {
  const auto longest = static_cast<Time>(parameters_.stale / kTick);
  for (std::size_t i = grid_.at(0, row); i < grid_.at(0, row) + grid_.stride(); ++i) {
    Block& b = blocks_[i];
    if (!b.last) continue;
    if (seconds_since(b.last) >= parameters_.stale) {
      b = {};
      continue;
    }
    // What goes on for longer began that long ago at least.
    for (Time* began : {&b.since, &b.first})
      if (seconds_since(*began) > parameters_.stale) *began = static_cast<Time>(now_ - longest);
  }
}

// Writes changed_ and returns the number of blocks that have changed.
std::size_t RecurrentChanges::find_changes(GrayView difference, int threshold) {
  std::size_t count = 0;
  for (int row = 0; row < grid_.rows; ++row)
    count += find_blocks(difference, std::max(threshold, parameters_.least_step), parameters_.least_changed,
                         grid_, row, bits_, changed_.data() + grid_.at(0, row));
  return count;
}

bool RecurrentChanges::update(GrayView difference, int threshold) {
  const std::size_t count = find_changes(difference, threshold);
  if (count == 0 || static_cast<double>(count) >= parameters_.whole_picture * grid_.columns * grid_.rows)
    return false;
  for (std::size_t first = 0; first < changed_.size(); first += BlockGrid::kWord) {
    if (!load_counts(changed_.data() + first)) continue;
    for (std::size_t i = first; i < first + BlockGrid::kWord; ++i)
      if (changed_[i]) note(blocks_[i]);
  }
  return true;
}

bool RecurrentChanges::is_candidate(std::size_t block) const {
  const Block& b = blocks_[block];
  if (!b.last) return false;
  const double ago = seconds_since(b.last);
  if (ago < rest() && seconds_since(b.since) - ago >= parameters_.enough_busy) return true;
  return is_recurrent(b) && ago < parameters_.recent &&
         seconds_since(b.first) - ago >= parameters_.enough_time;
}

double RecurrentChanges::since_begin(std::size_t block) const {
  const Block& b = blocks_[block];
  if (!b.last) return std::numeric_limits<double>::infinity();
  return seconds_since(is_recurrent(b) ? b.first : b.since);
}

double RecurrentChanges::since_change(std::size_t block) const {
  const Block& b = blocks_[block];
  return b.last ? seconds_since(b.last) : std::numeric_limits<double>::infinity();
}

}  // namespace cerberus::vision
