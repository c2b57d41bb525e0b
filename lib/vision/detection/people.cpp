// SPDX-License-Identifier: LGPL-2.1-or-later
// The likelihood: a pixel is foreground with a probability for its place in a body, and with a low one elsewhere. A
// person at a place gains, for each pixel not yet explained by another, the logarithm of the ratio of the two; a gain
// below the price of a person is none. (The idea of explaining foreground by shapes of known size: F. Fleuret et al.,
// "Multi-camera people tracking with a probabilistic occupancy map", PAMI 30(2), 2008; here one camera, greedy, with
// all sums from one table.)
#include "vision/detection/people.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <numbers>

#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

constexpr int kUnit = 64;         // of the logarithms
constexpr int kMostCells = 8192;  // in a grid with its sums
static_assert(kMostCells <= kMostSummed);

// Halves away from 0. Inline, unlike std::lround().
int whole(double value) {
  return static_cast<int>(value + (value < 0 ? -0.5 : 0.5));
}

// What a cell adds to the sums, by its flags.
constexpr std::array<std::uint32_t, 2 * kCellExplained> kCarried = [] {
  std::array<std::uint32_t, 2 * kCellExplained> carried{};
  for (std::uint32_t cell = 0; cell < kCellExplained; ++cell)
    carried[cell] = (cell & kCellMoving ? kMoving : 0) + (cell & kCellCounted ? kCounted : 0);
  return carried;
}();

}  // namespace

PeopleFinder::PeopleFinder(const Parameters& parameters) : parameters_(parameters) {
  const Parameters& q = parameters_;
  const Part parts[] = {q.free_space, q.body[0], q.body[1], q.body[2]};
  static_assert(std::size(parts) == kBodyBands);
  const auto gain = [&](double p, double price) {
    return whole(kUnit * (std::log(p / q.elsewhere) - price));
  };
  const auto loss = [&](double p, double price) {
    return whole(kUnit * (std::log((1 - p) / (1 - q.elsewhere)) - price));
  };
  for (std::size_t i = 0; i < kBodyBands; ++i) {
    const Part& p = parts[i];
    const double price = i == 0 ? 0 : q.price;
    bands_[i].core_moving = gain(p.core_moving, price);
    bands_[i].core_still = loss(p.core_moving, price);
    bands_[i].side_moving = gain(p.side_moving, price);
    bands_[i].side_still = loss(p.side_moving, price);
    for (int h = 0; h <= kTallest; ++h) {
      const auto cells = [&](double heights) { return static_cast<std::int16_t>(whole(heights * h)); };
      bodies_[static_cast<std::size_t>(h)][i] = {cells(p.top), cells(p.bottom), cells(p.core),
                                                 cells(p.reach)};
    }
  }
  const auto scale = [](double factor) { return Scale{factor, std::log(factor)}; };
  for (std::size_t i = 0; i < scales_.size(); ++i) {
    const double steps = static_cast<double>((i + 1) / 2) * q.other_height;
    scales_[i] = scale(i % 2 == 0 ? 1 + steps : 1 - steps);
  }
  for (std::size_t i = 0; i < unknown_scales_.size(); ++i)
    unknown_scales_[i] = scale(1 - static_cast<double>(i) * q.unknown_step);
}

void PeopleFinder::preallocate(Size picture) {
  picture_ = picture;
  // Cells of one pixel are used for people of up to parameters_.cells pixels: around the picture there are then at most
  // so many columns and rows, and fewer cells at every larger step.
  const int tallest = 2 * parameters_.cells;
  const auto columns = static_cast<std::size_t>(picture.width + 2 * (parameters_.aspect * tallest + 2));
  const auto rows =
      static_cast<std::size_t>(picture.height + (parameters_.above + parameters_.below) * tallest + 2);
  vision::preallocate(shapes_, rows + 1);
  vision::preallocate(scores_, columns + 1);
  vision::preallocate(chosen_, kMostPeople);
  vision::preallocate(other_, kMostPeople);
  vision::preallocate(people_, kMostPeople);
}

std::size_t PeopleFinder::bytes() const {
  return bytes_of(shapes_) + bytes_of(scores_) + bytes_of(chosen_) + bytes_of(other_) + bytes_of(people_);
}

