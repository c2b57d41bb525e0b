// SPDX-License-Identifier: LGPL-2.1-or-later
// The likelihood: a pixel is foreground with one probability in the middle half of a person's columns, with a lower one
// in the outer ones and with hardly any elsewhere (people_kernels.h). A person at a place gains, for each pixel not yet
// explained by another, the logarithm of the ratio to "elsewhere"; a gain below the price of a person is none. (The idea of explaining foreground by boxes of known size: F. Fleuret et al., "Multi-camera people tracking with a
// probabilistic occupancy map", PAMI 30(2), 2008; here one camera, greedy, with all sums from one table.)
#include "vision/detection/people.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vision/detection/people_kernels.h"
#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

constexpr int kUnit = 64;          // of the logarithms in people_kernels.h
constexpr int kMostCells = 16384;  // in a grid; both packed sums stay below 65536

}  // namespace

void PeopleFinder::preallocate(Size picture) {
  picture_ = picture;
  // Cells of one pixel are used for people below 2 parameters_.cells pixels: around the picture there are then at most
  // so many columns and rows, and fewer cells at every larger step.
  const int tallest = 2 * parameters_.cells;
  const auto columns = static_cast<std::size_t>(picture.width + 2 * (parameters_.aspect * tallest + 2));
  const auto rows = static_cast<std::size_t>(picture.height + parameters_.tallest * tallest + 2);
  vision::preallocate(shapes_, rows + 1);
  for (auto* sums : {&moving_, &band_, &sums_}) vision::preallocate(*sums, columns + 1);
  vision::preallocate(scores_, columns + 1);
  vision::preallocate(chosen_, kMostPeople);
  vision::preallocate(other_, kMostPeople);
  vision::preallocate(people_, kMostPeople);
}

std::size_t PeopleFinder::bytes() const {
  return bytes_of(shapes_) + bytes_of(moving_) + bytes_of(band_) + bytes_of(sums_) + bytes_of(scores_) +
         bytes_of(chosen_) + bytes_of(other_) + bytes_of(people_);
}

// Cells around the window, wide enough for every position that is scored. Outside the picture no cell is counted; inside
// the picture but outside the window no cell is foreground.
bool PeopleFinder::lay_grid(BitView pixels, const Bounds& window, std::span<std::uint8_t> room) {
  const double tallest = prior_->height(window.bottom);
  if (tallest <= 0) return false;
  // A crowd all across the picture gets larger cells.
  for (step_ = std::max(1, static_cast<int>(tallest / parameters_.cells));; ++step_) {
    const int around = static_cast<int>(parameters_.aspect * tallest) + 2 * step_;
    const int above = static_cast<int>(parameters_.above * tallest);
    const int below =
        window.bottom >= picture_.height ? static_cast<int>(parameters_.below * tallest) : 2 * step_;
    x0_ = window.left - around;
    y0_ = window.top - above;
    columns_ = (window.width() + 2 * around + step_ - 1) / step_;
    rows_ = (window.height() + above + below + step_ - 1) / step_;
    if (static_cast<std::size_t>(columns_) * rows_ <= room.size()) break;
  }
  const auto cell = [&](int pixel, int origin) { return (pixel - origin + step_ - 1) / step_; };
  inside_ = {std::clamp(cell(0, x0_), 0, columns_), std::clamp(cell(0, y0_), 0, rows_),
             std::clamp(cell(picture_.width, x0_), 0, columns_),
             std::clamp(cell(picture_.height, y0_), 0, rows_)};
  // The window may begin and end within a cell, which belongs to it as far as it is in the picture.
  window_ = {std::max((window.left - x0_) / step_, inside_.left),
             std::max((window.top - y0_) / step_, inside_.top), std::min(cell(window.right, x0_), columns_),
             std::min(cell(window.bottom, y0_), rows_)};
  cells_ = room.first(static_cast<std::size_t>(columns_) * rows_);
  std::ranges::fill(cells_, std::uint8_t{0});
  for (int r = inside_.top; r < inside_.bottom; ++r)
    std::fill_n(cells(r) + inside_.left, inside_.width(), kCellCounted);
  // A cell is foreground when at least half of its pixels are (of one pixel: when it is).
  const int half = std::max(1, step_ * step_ / 2);
  std::vector<std::uint32_t>& moving = band_;  // not in use yet
  for (int r = window_.top; r < window_.bottom; ++r) {
    moving.assign(static_cast<std::size_t>(columns_), 0);
    const int top = std::max(window.top, y0_ + r * step_),
              bottom = std::min(window.bottom, y0_ + (r + 1) * step_);
    for (int y = top; y < bottom; ++y)
      for_bits(pixels.row(y), window.left, window.right, [&](int x) { ++moving[(x - x0_) / step_]; });
    for (int c = window_.left; c < window_.right; ++c)
      if (static_cast<int>(moving[c]) >= half) cells(r)[c] |= kCellMoving;
  }
  shapes_.assign(static_cast<std::size_t>(rows_) + 1, {});
  for (int r = 0; r <= rows_; ++r) {
    const double height = prior_->height(y0_ + r * step_) / step_;
    if (height > 0)
      shapes_[r] = {std::max(2, static_cast<int>(std::lround(height))),
                    std::max(1, static_cast<int>(std::lround(parameters_.aspect * height)))};
  }
  for (auto* sums : {&moving_, &band_, &sums_}) sums->resize(static_cast<std::size_t>(columns_) + 1);
  scores_.resize(static_cast<std::size_t>(columns_) + 1);
  return true;
}

