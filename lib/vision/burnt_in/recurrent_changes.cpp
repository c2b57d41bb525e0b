// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/recurrent_changes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cerberus::vision {

void RecurrentChanges::resize(const BlockGrid& grid) {
  blocks_.assign(grid.count(), {});
  changed_.assign(grid.count(), 0);
  bits_.assign(2 * static_cast<std::size_t>(grid.words), 0);
  grid_ = grid;
}

void RecurrentChanges::reset() {
  std::fill(blocks_.begin(), blocks_.end(), Block{});
}

// Returns whether a change comes after the block's usual interval, or a few of them.
bool RecurrentChanges::keeps_time(Block& b, double seconds) const {
  const double usual = b.interval / 1000.0, slack = parameters_.jitter * period_;
  const auto is_multiple = [&](double longer, double shorter) {
    const double times = std::round(longer / shorter);
    return times >= 1 && times <= parameters_.most_multiple && std::abs(longer - times * shorter) <= slack;
  };
  const bool same = usual > 0 && (is_multiple(seconds, usual) || is_multiple(usual, seconds));
  if (!same || seconds < usual) b.interval = static_cast<std::uint16_t>(std::lround(1000 * seconds));
  return same;
}

void RecurrentChanges::set_time(double now, double period) {
  now_ = std::max<Time>(1, static_cast<Time>(std::llround(1000 * now)));
  period_ = period;
}

// A change in one or two frames counts once it was followed by rest and the next one comes, if it comes in time.
void RecurrentChanges::note(Block& b) {
  const double ago = b.last ? seconds_since(b.last) : parameters_.stale;
  if (ago >= parameters_.stale) {
    b = {now_, now_, now_, 0, 1, 0};
    return;
  }
  if (ago < parameters_.jitter * period_) {
    if (b.frames < UINT8_MAX) ++b.frames;
    if (b.frames > parameters_.change_frames) b.in_time = 0;
  } else {
    const bool rested = ago >= parameters_.rest;
    const bool at_once = b.frames <= parameters_.change_frames && rested;
    if (!at_once || !keeps_time(b, ago))
      b.in_time = 0, b.first = b.last;
    else if (b.in_time < UINT8_MAX)
      ++b.in_time;
    if (rested) b.since = now_;
    b.frames = 1;
  }
  b.last = now_;
}

bool RecurrentChanges::update(GrayView difference, int threshold) {
  int count = 0;
  for (int row = 0; row < grid_.rows; ++row)
    count += find_blocks(difference, std::max(threshold, parameters_.least_step), grid_, row, bits_,
                         changed_.data() + grid_.at(0, row));
  if (count == 0 || count >= parameters_.whole_picture * grid_.columns * grid_.rows) return false;
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
  if (ago < parameters_.rest && seconds_since(b.since) - ago >= parameters_.enough) return true;
  return is_recurrent(b) && ago < parameters_.enough && seconds_since(b.first) - ago >= parameters_.enough;
}

double RecurrentChanges::since_begin(std::size_t block) const {
  const Block& b = blocks_[block];
  if (!b.last) return std::numeric_limits<double>::infinity();
  return std::min(seconds_since(is_recurrent(b) ? b.first : b.since), parameters_.stale);
}

double RecurrentChanges::since_change(std::size_t block) const {
  const Block& b = blocks_[block];
  return b.last ? seconds_since(b.last) : std::numeric_limits<double>::infinity();
}

}  // namespace cerberus::vision