// Cells around the window, wide enough for every position that is scored. Outside the picture no cell is counted; inside
// the picture but outside the window no cell is foreground.
void PeopleFinder::lay_grid(BitView pixels, const Bounds& window, double tallest) {
  // A crowd all across the picture gets larger cells.
  for (step_ = std::max(1, static_cast<int>(std::ceil(tallest / parameters_.cells)));; ++step_) {
    const int around = static_cast<int>(parameters_.aspect * tallest) + 2 * step_;
    const int above = static_cast<int>(parameters_.above * tallest);
    const int below =
        window.bottom >= picture_.height ? static_cast<int>(parameters_.below * tallest) : 2 * step_;
    x0_ = window.left - around;
    y0_ = window.top - above;
    columns_ = (window.width() + 2 * around + step_ - 1) / step_;
    rows_ = (window.height() + above + below + step_ - 1) / step_;
    if ((static_cast<std::size_t>(columns_) + 1) * (rows_ + 1) <= kMostCells) break;
  }
  const auto cell = [&](int pixel, int origin) { return (pixel - origin + step_ - 1) / step_; };
  inside_ = {std::clamp(cell(0, x0_), 0, columns_), std::clamp(cell(0, y0_), 0, rows_),
             std::clamp(cell(picture_.width, x0_), 0, columns_),
             std::clamp(cell(picture_.height, y0_), 0, rows_)};
  // The window may begin and end within a cell, which belongs to it as far as it is in the picture.
  window_ = {std::max((window.left - x0_) / step_, inside_.left),
             std::max((window.top - y0_) / step_, inside_.top), std::min(cell(window.right, x0_), columns_),
             std::min(cell(window.bottom, y0_), rows_)};
  cells_ = cells_.first(static_cast<std::size_t>(columns_) * rows_);
  std::ranges::fill(cells_, std::uint8_t{0});
  for (int r = inside_.top; r < inside_.bottom; ++r)
    std::fill_n(cells(r) + inside_.left, inside_.width(), kCellCounted);
  // A cell is foreground when at least half of its pixels are (of one pixel: when it is).
  const int half = std::max(1, step_ * step_ / 2);
  const std::uint64_t inverse =
      (std::uint64_t{1} << 32) / static_cast<unsigned>(step_) + 1;      // of step_, rounded up
  const auto moving = sums_.first(static_cast<std::size_t>(columns_));  // not in use yet
  for (int r = window_.top; r < window_.bottom; ++r) {
    std::ranges::fill(moving, 0u);
    const int top = std::max(window.top, y0_ + r * step_),
              bottom = std::min(window.bottom, y0_ + (r + 1) * step_);
    for (int y = top; y < bottom; ++y)
      for_bits(pixels.row(y), window.left, window.right,
               [&](int x) { ++moving[static_cast<std::uint64_t>(x - x0_) * inverse >> 32]; });
    for (int c = window_.left; c < window_.right; ++c)
      if (static_cast<int>(moving[c]) >= half) cells(r)[c] |= kCellMoving;
  }
  shapes_.assign(static_cast<std::size_t>(rows_) + 1, {});
  explained_from_ = rows_;
  summed_to_ = 0;
  largest_spread_ = 0;
  for (int r = 0; r <= rows_; ++r) {
    const double height = (height_known_ ? prior_->height(y0_ + r * step_) : tallest) / step_;
    if (!(height > 0)) continue;
    const double doubt = height_known_ ? prior_->uncertainty(y0_ + r * step_) : 0;
    const double spread = height_known_ ? std::sqrt(parameters_.spread * parameters_.spread + doubt * doubt)
                                        : parameters_.unknown_spread;
    shapes_[r] = {std::max(2, whole(height)), std::max(1, whole(parameters_.aspect * height)),
                  static_cast<float>(spread)};
    largest_spread_ = std::max(largest_spread_, shapes_[r].spread);
  }
  scores_.resize(static_cast<std::size_t>(columns_) + 1);
}

void PeopleFinder::clear_explained() {
  for (std::uint8_t& cell : cells_.subspan(static_cast<std::size_t>(explained_from_) * columns_))
    cell &= static_cast<std::uint8_t>(~kCellExplained);
  summed_to_ = std::min(summed_to_, explained_from_);
  explained_from_ = rows_;
}

// The cells of the body are explained: they count for no other person. Those beside the head are not: a person behind may
// be seen there.
void PeopleFinder::mark_explained(const Candidate& c) {
  const Body& body = bodies_[static_cast<std::size_t>(c.bottom - c.top)];
  const int from = std::max(0, c.top);
  explained_from_ = std::min(explained_from_, from);
  summed_to_ = std::min(summed_to_, from);
  for (std::size_t i = 1; i < kBodyBands; ++i) {
    const Rows& part = body[i];
    const int reach = i == 1 ? part.core : part.reach;
    const int left = std::max(0, c.axis - reach), right = std::min(columns_, c.axis + reach);
    for (int r = std::max(0, c.top + part.top); r < std::min(rows_, c.top + part.bottom); ++r)
      for (int x = left; x < right; ++x) cells(r)[x] |= kCellExplained;
  }
}

