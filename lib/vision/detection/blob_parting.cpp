// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/blob_parting.h"

#include <algorithm>
#include <numeric>

#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

// Counts in each column the foreground pixels of the blob for which counts(x, y) is true.
template <typename Counts>
void project(const Component& blob, std::size_t self, std::span<const Run> runs, BitView moving,
             std::vector<std::uint16_t>& columns, Counts&& counts) {
  columns.assign(static_cast<std::size_t>(blob.right), 0);
  for_runs(blob, self, runs, [&](const Run& run) {
    for_bits(moving.row(run.row), run.first, run.end,
             [&](int x) { columns[x] = static_cast<std::uint16_t>(columns[x] + counts(x, run.row)); });
  });
}

}  // namespace

void BlobParting::preallocate(int width) {
  for (std::vector<std::uint16_t>* columns : {&moving_, &changed_})
    vision::preallocate(*columns, static_cast<std::size_t>(width));
  vision::preallocate(valleys_, kMostValleys);
}

std::size_t BlobParting::bytes() const {
  return bytes_of(moving_) + bytes_of(changed_) + bytes_of(valleys_);
}

// The first stretch of columns with the least foreground.
BlobParting::Columns BlobParting::emptiest(Columns between) const {
  const auto first = moving_.begin() + between.from, end = moving_.begin() + between.to;
  const auto from = std::min_element(first, end);
  const auto to = std::find_if(from, end, [&](int pixels) { return pixels != *from; });
  return {static_cast<int>(from - moving_.begin()), static_cast<int>(to - moving_.begin())};
}

void BlobParting::find_valleys(const Component& blob) {
  valleys_.clear();
  int behind = blob.right;  // the column behind the last one through a trunk
  for (int x = blob.left; x < blob.right && valleys_.size() < kMostValleys; ++x) {
    if (moving_[x] < parameters_.trunk * blob.height()) continue;
    if (x > behind) {
      const Columns valley = emptiest({behind, x});
      if (moving_[valley.from] <= parameters_.valley * blob.height()) valleys_.push_back(valley);
    }
    behind = x + 1;
  }
}

bool BlobParting::changes(Columns columns) const {
  const auto sum = [&](const std::vector<std::uint16_t>& of) {
    return std::accumulate(of.begin() + columns.from, of.begin() + columns.to, 0);
  };
  return sum(changed_) >= parameters_.changed * sum(moving_);
}

// Joins each part that rests to a neighbour: where there are two, across the fuller valley.
void BlobParting::join_resting(const Component& blob) {
  const auto rests = [&](std::size_t part) {
    return !changes({part > 0 ? valleys_[part - 1].to : blob.left,
                     part < valleys_.size() ? valleys_[part].from : blob.right});
  };
  const auto fullness = [&](std::size_t valley) { return moving_[valleys_[valley].from]; };
  for (std::size_t part = 0; part <= valleys_.size() && !valleys_.empty();) {
    if (!rests(part)) {
      ++part;
      continue;
    }
    const bool leftwards = part == valleys_.size() || (part > 0 && fullness(part - 1) >= fullness(part));
    const std::size_t gone = leftwards ? part - 1 : part;
    valleys_.erase(valleys_.begin() + static_cast<std::ptrdiff_t>(gone));
    part = gone;  // which is both now
  }
}

bool BlobParting::part(const Component& blob, std::size_t self, std::span<const Run> runs, BitView moving,
                       const Change& change, MutableBitView closed) {
  if (blob.height() < parameters_.least_height) return false;
  project(blob, self, runs, moving, moving_, [](int, int) { return true; });
  find_valleys(blob);
  if (valleys_.empty()) return false;
  project(blob, self, runs, moving, changed_, [&](int x, int y) { return change.at(x, y); });
  join_resting(blob);
  for_runs(blob, self, runs, [&](const Run& run) {
    for (const Columns& valley : valleys_)
      if (run.first < valley.to && run.end > valley.from)
        clear_bits(closed.row(run.row), std::max<int>(run.first, valley.from),
                   std::min<int>(run.end, valley.to));
  });
  return !valleys_.empty();
}

}  // namespace cerberus::vision
