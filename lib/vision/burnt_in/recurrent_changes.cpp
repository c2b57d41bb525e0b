// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/recurrent_changes.h"

#include <algorithm>
#include <bit>
#include <cmath>

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

// A change in one or two frames counts once it was followed by rest and the next one comes, if it comes in time.
void RecurrentChanges::note(Block& b, Time now) {
  const double ago = b.last ? (now - b.last) / kMilli : parameters_.stale;
  if (ago >= parameters_.stale) {
    b = {now, now, now, 0, 1, 0};
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
    if (ago >= rest()) b.since = now;
  }
  b.last = now;
}

// Writes changed_ and returns the number of blocks that have changed.
std::size_t RecurrentChanges::find_changes(GrayView difference, int threshold) {
  std::size_t count = 0;
  for (int row = 0; row < grid_.rows; ++row)
    count += find_blocks(difference, std::max(threshold, parameters_.least_step), parameters_.least_changed,
                         grid_, row, bits_, changed_.data() + grid_.at(0, row));
  return count;
}

bool RecurrentChanges::update(GrayView difference, int threshold, Time now, double period) {
  period_ = period;
  const std::size_t count = find_changes(difference, threshold);
  if (count == 0 || static_cast<double>(count) >= parameters_.whole_picture * grid_.columns * grid_.rows)
    return false;
  for (std::size_t first = 0; first < changed_.size(); first += BlockGrid::kWord) {
    if (!load_counts(changed_.data() + first)) continue;
    for (std::size_t i = first; i < first + BlockGrid::kWord; ++i)
      if (changed_[i]) note(blocks_[i], now);
  }
  return true;
}

bool RecurrentChanges::is_candidate(std::size_t block, Time now) const {
  const Block& b = blocks_[block];
  if (!b.last) return false;
  const double ago = (now - b.last) / kMilli;
  if (ago < rest() && b.last - b.since >= kMilli * parameters_.enough_busy) return true;
  return is_recurrent(b) && ago < parameters_.recent && b.last - b.first >= kMilli * parameters_.enough_time;
}

RecurrentChanges::Time RecurrentChanges::begun(std::size_t block) const {
  const Block& b = blocks_[block];
  return is_recurrent(b) ? b.first : b.since;
}

}  // namespace cerberus::vision