// After every change of what is explained.
void PeopleFinder::add_up() {
  const std::size_t stride = static_cast<std::size_t>(columns_) + 1;
  if (summed_to_ == 0) std::fill_n(sums_.begin(), stride, 0u);
  for (int r = summed_to_; r < rows_; ++r) {
    const std::uint32_t* above = sums(r);
    std::uint32_t* below = &sums_[(static_cast<std::size_t>(r) + 1) * stride];
    const std::uint8_t* row = cells(r);
    std::uint32_t sum = below[0] = 0;
    for (int c = 0; c < columns_; ++c) {
      sum += kCarried[row[c]];
      below[c + 1] = above[c + 1] + sum;
    }
  }
  summed_to_ = rows_;
}

const std::uint32_t* PeopleFinder::sums(int row) const {
  return &sums_[static_cast<std::size_t>(row) * (static_cast<std::size_t>(columns_) + 1)];
}

// Foreground cells of the window, not explained, in the columns before this one.
int PeopleFinder::moving_before(int column) const {
  return static_cast<int>((sums(window_.bottom)[column] - sums(window_.top)[column]) & 0xffff);
}

// Fills scores_[first..end): gain of a body, less its price, by the column of its axis. Returns the highest.
int PeopleFinder::score(int foot, int height, int first, int end) {
  const Body& body = bodies_[static_cast<std::size_t>(height)];
  const int top = foot - height;
  for (std::size_t i = 0; i < kBodyBands; ++i) {
    bands_[i].above = sums(std::clamp(top + body[i].top, 0, rows_));
    bands_[i].below = sums(std::clamp(top + body[i].bottom, 0, rows_));
    bands_[i].core = body[i].core;
    bands_[i].reach = body[i].reach;
  }
  return score_bodies(bands_, first, end, scores_.data());
}

// Replaces `best` where a person of this scale whose left edge lies in [from, to) and whose feet are at this row gains
// more. With an anchor, a column, the foreground that stays unexplained between it and the box counts against it.
void PeopleFinder::try_row(int foot, const Scale& scale, int from, int to, int anchor, Candidate& best) {
  const Parameters& q = parameters_;
  const Shape& usual = shapes_[static_cast<std::size_t>(foot)];
  const int h = std::min(kTallest, whole(scale.factor * usual.height));
  const int w = std::max(2, whole(scale.factor * usual.width));
  if (usual.height == 0 || foot < h || foot - window_.top < q.least_feet * h) return;
  const int reach = bodies_[static_cast<std::size_t>(h)][kBodyBands - 1].reach;
  const int first = std::max({from + w / 2, reach, inside_.left});
  const int end = std::min({to + w / 2, columns_ - reach + 1, inside_.right + 1});
  if (first >= end) return;
  const auto unlikely = [&](double deviation) {
    return static_cast<int>(kUnit * q.height_weight * deviation * deviation / 2 * h * h);
  };
  const int cost = scale.factor == 1 ? 0 : unlikely(scale.log / usual.spread);
  const int least =
      std::max(best.score, height_known_ ? static_cast<int>(kUnit * q.least_gain * h * h) - cost : 0);
  // All that moves in these rows, within reach of these axes, may be too little.
  const int dearest = bands_[2].core_moving;
  const auto before = [&](int x) { return sums(foot)[x] - sums(foot - h)[x]; };
  const int moving = static_cast<int>((before(end - 1 + reach) - before(first - reach)) & 0xffff);
  if (moving * dearest - cost <= least) return;
  int most = score(foot, h, first, end) - cost;
  if (most <= least) return;
  const auto lost = [&](int x) {
    const int left = x - w / 2;
    return anchor >= 0 && left > anchor ? (moving_before(left) - moving_before(anchor)) * dearest : 0;
  };
  if (anchor >= 0) {
    most = INT_MIN;
    for (int x = first; x < end; ++x)
      most = std::max(most, (scores_[static_cast<std::size_t>(x)] -= lost(x)) - cost);
    if (most <= least) return;
  }
  const auto at = std::find(scores_.begin() + first, scores_.begin() + end, most + cost);
  const int x = static_cast<int>(at - scores_.begin());
  best = {x - w / 2, foot - h, x - w / 2 + w, foot, x, most};
}

