// SPDX-License-Identifier: LGPL-2.1-or-later
// The likelihood: a pixel moves with probability kCore in the middle half of a person's columns, kSide in the outer
// ones and kOutside elsewhere. A person at a place gains, for each pixel not yet explained by another, the logarithm
// of the ratio to "outside"; whoever gains less than its price is not there. (The idea of explaining foreground by
// boxes of known size: F. Fleuret et al., "Multi-camera people tracking with a probabilistic occupancy map", PAMI
// 30(2), 2008; here one camera, greedy, with all sums from one table.)
#include "vision/people.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
namespace {

constexpr double kBodyAspect = 0.36;  // width of a walking body / its height
// ln(p / kOutside) and ln((1 - p) / (1 - kOutside)) with kCore = .65, kSide = .35, kOutside = .04
constexpr double kCoreMoving = 2.79, kCoreStill = -1.01;
constexpr double kSideMoving = 2.17, kSideStill = -0.39;
constexpr double kPrice = 0.3;  // for each pixel of the box; a whole person brings about 1
constexpr std::size_t kMostPeople = 12;

}  // namespace

// One table for two sums: moving pixels not yet explained in the lower 16 bits, pixels not yet explained in the upper.
// Both stay below 65536 by the window's size, so differences of packed sums are exact.
void PeopleFinder::add_up(BitView pixels) {
  const int width = window_.width(), pitch = width + 1;
  sums_.assign(static_cast<std::size_t>(pitch) * (window_.height() + 1), 0);
  for (int y = 0; y < window_.height(); ++y) {
    const std::uint64_t* bits = pixels.row(window_.top + y);
    const std::uint32_t* above = &sums_[static_cast<std::size_t>(y) * pitch];
    std::uint32_t* here = &sums_[static_cast<std::size_t>(y + 1) * pitch];
    std::uint32_t row = 0;
    for (int x = 0; x < width; ++x) {
      const int px = window_.left + x;
      bool free = true;
      for (const Candidate& c : chosen_)
        free &= px < c.left || px >= c.right || window_.top + y < c.top || window_.top + y >= c.bottom;
      if (free) row += 0x10000u + static_cast<std::uint32_t>(bits[px / 64] >> (px % 64) & 1);
      here[x + 1] = above[x + 1] + row;
    }
  }
}

std::uint32_t PeopleFinder::sum(int left, int top, int right, int bottom) const {
  const int pitch = window_.width() + 1;
  left = std::clamp(left - window_.left, 0, window_.width());
  right = std::clamp(right - window_.left, 0, window_.width());
  top = std::clamp(top - window_.top, 0, window_.height());
  bottom = std::clamp(bottom - window_.top, 0, window_.height());
  if (left >= right || top >= bottom) return 0;
  return sums_[static_cast<std::size_t>(bottom) * pitch + right] -
         sums_[static_cast<std::size_t>(bottom) * pitch + left] -
         sums_[static_cast<std::size_t>(top) * pitch + right] +
         sums_[static_cast<std::size_t>(top) * pitch + left];
}

PeopleFinder::Candidate PeopleFinder::judge(int left, int foot, double height) const {
  const int h = std::max(1, static_cast<int>(std::lround(height)));
  const int w = std::max(1, static_cast<int>(std::lround(kBodyAspect * height)));
  const int quarter = w / 4;
  Candidate c{left, foot - h, left + w, foot, 0, 0};
  const std::uint32_t all = sum(c.left, c.top, c.right, c.bottom);
  const std::uint32_t core = sum(c.left + quarter, c.top, c.right - quarter, c.bottom);
  const std::uint32_t side = all - core;
  // Outside the window nothing moves, but inside the picture it could have.
  const int seen = (std::min(c.right, picture_.width) - std::max(c.left, 0)) *
                   (std::min(c.bottom, picture_.height) - std::max(c.top, 0));
  const int beyond = seen - [&] {
    const int iw = std::min(c.right, window_.right) - std::max(c.left, window_.left);
    const int ih = std::min(c.bottom, window_.bottom) - std::max(c.top, window_.top);
    return iw > 0 && ih > 0 ? iw * ih : 0;
  }();
  const double core_moving = core & 0xffff, core_all = core >> 16;
  const double side_moving = side & 0xffff, side_all = side >> 16;
  const double gain = core_moving * kCoreMoving + (core_all - core_moving) * kCoreStill +
                      side_moving * kSideMoving + (side_all - side_moving) * kSideStill +
                      beyond * (kCoreStill + kSideStill) / 2;
  c.score = gain - kPrice * seen;
  c.per_pixel = seen > 0 ? gain / seen : 0;
  return c;
}

