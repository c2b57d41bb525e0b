// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/static_edges.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vision/burnt_in/static_edge_kernels.h"

namespace cerberus::vision {

namespace {

constexpr int kPair = 2;  // pixels from one side of an edge to the other

}  // namespace

void StaticEdges::resize(const BlockGrid& grid) {
  for (auto* counts : {&score_, &references_, &fixed_, &moved_}) counts->assign(grid.count(), 0);
  reference_.resize({grid.size.width, (grid.size.height + 1) / BlockGrid::kStep});
  grid_ = grid;
  reset();
}

void StaticEdges::reset() {
  for (auto* counts : {&score_, &references_}) std::fill(counts->begin(), counts->end(), std::uint8_t{0});
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

// Counts the edges of the eight blocks of one word.
void StaticEdges::compare_blocks(GrayView picture, int row, int word, Across across) {
  const bool columns = across == Across::columns;
  const int x = word * 64, width = picture.width - (columns ? kPair : 0);
  const int lines = (picture.height - (columns ? 0 : kPair) + 1) / BlockGrid::kStep;
  const int first = row * BlockGrid::kHeight / BlockGrid::kStep;
  const GrayView reference = reference_.view();
  std::uint64_t edges = 0, fixed = 0;
  for (int line = first; line < std::min(first + BlockGrid::kHeight / BlockGrid::kStep, lines); ++line) {
    const std::uint8_t *now = picture.row(line * BlockGrid::kStep) + x, *then = reference.row(line) + x;
    const EdgeBits bits =
        compare_edges({now, columns ? now + kPair : picture.row(line * BlockGrid::kStep + kPair) + x},
                      {then, columns ? then + kPair : reference.row(line + kPair / BlockGrid::kStep) + x},
                      std::min(64, width - x), parameters_.edge, parameters_.same);
    edges += count_in_bytes(bits.edges), fixed += count_in_bytes(bits.fixed);
  }
  const std::size_t at = grid_.at(word * BlockGrid::kWord, row);
  store_counts(fixed, fixed_.data() + at);
  store_counts(edges - fixed, moved_.data() + at);
  if (edges) rate_blocks(at);
}

void StaticEdges::rate_blocks(std::size_t first) {
  const int most = 2 * parameters_.score * parameters_.enough;
  for (std::size_t i = first; i < first + BlockGrid::kWord; ++i) {
    if (is_static(fixed_[i], moved_[i])) {
      score_[i] = static_cast<std::uint8_t>(std::min(score_[i] + parameters_.score, most));
      if (references_[i] < kPresent - 1)
        references_[i] = static_cast<std::uint8_t>((references_[i] + 1) | kPresent);
    } else if (score_[i] > 0 && has_edges(moved_[i]) && moved_[i] > 2 * fixed_[i]) {
      if (--score_[i] == 0) references_[i] &= kPresent;
    }
  }
}

bool StaticEdges::compare(GrayView picture) {
  if (!referenced_ || from_reference_.is_identity() || !from_reference_.is_sane(grid_.size)) return false;
  for (int row = 0; row < grid_.rows; ++row) {
    const auto shift = [&](int x) {
      const Point p{static_cast<double>(std::min(x, picture.width)), (row + 0.5) * BlockGrid::kHeight};
      const Point q = from_reference_.apply(p);
      return Point{q.x - p.x, q.y - p.y};
    };
    Point left = shift(0);
    for (int word = 0; word < grid_.words; ++word) {
      const Point right = shift(64 * (word + 1));
      const Across across = direction(left, right);
      left = right;
      if (across != Across::nowhere) {
        compare_blocks(picture, row, word, across);
        continue;
      }
      const std::size_t at = grid_.at(word * BlockGrid::kWord, row);
      store_counts(0, fixed_.data() + at);
      store_counts(0, moved_.data() + at);
    }
  }
  return true;
}

void StaticEdges::renew(GrayView picture, double now, double period) {
  const Point centre{grid_.size.width / 2.0, grid_.size.height / 2.0}, seen = from_reference_.apply(centre);
  const bool moved =
      std::max(std::abs(seen.x - centre.x), std::abs(seen.y - centre.y)) > 2 * parameters_.least_shift;
  if (now < until_ - period / 2 && !moved && !(referenced_ && !from_reference_.is_sane(grid_.size))) return;
  const MutableGrayView reference = reference_.view();
  for (int line = 0; line < reference.height; ++line)
    std::memcpy(reference.row(line), picture.row(line * BlockGrid::kStep),
                static_cast<std::size_t>(picture.width));
  from_reference_ = {};
  referenced_ = true;
  until_ = now + parameters_.reference_time;
  for (std::uint8_t& count : references_) count &= static_cast<std::uint8_t>(~kPresent);
}

std::size_t StaticEdges::bytes() const {
  return score_.capacity() + references_.capacity() + fixed_.capacity() + moved_.capacity() +
         reference_.bytes();
}

}  // namespace cerberus::vision
