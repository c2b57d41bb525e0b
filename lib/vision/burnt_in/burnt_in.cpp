// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/burnt_in.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "vision/change/difference_kernels.h"
#include "vision/image/mask_kernels.h"

namespace cerberus::vision {

namespace {

constexpr int kWidth = 8, kHeight = 4;  // pixels of a block
constexpr int kStep = 2;                // every second row of the picture is sampled
constexpr int kPair = 2;                // pixels from one side of an edge to the other
constexpr int kWhole = 255;             // a share of 1

std::uint32_t milliseconds(double seconds) {
  return static_cast<std::uint32_t>(std::lround(1000 * seconds));
}

}  // namespace

void BurntIn::reset() {
  std::ranges::fill(blocks_, Block{});
  referenced_ = false;
  places_.clear();
  found_ = {};
  now_ = searched_ = milliseconds(parameters_.enough);  // a block that never changed has not changed for long
}

void BurntIn::prepare(Size size) {
  if (size == size_) return;
  columns_ = (size.width + kWidth - 1) / kWidth;
  rows_ = (size.height + kHeight - 1) / kHeight;
  blocks_.assign(static_cast<std::size_t>(columns_) * rows_, {});
  bits_.assign(static_cast<std::size_t>(size.width + 63) / 64, 0);
  edges_.assign(static_cast<std::size_t>(size.width), 0);
  reference_.resize({size.width, (size.height + 1) / kStep});
  places_.reserve(BurntInBoxes::kMost);
  reported_ = {};
  size_ = size;  // last: what threw is tried again
  reset();
}

template <typename Each>
void BurntIn::for_blocks(const Place& p, Each each) {
  for (int y = std::max(p.top, 0); y < std::min(p.bottom, rows_); ++y)
    for (int x = std::max(p.left, 0); x < std::min(p.right, columns_); ++x) each(at(x, y));
}

// Calls found(block, x) for the pixels x of a row that exceed `limit`.
template <typename Found>
void BurntIn::find_pixels(const std::uint8_t* row, int width, int y, int limit, Found found) {
  binarise_row(row, width, static_cast<std::uint8_t>(std::clamp(limit, 0, 255)), bits_.data());
  for (int left = 0; left < width; left += 64)
    for (std::uint64_t bits = bits_[static_cast<std::size_t>(left) / 64]; bits; bits &= bits - 1) {
      const int x = left + std::countr_zero(bits);
      found(at(x / kWidth, y / kHeight), x);
    }
}

// Changes are evidence where each one is over at once and followed by rest, or where they go on without rest.
void BurntIn::note_change(Block& b) {
  if (b.last == now_) return;
  const Time ago = now_ - b.last, at_once = milliseconds(1.5 * period_);
  if (ago >= milliseconds(parameters_.enough)) {
    b.first = b.burst = now_;
  } else if (ago >= milliseconds(parameters_.rest)) {
    if (b.last - b.burst > at_once) b.first = now_;
    b.burst = now_;
  } else if (now_ - b.burst > at_once) {
    b.first = b.burst;
  }
  b.last = now_;
}

void BurntIn::average(std::uint8_t& share, bool is) const {
  share = static_cast<std::uint8_t>(share + ((is ? kWhole : 0) - share) / parameters_.memory);
}

// Once the scene has moved against the reference, averages which blocks have more edges that have stayed than edges that
// have not, and takes the picture as the reference. Edges across the motion are compared: the others look alike wherever
// the scene has gone. Returns whether it has compared.
bool BurntIn::compare_edges(GrayView picture) {
  const auto shift = [&](double x, double y) {
    const Point seen = from_reference_.apply({x, y});
    return Point{std::abs(seen.x - x), std::abs(seen.y - y)};
  };
  const bool known = referenced_ && from_reference_.is_sane(size_);
  const Point middle = shift(size_.width / 2.0, size_.height / 2.0);
  if (known && std::max(middle.x, middle.y) < parameters_.least_shift) return false;
  const bool across = middle.x >= middle.y;
  const int right = across ? kPair : 0, down = kPair - right, width = picture.width - right;
  const MutableGrayView then = reference_.view();
  for (Block& b : blocks_) b.votes = 0;
  for (int y = 0; known && y < picture.height - down; y += kStep) {
    const std::uint8_t *a = picture.row(y), *b = picture.row(y + down) + right;
    const std::uint8_t *a_then = then.row(y / kStep), *b_then = then.row((y + down) / kStep) + right;
    difference_row(a, b, width, edges_.data());
    find_pixels(edges_.data(), width, y, parameters_.step, [&](Block& block, int x) {
      const int change = std::max(std::abs(a[x] - a_then[x]), std::abs(b[x] - b_then[x]));
      block.votes += change <= parameters_.same ? 1 : -1;
    });
  }
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; known && x < columns_; ++x) {
      Block& b = at(x, y);
      const Point here = b.votes > 0 ? shift((x + 0.5) * kWidth, (y + 0.5) * kHeight) : Point{};
      average(b.fixed, (across ? here.x : here.y) >= parameters_.least_shift);
    }
  for (int line = 0; line < then.height; ++line)
    std::memcpy(then.row(line), picture.row(line * kStep), static_cast<std::size_t>(picture.width));
  from_reference_ = {};
  referenced_ = true;
  return known;
}

