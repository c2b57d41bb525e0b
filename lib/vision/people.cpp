// SPDX-License-Identifier: LGPL-2.1-or-later
// The likelihood: a pixel moves with probability kCore in the middle half of a person's columns, kSide in the outer
// ones and kOutside elsewhere. A person at a place gains, for each pixel not yet explained by another, the logarithm
// of the ratio to "outside"; whoever gains less than its price is not there. (The idea of explaining foreground by
// boxes of known size: F. Fleuret et al., "Multi-camera people tracking with a probabilistic occupancy map", PAMI
// 30(2), 2008; here one camera, greedy, with all sums from one table.)
#include "vision/people.h"

#include <algorithm>
#include <cmath>

#include "vision/people_kernels.h"

namespace cerberus::vision {
namespace {

constexpr double kBodyAspect = 0.36;  // width of a walking body / its height
constexpr int kRowsOfABody = 24;      // cells a body is cut into at least, if it has as many pixels
constexpr int kUnit = 64;             // of the logarithms in people_kernels.h
constexpr double kSolid = 0.88;       // share of the boxes that moves: people leave more gaps
constexpr std::size_t kMostPeople = 12;
constexpr int kMostCells = 65535;  // both packed sums stay below 65536

// One cell carries two numbers: moving in the lower 16 bits, counted at all in the upper. Sums of up to 65535 cells,
// and differences of sums, are exact in both halves.
constexpr std::uint32_t kCounted = 0x10000, kMoving = 1;

}  // namespace

// Cells around the window, wide enough that every place a person may be judged at lies on the grid. Outside the picture
// nothing is counted; inside the picture but outside the window nothing moves.
bool PeopleFinder::lay_grid(BitView pixels, const Window& window) {
  const double tallest = prior_->height(window.bottom);
  if (tallest <= 0) return false;
  step_ = std::max(1, static_cast<int>(tallest / kRowsOfABody));
  const int around = static_cast<int>(kBodyAspect * tallest) + 2 * step_;
  const int above = static_cast<int>(0.7 * tallest);
  const int below = window.bottom >= picture_.height ? static_cast<int>(0.6 * tallest) : 2 * step_;
  x0_ = window.left - around;
  y0_ = window.top - above;
  columns_ = (window.width() + 2 * around + step_ - 1) / step_;
  rows_ = (window.height() + above + below + step_ - 1) / step_;
  if (static_cast<long>(columns_) * rows_ > kMostCells) return false;
  const auto cell = [&](int pixel, int origin) { return (pixel - origin + step_ - 1) / step_; };
  inside_ = {std::clamp(cell(0, x0_), 0, columns_), std::clamp(cell(0, y0_), 0, rows_),
             std::clamp(cell(picture_.width, x0_), 0, columns_),
             std::clamp(cell(picture_.height, y0_), 0, rows_)};
  window_ = {cell(window.left, x0_), cell(window.top, y0_), std::min(cell(window.right, x0_), columns_),
             std::min(cell(window.bottom, y0_), rows_)};
  cells_.assign(static_cast<std::size_t>(columns_) * rows_, 0);
  for (int r = inside_.top; r < inside_.bottom; ++r)
    std::fill_n(&cells_[static_cast<std::size_t>(r) * columns_ + inside_.left], inside_.width(), kCounted);
  // A cell moves when at least half of its pixels do (of one pixel: when it does).
  const int half = std::max(1, step_ * step_ / 2);
  for (int r = window_.top; r < window_.bottom; ++r)
    for (int c = window_.left; c < window_.right; ++c) {
      int moving = 0;
      for (int y = std::max(window.top, y0_ + r * step_); y < std::min(window.bottom, y0_ + (r + 1) * step_);
           ++y)
        for (int x = std::max(window.left, x0_ + c * step_);
             x < std::min(window.right, x0_ + (c + 1) * step_); ++x)
          moving += static_cast<int>(pixels.row(y)[x / 64] >> (x % 64) & 1);
      if (moving >= half) cells_[static_cast<std::size_t>(r) * columns_ + c] |= kMoving;
    }
  shapes_.assign(static_cast<std::size_t>(rows_) + 1, {});
  for (int r = 0; r <= rows_; ++r) {
    const double height = prior_->height(y0_ + r * step_) / step_;
    if (height > 0)
      shapes_[r] = {std::max(2, static_cast<int>(std::lround(height))),
                    std::max(1, static_cast<int>(std::lround(kBodyAspect * height)))};
  }
  scores_.resize(static_cast<std::size_t>(columns_) + 1);
  return true;
}

// From this row of cells down; what is above has not changed.
void PeopleFinder::add_up(int from) {
  const int pitch = columns_ + 1;
  sums_.resize(static_cast<std::size_t>(pitch) * (rows_ + 1));
  std::fill_n(sums_.begin(), pitch, 0u);
  for (int r = from; r < rows_; ++r) {
    const std::uint32_t* cells = &left_[static_cast<std::size_t>(r) * columns_];
    const std::uint32_t* above = &sums_[static_cast<std::size_t>(r) * pitch];
    std::uint32_t* here = &sums_[static_cast<std::size_t>(r + 1) * pitch];
    std::uint32_t row = here[0] = 0;
    for (int c = 0; c < columns_; ++c) {
      row += cells[c];
      here[c + 1] = above[c + 1] + row;
    }
  }
}

std::uint32_t PeopleFinder::sum(int left, int top, int right, int bottom) const {
  const std::size_t pitch = static_cast<std::size_t>(columns_) + 1;
  const std::uint32_t* t = &sums_[top * pitch];
  const std::uint32_t* b = &sums_[bottom * pitch];
  return b[right] - b[left] - t[right] + t[left];
}

// The best place for one more person whose left edge lies in [from, to). Score 0: nowhere. With an anchor, a column,
// what stays unexplained between it and the box is taken for lost and counts against the place.
PeopleFinder::Candidate PeopleFinder::best(int from, int to, int anchor) {
  Candidate best;
  int best_value = 0;
  const std::size_t pitch = static_cast<std::size_t>(columns_) + 1;
  const std::uint32_t* whole = &sums_[static_cast<std::size_t>(window_.bottom) * pitch];
  for (int foot = rows_; foot > window_.top; --foot) {
    const auto [h, w] = shapes_[foot];
    if (h == 0 || foot - h < 0) continue;
    if (foot - window_.top < 0.4 * h) break;
    // A third of the body at least is in the picture.
    const int q = w / 4, first = std::max({from, 0, inside_.left - w + (w + 2) / 3});
    const int end = std::min({to, columns_ - w + 1, inside_.right - (w + 2) / 3 + 1});
    if (first >= end) continue;
    const int high = std::min(foot, inside_.bottom) - std::max(foot - h, inside_.top);
    const BoxRow row{
        &sums_[(foot - h) * pitch], &sums_[foot * pitch], w, q, inside_.left, inside_.right, high};
    int* scores = scores_.data();
    int highest = score_boxes(row, first, end, scores);
    if (highest <= best_value) continue;
    const auto lost = [&](int l) {
      return anchor >= 0 && l > anchor ? static_cast<int>((whole[l] - whole[anchor]) & 0xffff) * kSideMoving
                                       : 0;
    };
    if (anchor >= 0) {
      for (int l = first; l < end; ++l) scores[l] -= lost(l);
      highest = *std::max_element(scores + first, scores + end);
      if (highest <= best_value) continue;
    }
    best_value = highest;
    const int l = static_cast<int>(std::find(scores + first, scores + end, highest) - scores);
    const int score = highest + lost(l), seen = row.columns(l) * high;
    best = {l, foot - h, l + w, foot, score, score / std::max(seen, 1) + kPrice};
  }
  return best;
}

// What lies in the box is explained: it counts for nobody else.
void PeopleFinder::take(const Candidate& c) {
  for (int r = c.top; r < c.bottom; ++r)
    std::fill(&left_[static_cast<std::size_t>(r) * columns_ + c.left],
              &left_[static_cast<std::size_t>(r) * columns_ + c.right], 0u);
  add_up(c.top);
}

// Takes people one after another, the best first or always the leftmost one, and returns what is gained in all.
int PeopleFinder::explain(bool from_the_left) {
  chosen_.clear();
  left_ = cells_;
  add_up(0);
  const int width = std::max(1, shapes_[std::min(window_.bottom, rows_)].width);
  int total = 0, edge = window_.left;
  const auto [height, body] = shapes_[std::min(window_.bottom, rows_)];
  while (chosen_.size() < kMostPeople) {
    // What is left may be too little to pay for a third of a person.
    const int moving = sum(0, 0, columns_, rows_) & 0xffff;
    if (moving * kCoreMoving < kPrice * height * body / 3) break;
    Candidate c;
    if (from_the_left) {
      // The leftmost column that still holds something decides; a person's edge is near it.
      while (edge < window_.right && (sum(edge, window_.top, edge + 1, window_.bottom) & 0xffff) == 0) ++edge;
      if (edge >= window_.right) break;
      c = best(edge - width / 3, edge + width / 3 + 1, edge);
      if (c.score <= 0) {
        edge += std::max(1, width / 4);
        continue;
      }
    } else {
      c = best(0, window_.right, -1);
      if (c.score <= 0) break;
    }
    total += c.score;
    chosen_.push_back(c);
    take(c);
  }
  return total;
}

// Each in turn may move, given the others.
void PeopleFinder::settle() {
  const std::size_t n = chosen_.size();
  for (std::size_t i = 0; i < n && n > 1; ++i) {
    const Candidate old = chosen_.front();
    chosen_.erase(chosen_.begin());
    left_ = cells_;
    for (const Candidate& c : chosen_)
      for (int r = c.top; r < c.bottom; ++r)
        std::fill(&left_[static_cast<std::size_t>(r) * columns_ + c.left],
                  &left_[static_cast<std::size_t>(r) * columns_ + c.right], 0u);
    add_up(0);
    const int w = old.right - old.left;
    const Candidate c = best(old.left - w / 2, old.left + w / 2 + 1, -1);
    if (c.score > 0) chosen_.push_back(c);
  }
}

// Share of the cells in the chosen boxes that move.
double PeopleFinder::filled() {
  left_ = cells_;
  int moving = 0, all = 0;
  for (const Candidate& c : chosen_)
    for (int r = c.top; r < c.bottom; ++r)
      for (int x = c.left; x < c.right; ++x) {
        std::uint32_t& cell = left_[static_cast<std::size_t>(r) * columns_ + x];
        all += cell != 0;
        moving += (cell & kMoving) != 0;
        cell = 0;
      }
  return all > 0 ? static_cast<double>(moving) / all : 0;
}

std::span<const Person> PeopleFinder::find(BitView pixels, Size picture, const Window& window,
                                           const HeightPrior& prior) {
  people_.clear();
  picture_ = picture;
  prior_ = &prior;
  if (!lay_grid(pixels, window)) return people_;
  // The leftmost first is right for people side by side, where the best first may stand in their middle; the best first
  // is right for people behind one another.
  const int best_first = explain(false);
  if (chosen_.size() > 1 || window_.width() > 1.3 * shapes_[window_.bottom].width) {
    std::swap(chosen_, other_);
    if (explain(true) <= best_first) std::swap(chosen_, other_);
    settle();
  }
  // Three or more without a gap between heads, arms and legs are not people but a block: a car, a door.
  if (chosen_.size() > 2 && filled() > kSolid) return people_;
  for (const Candidate& c : chosen_)
    people_.push_back(
        {{static_cast<double>(x0_ + c.left * step_), static_cast<double>(y0_ + c.top * step_),
          static_cast<double>((c.right - c.left) * step_), static_cast<double>((c.bottom - c.top) * step_)},
         static_cast<double>(c.gain) / kUnit});
  return people_;
}

}  // namespace cerberus::vision
