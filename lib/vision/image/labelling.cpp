// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/labelling.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "vision/image/morphology.h"
#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();

// Limits of one run for 32 pixels and one component for 256: at 320x240, ten runs a row and 300 components. There is
// room for at least one run a row, because opening cannot reduce a row below one run.
Labeller::Limits usual_limits(Size picture) {
  const auto area = static_cast<std::size_t>(picture.area()), rows = static_cast<std::size_t>(picture.height);
  return {std::min(std::max<std::size_t>({area / 32, rows, 256}), kMost),
          std::clamp<std::size_t>(area / 256, 64, kMost)};
}

// Returns the first column from x on whose bit is set (or clear), 64 * words if there is none.
template <bool set>
int search(const std::uint64_t* row, int words, int x) {
  for (int i = x / 64, skip = x % 64; i < words; ++i, skip = 0) {
    const std::uint64_t wanted = (set ? row[i] : ~row[i]) >> skip << skip;
    if (wanted) return 64 * i + std::countr_zero(wanted);
  }
  return 64 * words;
}

}  // namespace

void Labeller::preallocate(Size picture) {
  if (picture == size_) return;
  limits_ = fixed_ ? *fixed_ : usual_limits(picture);
  vision::preallocate(runs_, limits_.runs);
  vision::preallocate(forest_, limits_.runs);
  vision::preallocate(components_, limits_.components);
  size_ = picture;  // assigned last: after a failed allocation the next call tries again
}

std::int32_t Labeller::root(std::int32_t i) {
  while (forest_[i] >= 0) {
    if (forest_[forest_[i]] >= 0) forest_[i] = forest_[forest_[i]];  // path halving
    i = forest_[i];
  }
  return i;
}

// Appends the runs of one row. Returns false when there would be more than `most` runs.
bool Labeller::cut_row(const std::uint64_t* row, int words, int y, std::size_t most) {
  const int width = 64 * words;
  for (int x = search<true>(row, words, 0); x < width; x = search<true>(row, words, x)) {
    if (runs_.size() == most) return false;
    const int end = search<false>(row, words, x);
    runs_.push_back(
        {static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(end), 0});
    forest_.push_back(x - end);
    x = end;
  }
  return true;
}

bool Labeller::cut(BitView bits, std::size_t most) {
  runs_.clear();
  forest_.clear();
  std::size_t above = 0;
  for (int y = 0; y < bits.height; ++y) {
    const std::size_t here = runs_.size();
    if (!cut_row(bits.row(y), bits.width, y, most)) return false;
    join_rows(above, here, runs_.size());
    above = here;
  }
  return true;
}

// Joins the runs [here, end) of this row with the runs [above, here) of the row above; both are sorted by column. Two
// runs touch, diagonals included, when first <= other.end and other.first <= end (ends are exclusive).
void Labeller::join_rows(std::size_t above, std::size_t here, std::size_t end) {
  std::size_t a = above;
  for (std::size_t b = here; b < end; ++b) {
    while (a < here && runs_[a].end < runs_[b].first) ++a;
    for (std::size_t i = a; i < here && runs_[i].first <= runs_[b].end; ++i) {
      const std::int32_t p = root(static_cast<std::int32_t>(i)), q = root(static_cast<std::int32_t>(b));
      if (p == q) continue;
      const auto [early, late] = std::minmax(p, q);
      forest_[early] += forest_[late];
      forest_[late] = early;
    }
  }
}

std::span<const Component> Labeller::find(MutableBitView bits, int width, std::uint32_t least) {
  preallocate({width, bits.height});
  Morphology morphology;  // opening needs no memory of its own
  for (int side = 3; !cut(bits, side < 2 * width ? limits_.runs : kMost * kMost); side += 2)
    morphology.open(bits, width, side);
  components_.clear();

  const auto area = [&](std::size_t i) {
    return forest_[i] < 0 ? static_cast<std::uint32_t>(-forest_[i]) : 0;
  };
  const auto fits = [&] {
    std::size_t n = 0;
    for (std::size_t i = 0; i < forest_.size(); ++i) n += area(i) >= least;
    return n <= limits_.components;
  };
  for (least = std::max(least, 1u); !fits(); least *= 2) {
  }

  // A root is the first run of its component, so the loop meets it before the others and numbers the components in
  // reading order. The component's number then replaces the area in the forest, which is no longer needed.
  constexpr std::int32_t gone = std::numeric_limits<std::int32_t>::min();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < forest_.size(); ++i) {
    Run run = runs_[i];
    const std::int32_t r = root(static_cast<std::int32_t>(i));
    if (static_cast<std::size_t>(r) == i) {
      const std::uint32_t pixels = area(i);
      forest_[i] = pixels < least ? gone : -1 - static_cast<std::int32_t>(components_.size());
      if (pixels >= least) components_.push_back({run.first, run.row, run.end, run.row + 1, pixels});
    }
    if (forest_[r] == gone) {
      clear_bits(bits.row(run.row), run.first, run.end);
      continue;
    }
    run.component = static_cast<std::uint16_t>(-1 - forest_[r]);
    Component& c = components_[run.component];
    c.left = std::min<int>(c.left, run.first);
    c.right = std::max<int>(c.right, run.end);
    c.bottom = run.row + 1;
    runs_[kept++] = run;
  }
  runs_.resize(kept);
  return components_;
}

void Labeller::write(View<std::uint16_t> labels) const {
  for (int y = 0; y < labels.height; ++y)
    std::memset(labels.row(y), 0, static_cast<std::size_t>(labels.width) * sizeof(std::uint16_t));
  for (const Run& run : runs_)
    std::fill(labels.row(run.row) + run.first, labels.row(run.row) + run.end,
              static_cast<std::uint16_t>(run.component + 1));
}

std::size_t Labeller::bytes() const {
  return bytes_of(runs_) + bytes_of(forest_) + bytes_of(components_);
}

}  // namespace cerberus::vision