// Takes the component of the block at (x, y): its bounding rectangle, and how many of its blocks are evident and active.
BurntIn::Place BurntIn::take_component(int x, int y, int& evident, int& active) {
  Place place{x, y, x + 1, y + 1};
  const int gap = parameters_.gap;
  for (bool grown = true; grown;) {
    grown = false;
    const int left = std::max(place.left - gap, 0), right = std::min(place.right + gap, columns_),
              bottom = std::min(place.bottom + gap, rows_);
    for (int v = std::max(place.top - gap, 0); v < bottom; ++v)
      for (int u = left; u < right; ++u) {
        State& state = at(u, v).state;
        if (state == State::quiet) continue;
        ++active;
        evident += state == State::evident;
        state = State::quiet;
        place.left = std::min(place.left, u), place.top = std::min(place.top, v);
        place.right = std::max(place.right, u + 1), place.bottom = std::max(place.bottom, v + 1);
        grown = true;
      }
  }
  return place;
}

void BurntIn::search(bool still) {
  const Time enough = milliseconds(parameters_.enough);
  const int often = static_cast<int>(kWhole * parameters_.often);
  for (Block& b : blocks_) {
    const bool evident = still ? now_ - b.last < enough && b.last - b.first >= enough : b.fixed > often;
    const bool changed = still && now_ - b.last < enough;
    b.state = evident ? State::evident : changed || b.foreground > often ? State::active : State::quiet;
  }
  for (Place& p : places_)
    for_blocks(p, [&](const Block& b) {
      if (b.state == State::evident) p.quiet = 0;
    });
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (at(x, y).state != State::evident) continue;
      int evident = 0, active = 0;
      const Place component = take_component(x, y, evident, active);
      if (evident > 1 && component.bottom - component.top <= rows_ * parameters_.highest)
        add(component, !still || 3 * evident >= active, still);
    }
}

// Joins what overlaps or touches. Without evidence of its own, a component in the row of a place is the next digit.
void BurntIn::add(const Place& found, bool evident, bool still) {
  const int gap = parameters_.gap;
  for (Place& p : places_) {
    if (!p.grown_by(found, gap)) continue;
    p.changes |= still;
    if (evident || (found.top >= p.top - 1 && found.bottom <= p.bottom + 1))
      p.left = std::min(p.left, found.left), p.right = std::max(p.right, found.right);
    const int top = std::min(p.top, found.top), bottom = std::max(p.bottom, found.bottom);
    if (evident && bottom - top <= rows_ * parameters_.highest) p.top = top, p.bottom = bottom;
    return;
  }
  if (!evident || places_.size() >= BurntInBoxes::kMost) return;
  places_.push_back(found);
  places_.back().changes = still;
}

// compared: static edges were compared in this frame.
void BurntIn::forget(double seconds, bool still, bool compared) {
  std::erase_if(places_, [&](Place& p) {
    if (still ? p.changes : compared) p.quiet += seconds;
    if (p.quiet <= parameters_.keep) return false;
    for_blocks(p, [](Block& b) { b = {}; });
    return true;
  });
}

void BurntIn::publish() {
  found_ = {};
  for (const Place& p : places_) {
    // With the other side of the outermost edges.
    const double left = std::max(p.left * kWidth - kPair, 0), top = std::max(p.top * kHeight - kPair, 0);
    const Box box{left, top, std::min(p.right * kWidth + kPair, size_.width) - left,
                  std::min(p.bottom * kHeight + kPair, size_.height) - top};
    const auto overlaps = [&](const Box& other) { return overlap_area(box, other) > 0; };
    if (reported_.count < BurntInBoxes::kMost && std::ranges::none_of(reported_.boxes(), overlaps)) {
      reported_.box[reported_.count++] = box;
      found_.is_new.set(found_.count);
    }
    found_.box[found_.count++] = box;
  }
}

bool BurntIn::update(const BurntInInput& in, MutableGrayView mask) {
  prepare(mask.size());
  if (in.seconds > 0) period_ = in.seconds;
  now_ += milliseconds(period_);
  const std::size_t before = found_.count;
  found_.is_new.reset();
  from_reference_ = in.motion * from_reference_;
  bool grows = false;  // a place changes, and what changes at once in its row belongs to it
  if (in.still) {
    const int limit = std::max(in.threshold, parameters_.step);
    for (int y = 0; y < mask.height; y += kStep)
      find_pixels(in.difference.row(y), mask.width, y, limit, [&](Block& b, int) { note_change(b); });
    for (const Place& p : places_) for_blocks(p, [&](const Block& b) { grows |= b.last == now_; });
  }
  const double since = (now_ - searched_) / 1000.0;
  if (since >= parameters_.search_period - period_ / 2) {
    searched_ = now_;
    const bool compared = compare_edges(in.picture);
    for (Block& b : blocks_) b.state = State::quiet;
    for (int y = 0; y < mask.height; y += kStep)
      find_pixels(mask.row(y), mask.width, y, 0, [](Block& b, int) { b.state = State::active; });
    for (Block& b : blocks_) average(b.foreground, b.state == State::active);
    search(in.still);
    forget(since, in.still, compared);
    publish();
  } else if (grows) {
    search(in.still);
    publish();
  }
  clear_boxes(boxes(), mask);
  return found_.count != before;
}

std::size_t BurntIn::bytes() const {
  return sizeof *this + blocks_.capacity() * sizeof(Block) + bits_.capacity() * sizeof(std::uint64_t) +
         edges_.capacity() + reference_.bytes();
}

}  // namespace cerberus::vision