void PeopleFinder::clear_explained() {
  for (std::uint8_t& cell : cells_) cell &= static_cast<std::uint8_t>(~kCellExplained);
}

// The cells of the box are explained: they count for no other person.
void PeopleFinder::mark_explained(const Candidate& c) {
  for (int r = c.top; r < c.bottom; ++r)
    for (int x = c.left; x < c.right; ++x) cells(r)[x] |= kCellExplained;
}

// After every change of what is explained.
void PeopleFinder::add_up_window() {
  std::fill(band_.begin(), band_.end(), 0u);
  for (int r = window_.top; r < window_.bottom; ++r) add_cells(cells(r), columns_, band_.data());
  moving_[0] = 0;
  for (int c = 0; c < columns_; ++c) moving_[c + 1] = moving_[c] + (band_[c] & 0xffff);
  band_top_ = window_.top;
  band_bottom_ = window_.bottom;
}

// Moves the band to these rows and sums its columns [left, right) up.
void PeopleFinder::slide(int top, int bottom, int left, int right) {
  while (band_bottom_ < bottom) add_cells(cells(band_bottom_++), columns_, band_.data());
  while (band_top_ > top) add_cells(cells(--band_top_), columns_, band_.data());
  while (band_bottom_ > bottom) subtract_cells(cells(--band_bottom_), columns_, band_.data());
  while (band_top_ < top) subtract_cells(cells(band_top_++), columns_, band_.data());
  std::uint32_t sum = sums_[left] = 0;
  for (int c = left; c < right; ++c) sums_[c + 1] = sum += band_[c];
}

