// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/static_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "vision/change/difference_kernels.h"
#include "vision/image/mask_kernels.h"

namespace cerberus::vision {

namespace {

constexpr int kPair = 2;  // pixels from one side of an edge to the other

}  // namespace

void StaticEdges::resize(const BlockGrid& grid) {
  for (auto* counts : {&score_, &fixed_, &moved_}) counts->assign(grid.count(), 0);
  reference_.resize({grid.size.width, (grid.size.height + 1) / BlockGrid::kStep});
  grid_ = grid;
  reset();
}

void StaticEdges::reset() {
  std::fill(score_.begin(), score_.end(), std::uint8_t{0});
  until_ = 0;
  referenced_ = false;
}

// Edges across the motion are compared: the others look alike wherever the scene has gone. left, right: by how much the
// scene has moved at the ends of a row of blocks; between them it moves by amounts between these.
StaticEdges::Across StaticEdges::direction(const Point& left, const Point& right) const {
  const auto least = [](double a, double b) { return a * b > 0 ? std::min(std::abs(a), std::abs(b)) : 0; };
  const double dx = least(left.x, right.x), dy = least(left.y, right.y);
  if (!(std::max(dx, dy) >= parameters_.least_shift)) return Across::nowhere;
  return dx >= dy ? Across::columns : Across::rows;
}

// Counts the edges of the eight blocks of one word, and rates them.
void StaticEdges::compare_blocks(GrayView picture, int row, int word, Across across) {
  const bool columns = across == Across::columns;
  const int left = 64 * word, top = row * BlockGrid::kHeight;
  const int count = std::min(64, picture.width - left - (columns ? kPair : 0)),
            bottom = std::min(top + BlockGrid::kHeight, picture.height - (columns ? 0 : kPair));
  const GrayView reference = reference_.view();
  const std::size_t first = grid_.at(word * BlockGrid::kWord, row);
  for (int y = top; y < bottom && count > 0; y += BlockGrid::kStep) {
    const std::uint8_t *now = picture.row(y) + left, *then = reference.row(y / BlockGrid::kStep) + left;
    const std::uint8_t* other = columns ? now + kPair : picture.row(y + kPair) + left;
    const std::uint8_t* other_then =
        columns ? then + kPair : reference.row((y + kPair) / BlockGrid::kStep) + left;
    std::array<std::uint8_t, 64> step;
    difference_row(now, other, count, step.data());
    std::uint64_t edges = 0;
    binarise_row(step.data(), count, parameters_.edge, &edges);
    for (; edges; edges &= edges - 1) {
      const int x = std::countr_zero(edges);
      const int moved = std::max(std::abs(now[x] - then[x]), std::abs(other[x] - other_then[x]));
      ++(moved <= parameters_.same ? fixed_
                                   : moved_)[first + static_cast<std::size_t>(x) / BlockGrid::kWidth];
    }
  }
  for (std::size_t i = first; i < first + BlockGrid::kWord; ++i) {
    if (fixed_[i] > moved_[i])
      score_[i] = static_cast<std::uint8_t>(std::min(score_[i] + kScore, 2 * kScore * parameters_.enough));
    else if (score_[i] > 0 && is_contrary(fixed_[i], moved_[i]))
      --score_[i];
  }
}

bool StaticEdges::compare(GrayView picture) {
  if (!referenced_ || from_reference_.is_identity() || !from_reference_.is_sane(grid_.size)) return false;
  std::ranges::fill(fixed_, std::uint8_t{0});
  std::ranges::fill(moved_, std::uint8_t{0});
  for (int row = 0; row < grid_.rows; ++row) {
    const auto shift = [&](int x) {
      const Point p{static_cast<double>(x), (row + 0.5) * BlockGrid::kHeight};
      const Point q = from_reference_.apply(p);
      return Point{q.x - p.x, q.y - p.y};
    };
    Point left = shift(0);
    for (int word = 0; word < grid_.words; ++word) {
      const Point right = shift(std::min(64 * (word + 1), picture.width));
      if (const Across across = direction(left, right); across != Across::nowhere)
        compare_blocks(picture, row, word, across);
      left = right;
    }
  }
  return true;
}

void StaticEdges::renew(GrayView picture, double now) {
  const Point centre{grid_.size.width / 2.0, grid_.size.height / 2.0}, seen = from_reference_.apply(centre);
  const bool moved =
      std::max(std::abs(seen.x - centre.x), std::abs(seen.y - centre.y)) >= parameters_.least_shift;
  if (now < until_ && !moved && !(referenced_ && !from_reference_.is_sane(grid_.size))) return;
  const MutableGrayView reference = reference_.view();
  for (int line = 0; line < reference.height; ++line)
    std::memcpy(reference.row(line), picture.row(line * BlockGrid::kStep),
                static_cast<std::size_t>(picture.width));
  from_reference_ = {};
  referenced_ = true;
  until_ = now + parameters_.reference_time;
}

std::size_t StaticEdges::bytes() const {
  return score_.capacity() + fixed_.capacity() + moved_.capacity() + reference_.bytes();
}

}  // namespace cerberus::vision