// The best place for one more person whose left edge lies in [from, to).
PeopleFinder::Candidate PeopleFinder::best(int from, int to) const {
  Candidate best{0, 0, 0, 0, 0, 0};
  const double tallest = prior_->height(window_.bottom);
  const int row_step = std::max(1, static_cast<int>(tallest / 20));
  const int below = window_.bottom >= picture_.height ? static_cast<int>(0.6 * tallest) : row_step;
  for (int foot = window_.bottom + below; foot > window_.top; foot -= row_step) {
    const double height = prior_->height(foot);
    if (height <= 0) continue;
    if (foot - window_.top < 0.4 * height) break;
    const int column_step = std::max(1, static_cast<int>(kBodyAspect * height / 10));
    for (int left = from; left < to; left += column_step) {
      const Candidate c = judge(left, foot, height);
      if (c.score > best.score) best = c;
    }
  }
  return best;
}

// Takes people one after another, the best first or always the leftmost one, and returns what is gained in all.
double PeopleFinder::explain(BitView pixels, bool from_the_left) {
  chosen_.clear();
  double total = 0;
  const int width = std::max(2, static_cast<int>(kBodyAspect * prior_->height(window_.bottom)));
  int edge = window_.left;
  while (chosen_.size() < kMostPeople) {
    add_up(pixels);
    Candidate c;
    if (from_the_left) {
      // The leftmost column that still holds something decides; a person's edge is near it.
      while (edge < window_.right && (sum(edge, window_.top, edge + 1, window_.bottom) & 0xffff) == 0) ++edge;
      if (edge >= window_.right) break;
      c = best(edge - width / 3, edge + width / 3);
      if (c.score <= 0) {
        edge += std::max(1, width / 4);
        continue;
      }
    } else {
      c = best(window_.left - width / 2, window_.right);
      if (c.score <= 0) break;
    }
    total += c.score;
    chosen_.push_back(c);
  }
  return total;
}

// Each in turn may move, given the others.
void PeopleFinder::settle(BitView pixels) {
  const std::size_t n = chosen_.size();
  for (std::size_t i = 0; i < n && n > 1; ++i) {
    const Candidate old = chosen_.front();
    chosen_.erase(chosen_.begin());
    add_up(pixels);
    const int w = old.right - old.left;
    const Candidate c = best(old.left - w / 2, old.left + w / 2 + 1);
    if (c.score > 0) chosen_.push_back(c);
  }
}

std::span<const Person> PeopleFinder::find(BitView pixels, Size picture, const Window& window,
                                           const HeightPrior& prior) {
  people_.clear();
  picture_ = picture;
  window_ = window;
  prior_ = &prior;
  if (prior.height(window.bottom) <= 0 || (window.width() + 1L) * (window.height() + 1L) > 65535)
    return people_;
  const double left_first = explain(pixels, true);
  other_ = chosen_;
  const double best_first = explain(pixels, false);
  if (left_first > best_first) std::swap(chosen_, other_);
  settle(pixels);
  for (const Candidate& c : chosen_)
    people_.push_back({{static_cast<double>(c.left), static_cast<double>(c.top),
                        static_cast<double>(c.right - c.left), static_cast<double>(c.bottom - c.top)},
                       c.per_pixel});
  return people_;
}

}  // namespace cerberus::vision