// The best position for one more person whose left edge lies in [from, to). Score 0: none. With an anchor, a column,
// the foreground that stays unexplained between it and the box counts against the position.
PeopleFinder::Candidate PeopleFinder::best(int from, int to, int anchor) {
  Candidate best;
  int best_value = 0;
  for (int foot = rows_; foot > window_.top; --foot) {
    const auto [h, w] = shapes_[foot];
    if (h == 0 || foot - h < 0) continue;
    if (foot - window_.top < parameters_.least_feet * h) break;
    const int q = w / parameters_.side_part, part = (w + parameters_.least_part - 1) / parameters_.least_part;
    const int first = std::max({from, 0, inside_.left - w + part});
    const int end = std::min({to, columns_ - w + 1, inside_.right - part + 1});
    if (first >= end) continue;
    const int high = std::min(foot, inside_.bottom) - std::max(foot - h, inside_.top);
    slide(foot - h, foot, first, end - 1 + w);
    const BoxRow row{sums_.data(), w, q, inside_.left, inside_.right, high};
    int* scores = scores_.data();
    int highest = score_boxes(row, first, end, scores);
    if (highest <= best_value) continue;
    const auto lost = [&](int l) {
      return anchor >= 0 && l > anchor ? static_cast<int>(moving_[l] - moving_[anchor]) * kSideMoving : 0;
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

// Chooses people one after another, the best first or always the leftmost one, and returns the total gain.
int PeopleFinder::explain(bool from_the_left) {
  chosen_.clear();
  clear_explained();
  add_up_window();
  const int width = std::max(1, shapes_[std::min(window_.bottom, rows_)].width);
  int total = 0, edge = window_.left;
  const auto [height, body] = shapes_[std::min(window_.bottom, rows_)];
  while (chosen_.size() < kMostPeople) {
    // The rest may be too little for the price of the least part of a person.
    const auto moving = static_cast<int>(moving_[columns_]);
    if (moving * kCoreMoving < kPrice * height * body / parameters_.least_part) break;
    Candidate c;
    if (from_the_left) {
      // A person's edge is near the leftmost column with unexplained foreground.
      while (edge < window_.right && moving_[edge + 1] == moving_[edge]) ++edge;
      if (edge >= window_.right) break;
      const int reach = width / parameters_.edge_part;
      c = best(edge - reach, edge + reach + 1, edge);
      if (c.score <= 0) {
        edge += std::max(1, width / parameters_.edge_step);
        continue;
      }
    } else {
      c = best(0, window_.right, -1);
      if (c.score <= 0) break;
    }
    total += c.score;
    chosen_.push_back(c);
    mark_explained(c);
    add_up_window();
  }
  return total;
}

// Moves each person in turn, given the others.
void PeopleFinder::settle() {
  const std::size_t n = chosen_.size();
  for (std::size_t i = 0; i < n && n > 1; ++i) {
    const Candidate old = chosen_.front();
    chosen_.erase(chosen_.begin());
    clear_explained();
    for (const Candidate& c : chosen_) mark_explained(c);
    add_up_window();
    const int w = old.right - old.left;
    const Candidate c = best(old.left - w / 2, old.left + w / 2 + 1, -1);
    if (c.score > 0) chosen_.push_back(c);
  }
}

// Share of the cells in the chosen boxes that are foreground.
double PeopleFinder::filled() {
  clear_explained();
  int moving = 0, all = 0;
  for (const Candidate& c : chosen_)
    for (int r = c.top; r < c.bottom; ++r)
      for (int x = c.left; x < c.right; ++x) {
        std::uint8_t& cell = cells(r)[x];
        if (cell & kCellExplained) continue;
        all += cell != 0;
        moving += (cell & kCellMoving) != 0;
        cell |= kCellExplained;
      }
  return all > 0 ? static_cast<double>(moving) / all : 0;
}

// Share of gaps: background cells between the first and the last foreground cell of each row, as between heads, legs and
// neighbours. Unlike filled() it does not expect rectangles: cars are round and move aslant.
double PeopleFinder::gaps() {
  int between = 0, still = 0;
  for (int r = window_.top; r < window_.bottom; ++r) {
    const auto moves = [](std::uint8_t cell) { return (cell & kCellMoving) != 0; };
    const std::uint8_t* first = std::find_if(cells(r) + window_.left, cells(r) + window_.right, moves);
    const std::uint8_t* last = cells(r) + window_.right;
    while (last > first && !moves(last[-1])) --last;
    between += static_cast<int>(last - first);
    still += static_cast<int>(last - first - std::count_if(first, last, moves));
  }
  return between > 0 ? static_cast<double>(still) / between : 0;
}

// Is the group a car or a door, not people?
bool PeopleFinder::is_block(bool was_wide) {
  const std::size_t n = chosen_.size();
  const bool wide = n > 2 && window_.width() >= parameters_.block_width * shapes_[window_.bottom].width;
  wide_block_ = (wide && gaps() < parameters_.gaps) || (was_wide && n > 1 && gaps() < parameters_.gaps_after);
  return wide_block_ || (n > 2 && filled() > parameters_.solid);
}

void PeopleFinder::choose(bool was_wide_block) {
  // Leftmost first is right for people side by side, where the best position may be the middle between two; best first is
  // right for people behind one another.
  const int best_first = explain(false);
  if (chosen_.size() > 1 || window_.width() > parameters_.one_wide * shapes_[window_.bottom].width) {
    std::swap(chosen_, other_);
    if (explain(true) <= best_first) std::swap(chosen_, other_);
    settle();
  }
  if (is_block(was_wide_block)) return;
  for (const Candidate& c : chosen_)
    people_.push_back(
        {{static_cast<double>(x0_ + c.left * step_), static_cast<double>(y0_ + c.top * step_),
          static_cast<double>((c.right - c.left) * step_), static_cast<double>((c.bottom - c.top) * step_)},
         static_cast<double>(c.gain) / kUnit});
}

std::span<const Person> PeopleFinder::find(BitView pixels, const Bounds& window, const HeightPrior& prior,
                                           bool was_wide_block) {
  people_.clear();
  wide_block_ = false;
  prior_ = &prior;
  std::array<std::uint8_t, kMostCells> room;
  if (lay_grid(pixels, window, room)) choose(was_wide_block);
  cells_ = {};
  return people_;
}

}  // namespace cerberus::vision