// The best position for one more person whose left edge lies in [from, to). Score 0: none. The expected height is tried
// everywhere, and its neighbours where that fits best. Heights that the line does not exclude where it is uncertain are
// tried everywhere, and where the height is not known, all of them.
PeopleFinder::Candidate PeopleFinder::best(int from, int to, int anchor) {
  constexpr double kDeviations = 2;  // that a height may be off, as far as the scales reach
  const double sure =
      std::numbers::sqrt2 * parameters_.spread;  // the line's error is as large as people differ
  Candidate best;
  const auto try_everywhere = [&](std::span<const Scale> scales) {
    for (const Scale& scale : scales) {
      if (scale.factor != 1 && height_known_ && largest_spread_ <= sure) continue;
      for (int foot = rows_; foot > window_.top; --foot) {
        const Shape& shape = shapes_[static_cast<std::size_t>(foot)];
        const bool allowed =
            !height_known_ || (shape.spread > sure && std::abs(scale.log) < kDeviations * shape.spread);
        if (scale.factor == 1 || allowed) try_row(foot, scale, from, to, anchor, best);
      }
    }
  };
  if (!height_known_) {
    try_everywhere(unknown_scales_);
    return best;
  }
  try_everywhere(scales_);
  if (best.score == 0) return best;
  const Candidate usual = best;
  constexpr int kAround = 2;  // cells
  for (int foot = std::max(1, usual.bottom - kAround); foot <= std::min(rows_, usual.bottom + kAround);
       ++foot)
    for (std::size_t i = 1; i <= kNeighbours; ++i)
      try_row(foot, scales_[i], std::max(from, usual.left - kAround), std::min(to, usual.left + kAround + 1),
              anchor, best);
  return best;
}

// Gain of a chosen person without its price, nats a pixel of the body that lies in the picture.
double PeopleFinder::gain_a_pixel(const Candidate& c) const {
  const Body& body = bodies_[static_cast<std::size_t>(c.bottom - c.top)];
  int seen = 0;
  for (std::size_t i = 1; i < kBodyBands; ++i) {
    const int top = std::max(inside_.top, c.top + body[i].top),
              bottom = std::min(inside_.bottom, c.top + body[i].bottom);
    const int left = std::max(inside_.left, c.axis - body[i].reach),
              right = std::min(inside_.right, c.axis + body[i].reach);
    seen += std::max(0, bottom - top) * std::max(0, right - left);
  }
  return static_cast<double>(c.score) / kUnit / std::max(seen, 1) + parameters_.price;
}

// Chooses people one after another, the best first or always the leftmost one, and returns the total gain.
int PeopleFinder::explain(bool from_the_left) {
  chosen_.clear();
  clear_explained();
  add_up();
  const Shape& usual = shapes_[static_cast<std::size_t>(std::min(window_.bottom, rows_))];
  const int width = std::max(1, usual.width);
  int total = 0, edge = window_.left;
  while (chosen_.size() < kMostPeople) {
    // The rest may be too little for the price of the least part of a person.
    const double price = kUnit * parameters_.price * usual.height * usual.width / parameters_.least_part;
    if (moving_before(columns_) * bands_[2].core_moving < price) break;
    Candidate c;
    if (from_the_left) {
      // A person's edge is near the leftmost column with unexplained foreground.
      while (edge < window_.right && moving_before(edge + 1) == moving_before(edge)) ++edge;
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
    add_up();
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
    add_up();
    const int w = old.right - old.left;
    const Candidate c = best(old.left - w / 2, old.left + w / 2 + 1, -1);
    if (c.score > 0) chosen_.push_back(c);
  }
}

// Share of the cells in the chosen boxes that are foreground.
double PeopleFinder::filled() {
  clear_explained();
  explained_from_ = 0;
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
  if (!height_known_) return n > 0 && (gaps() < parameters_.gaps_unknown || filled() > parameters_.solid);
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
  block_ = is_block(was_wide_block);
  if (block_ && height_known_) return;
  for (const Candidate& c : chosen_)
    people_.push_back(
        {{static_cast<double>(x0_ + c.left * step_), static_cast<double>(y0_ + c.top * step_),
          static_cast<double>((c.right - c.left) * step_), static_cast<double>((c.bottom - c.top) * step_)},
         gain_a_pixel(c)});
}

std::span<const Person> PeopleFinder::find(BitView pixels, const Bounds& window, const HeightPrior& prior,
                                           bool was_wide_block) {
  people_.clear();
  block_ = wide_block_ = false;
  prior_ = &prior;
  const double expected = prior.height(window.bottom);
  height_known_ = expected > 0;
  if (window.height() <= 0) return people_;
  std::array<std::uint8_t, kMostCells> cells;
  std::array<std::uint32_t, kMostCells> sums;
  cells_ = cells;
  sums_ = sums;
  lay_grid(pixels, window, height_known_ ? expected : window.height());
  choose(was_wide_block);
  cells_ = {};
  sums_ = {};
  return people_;
}

}  // namespace cerberus::vision
