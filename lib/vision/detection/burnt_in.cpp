// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/burnt_in.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace cerberus::vision {
namespace {

constexpr std::size_t kMostPlaces = 16;
constexpr double kUsualPeriod = 0.04;  // seconds, where no frame has a time
constexpr int kBits = 64;              // of a word of a mask: eight blocks
constexpr int kScore = 8;              // of a look with static edges; one without costs 1
constexpr std::uint8_t kPresent = 0x80;

// Eight counts of set bits, one a byte.
std::uint64_t count_bytes(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555u;
  v = (v & 0x3333333333333333u) + (v >> 2 & 0x3333333333333333u);
  return (v + (v >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}

// Set bits of each block in a row of blocks, into counts.
void count_blocks(BitView bits, int row, int columns, std::uint8_t* counts) {
  const int top = row * BurntIn::kBlockHeight, bottom = std::min(top + BurntIn::kBlockHeight, bits.height);
  for (int word = 0; word < bits.width; ++word) {
    std::uint64_t sum = 0;
    for (int y = top; y < bottom; ++y) sum += count_bytes(bits.row(y)[word]);
    const int first = word * kBits / BurntIn::kBlockWidth;
    for (int i = 0; i < std::min(kBits / BurntIn::kBlockWidth, columns - first); ++i)
      counts[first + i] = static_cast<std::uint8_t>(sum >> (8 * i));
  }
}

}  // namespace

void BurntIn::reset() {
  std::fill(blocks_.begin(), blocks_.end(), Block{});
  places_.clear();
  found_.clear();
  reported_.clear();
  now_ = last_look_ = reference_until_ = 0;
  standing_ = 0;
  referenced_ = false;
}

void BurntIn::prepare(Size size) {
  if (size == size_) return;
  columns_ = (size.width + kBlockWidth - 1) / kBlockWidth;
  rows_ = (size.height + kBlockHeight - 1) / kBlockHeight;
  const auto count = static_cast<std::size_t>(columns_) * rows_;
  blocks_.assign(count, {});
  for (auto* counts : {&changed_, &static_, &moving_}) counts->assign(count, 0);
  stack_.reserve(count);
  places_.reserve(kMostPlaces);
  found_.reserve(kMostPlaces);
  reported_.reserve(kMostPlaces);
  bits_.resize(bit_mask_size(size));
  reference_.resize(size);
  size_ = size;  // last: what threw is tried again
  reset();
}

double BurntIn::rest() const {
  return std::max(parameters_.rest, parameters_.rest_frames * period_);
}

// Whether a change comes after the usual interval, or a few of them: not every second changes every part of a digit.
bool BurntIn::keeps_time(Block& b, double seconds) const {
  constexpr double kMost = 3;
  const double usual = b.interval / 1000.0, slack = 1.2 * period_;
  const auto is_multiple = [&](double longer, double shorter) {
    const double times = std::round(longer / shorter);
    return times >= 1 && times <= kMost && std::abs(longer - times * shorter) <= slack;
  };
  const bool same = usual > 0 && (is_multiple(seconds, usual) || is_multiple(usual, seconds));
  if (!same || seconds < usual) b.interval = static_cast<std::uint16_t>(std::lround(1000 * seconds));
  return same;
}

// A change in one or two frames counts once it was followed by rest and the next one comes, if it comes in time.
void BurntIn::note_change(Block& b) {
  const auto now = static_cast<std::uint32_t>(std::lround(1000 * now_));
  const double ago = b.last ? (now - b.last) / 1000.0 : 1e9;
  if (ago > parameters_.stale) {
    b.changes = 0, b.frames = 1, b.since = b.first = now;
    b.interval = 0;
  } else if (ago < 1.5 * period_) {
    if (b.frames < 255) ++b.frames;
    if (b.frames > parameters_.change_frames) b.changes = 0;
  } else {
    const bool at_once = b.frames <= parameters_.change_frames && ago >= rest();
    if (at_once && keeps_time(b, ago)) {
      if (b.changes < 255) ++b.changes;
    } else {
      b.changes = 0;
    }
    if (b.changes == 0) b.first = b.last;
    b.frames = 1;
    if (ago >= rest()) b.since = now;
  }
  b.last = now;
}

void BurntIn::note_changes(const BurntInInput& in) {
  binarise(in.difference, std::max(in.threshold, parameters_.least_step), bits_.view());
  std::size_t count = 0;
  for (int row = 0; row < rows_; ++row) {
    std::uint8_t* counts = changed_.data() + static_cast<std::size_t>(row) * columns_;
    count_blocks(bits_.view(), row, columns_, counts);
    for (int x = 0; x < columns_; ++x) count += counts[x] = counts[x] >= parameters_.least_changed;
  }
  changed_any_ = count > 0 && static_cast<double>(count) < parameters_.whole_picture * blocks_.size();
  if (!changed_any_) return;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    if (changed_[i]) note_change(blocks_[i]);
}

// What changes in the same frame and in the same row as something learnt belongs to it, if the rows above and below do
// not change there: the tens with the seconds, the minutes with the tens.
void BurntIn::grow_rows() {
  bool grown = false;
  for (Place& p : places_) {
    const int top = std::max(p.top - 1, 0), bottom = std::min(p.bottom + 1, rows_);
    const auto in_rows = [&](int x, int from, int to) {
      bool any = false;
      for (int y = std::max(from, 0); y < std::min(to, rows_) && !any; ++y) any = changed(x, y);
      return any;
    };
    const auto goes_on = [&](int x, int from, int to) {
      bool any = in_rows(x, from, to);
      for (int y = std::max(from, 0); y < std::min(to, rows_) && !any; ++y)
        any = block(x, y).foreground > 255 * parameters_.continues;
      return any;
    };
    bool active = false;
    for (int x = p.left; x < p.right && !active; ++x) active = in_rows(x, p.top, p.bottom);
    if (!active) continue;
    p.quiet = 0;
    p.changes = true;
    const int widest = static_cast<int>(parameters_.widest * columns_);
    for (const int step : {-1, 1}) {
      int edge = step < 0 ? p.left - 1 : p.right;
      for (int x = edge, empty = 0; x >= 0 && x < columns_ && empty <= parameters_.gap; x += step) {
        if (!in_rows(x, top, bottom)) {
          ++empty;
          continue;
        }
        if (goes_on(x, top - 3, top) || goes_on(x, bottom, bottom + 3)) break;
        empty = 0;
        const int left = std::min(p.left, x), right = std::max(p.right, x + 1);
        if (right - left > widest) break;
        p.left = left, p.right = right;
        grown = true;
      }
    }
  }
  if (grown) publish();
}

void BurntIn::look_at_edges(const BurntInInput& in) {
  const GrayView f = in.picture, r = reference_.view();
  const int edge = parameters_.edge, same = parameters_.same;
  for (int by = 0; by < rows_; ++by) {
    const std::size_t first = static_cast<std::size_t>(by) * columns_;
    for (int bx = 0; bx < columns_; ++bx) {
      Block& b = blocks_[first + bx];
      std::uint8_t &fixed = static_[first + bx], &moved = moving_[first + bx];
      fixed = moved = 0;
      const Point p{bx * kBlockWidth + kBlockWidth / 2.0, by * kBlockHeight + kBlockHeight / 2.0};
      const Point q = from_reference_.apply(p);
      const double dx = std::abs(q.x - p.x), dy = std::abs(q.y - p.y);
      if (!(std::max(dx, dy) >= parameters_.least_shift)) continue;
      // Edges across the motion: the others look alike wherever the scene has gone.
      const std::ptrdiff_t across = dx >= dy ? 1 : f.stride, across_then = dx >= dy ? 1 : r.stride;
      const int x0 = std::max(bx * kBlockWidth, 1), x1 = std::min((bx + 1) * kBlockWidth, f.width - 1);
      const int y0 = std::max(by * kBlockHeight, 1), y1 = std::min((by + 1) * kBlockHeight, f.height - 1);
      for (int y = y0; y < y1; ++y) {
        const std::uint8_t *now = f.row(y), *then = r.row(y);
        for (int x = x0; x < x1; ++x) {
          const int slope = now[x + across] - now[x - across],
                    slope_then = then[x + across_then] - then[x - across_then];
          const bool is_edge = std::abs(slope) >= edge;
          const bool is_same =
              (std::abs(now[x] - then[x]) <= same) & (std::abs(slope - slope_then) <= 2 * same);
          fixed += is_edge & is_same, moved += is_edge & !is_same;
        }
      }
      if (fixed >= parameters_.least_static && fixed > moved) {
        b.score =
            static_cast<std::uint8_t>(std::min(b.score + kScore, 2 * kScore * parameters_.enough_looks));
        if (!(b.references & kPresent))
          b.references = static_cast<std::uint8_t>((b.references + 1) | kPresent);
      } else if (moved >= parameters_.least_static && moved > 2 * fixed && b.score > 0) {
        if (--b.score == 0) b.references &= kPresent;
      }
    }
  }
}

void BurntIn::look_at_foreground(GrayView mask) {
  pack(mask, bits_.view());
  for (int row = 0; row < rows_; ++row) {
    std::uint8_t* counts = changed_.data() + static_cast<std::size_t>(row) * columns_;
    count_blocks(bits_.view(), row, columns_, counts);
    for (int x = 0; x < columns_; ++x) {
      Block& b = block(x, row);
      const int target = counts[x] >= parameters_.least_changed ? 255 : 0;
      b.foreground = static_cast<std::uint8_t>(b.foreground + (target - b.foreground) / 6);
    }
  }
}

// Whether nothing goes on around it, and all of it has changed at the same time.
bool BurntIn::is_writing(const Place& p, bool still) const {
  const auto now = static_cast<std::uint32_t>(std::lround(1000 * now_));
  std::uint32_t begun = now;
  if (still)
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x)
        if (const Block& b = block(x, y); b.candidate)
          begun = std::min(begun, b.changes + 1 >= parameters_.enough_changes ? b.first : b.since);
  const auto goes_on = [&](const Block& b) {
    return b.foreground > 255 * parameters_.continues || (still && b.last && b.last >= begun);
  };
  constexpr int kNear = 1, kFar = 3;  // blocks
  int beside = 0, around = 0;
  for (int y = std::max(p.top - kFar, 0); y < std::min(p.bottom + kFar, rows_); ++y)
    for (int x = std::max(p.left - (still ? kFar : 0), 0);
         x < std::min(p.right + (still ? kFar : 0), columns_); ++x) {
      if (x >= p.left - kNear && x < p.right + kNear && y >= p.top - kNear && y < p.bottom + kNear) continue;
      ++around;
      beside += goes_on(block(x, y));
    }
  if (beside > around / 10) return false;
  if (!still) return true;
  std::uint32_t newest = 0;
  for (int y = p.top; y < p.bottom; ++y)
    for (int x = p.left; x < p.right; ++x)
      if (block(x, y).candidate) newest = std::max(newest, block(x, y).last);
  int all = 0, together = 0;
  for (int y = p.top; y < p.bottom; ++y)
    for (int x = p.left; x < p.right; ++x)
      if (const Block& b = block(x, y); b.candidate) ++all, together += newest - b.last <= 2000 * period_;
  return together >= 0.6 * all;
}

// Grows a place by foreground that lasts beside its static edges: of a running count only the outline is static, and a
// box behind writing is wider than its letters. Above and below, the place grows by half its height at most: a part of
// a person followed by the head has more foreground there.
void BurntIn::grow_foreground(Place& p) const {
  const auto is_foreground = [&](int left, int top, int right, int bottom) {
    int n = 0;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) n += block(x, y).foreground > 255 * parameters_.belongs;
    return 2 * n > std::max(right - left, bottom - top) / 2;
  };
  for (const int step : {-1, 1})
    for (int x = step < 0 ? p.left - 1 : p.right, empty = 0;
         x >= 0 && x < columns_ && empty <= parameters_.gap; x += step) {
      if (!is_foreground(x, p.top, x + 1, p.bottom)) {
        ++empty;
        continue;
      }
      empty = 0;
      p.left = std::min(p.left, x), p.right = std::max(p.right, x + 1);
    }
  const int margin = std::max((p.bottom - p.top) / 2, 1), top = std::max(p.top - margin, 0),
            bottom = std::min(p.bottom + margin, rows_);
  while (p.top > top && is_foreground(p.left, p.top - 1, p.right, p.top)) --p.top;
  while (p.bottom < bottom && is_foreground(p.left, p.bottom, p.right, p.bottom + 1)) ++p.bottom;
}

void BurntIn::search(bool still) {
  const Parameters& limits = parameters_;
  const auto now = static_cast<std::uint32_t>(std::lround(1000 * now_));
  const auto is_strong = [&](const Block& b) {
    return still || (b.score >= kScore * limits.enough_looks &&
                     (b.references & ~kPresent) >= limits.enough_references);
  };
  bool any = false;
  for (Block& b : blocks_) {
    if (still) {
      const bool busy =
          b.last && now - b.last < 1000 * rest() && b.last - b.since >= 1000 * limits.enough_busy;
      b.candidate = busy || (b.changes + 1 >= limits.enough_changes && now - b.last < 2000 &&
                             b.last - b.first >= 1000 * limits.enough_time);
    } else {
      b.candidate = b.score >= kScore * limits.some_looks;
    }
    any |= b.candidate && is_strong(b);
  }
  if (!any) return;
  constexpr std::uint8_t kSeen = 2;
  for (int y0 = 0; y0 < rows_; ++y0)
    for (int x0 = 0; x0 < columns_; ++x0) {
      if (block(x0, y0).candidate != 1) continue;
      Place place{x0, y0, x0 + 1, y0 + 1};
      int count = 0, strong = 0;
      stack_.clear();
      stack_.push_back(y0 * columns_ + x0);
      block(x0, y0).candidate = kSeen;
      while (!stack_.empty()) {
        const int at = stack_.back();
        stack_.pop_back();
        const int x = at % columns_, y = at / columns_;
        ++count;
        strong += is_strong(block(x, y));
        place = {std::min(place.left, x), std::min(place.top, y), std::max(place.right, x + 1),
                 std::max(place.bottom, y + 1)};
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, rows_ - 1); ++v)
          for (int u = std::max(x - limits.gap, 0); u <= std::min(x + limits.gap, columns_ - 1); ++u) {
            Block& b = block(u, v);
            if (b.candidate != 1) continue;
            b.candidate = kSeen;
            stack_.push_back(v * columns_ + u);
          }
      }
      if (count < 2 || strong == 0) continue;
      if (!still) grow_foreground(place);
      if (place.right - place.left > limits.widest * columns_ ||
          place.bottom - place.top > limits.highest * rows_ || !is_writing(place, still))
        continue;
      place.changes = still;
      add(place);
    }
}

// Joins what overlaps or touches.
void BurntIn::add(const Place& found) {
  for (Place& p : places_) {
    if (found.left > p.right + parameters_.gap || found.right < p.left - parameters_.gap ||
        found.top > p.bottom || found.bottom < p.top)
      continue;
    p.changes |= found.changes;
    if (found.changes) p.quiet = 0;
    const Place joined{std::min(p.left, found.left), std::min(p.top, found.top),
                       std::max(p.right, found.right), std::max(p.bottom, found.bottom)};
    if (joined.right - joined.left > parameters_.widest * columns_ ||
        joined.bottom - joined.top > parameters_.highest * rows_)
      return;
    p.left = joined.left, p.top = joined.top, p.right = joined.right, p.bottom = joined.bottom;
    return;
  }
  if (places_.size() < kMostPlaces) places_.push_back(found);
}

// looked: static edges were looked for in this frame.
void BurntIn::forget(double seconds, bool looked) {
  for (Place& p : places_) {
    if (p.changes && standing_ > 0) p.quiet += seconds;
    if (!looked) continue;
    int fixed = 0, moved = 0;
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * columns_ + x;
        fixed += static_[at], moved += moving_[at];
      }
    if (fixed >= parameters_.least_static && 2 * fixed >= moved)
      p.against = 0;
    else if (moved >= parameters_.least_static)
      p.against += seconds;
  }
  std::erase_if(places_, [&](const Place& p) {
    if (p.quiet <= parameters_.keep && p.against <= parameters_.keep_against) return false;
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x) block(x, y) = {};
    return true;
  });
}

void BurntIn::publish() {
  found_.clear();
  for (const Place& p : places_) {
    const double left = std::max(p.left * kBlockWidth - 2, 0), top = std::max(p.top * kBlockHeight - 2, 0);
    found_.push_back({left, top, std::min(p.right * kBlockWidth + 2, size_.width) - left,
                      std::min(p.bottom * kBlockHeight + 2, size_.height) - top});
  }
}

void BurntIn::clear(MutableGrayView mask) const {
  for (const Box& b : found_) {
    const int left = static_cast<int>(b.x), top = static_cast<int>(b.y);
    const int right = static_cast<int>(b.right()), bottom = static_cast<int>(b.bottom());
    const bool between = top > 0 && bottom < mask.height;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        mask.at(x, y) = between ? mask.at(x, top - 1) & mask.at(x, bottom) : 0;
  }
}

bool BurntIn::update(const BurntInInput& in, MutableGrayView mask) {
  prepare(mask.size());
  const double seconds = in.seconds > 0 ? in.seconds : period_ > 0 ? period_ : kUsualPeriod;
  period_ = period_ > 0 ? period_ + 0.1 * (seconds - period_) : seconds;
  now_ += seconds;
  standing_ = in.still ? standing_ + 1 : 0;
  if (in.still && standing_ > 2) {
    note_changes(in);
    if (changed_any_) grow_rows();
  }
  from_reference_ = in.motion * from_reference_;
  const double looked = now_ - last_look_;
  const bool look = looked >= parameters_.look_period - period_ / 2;
  if (look) {
    last_look_ = now_;
    const bool edges = referenced_ && from_reference_.is_sane(size_) && !from_reference_.is_identity();
    if (edges) look_at_edges(in);
    const Point centre{size_.width / 2.0, size_.height / 2.0}, seen = from_reference_.apply(centre);
    const bool has_moved =
        std::max(std::abs(seen.x - centre.x), std::abs(seen.y - centre.y)) > 2 * parameters_.least_shift;
    look_at_foreground(mask);
    search(in.still);
    forget(looked, edges);
    if (now_ >= reference_until_ - period_ / 2 || has_moved ||
        (referenced_ && !from_reference_.is_sane(size_))) {
      const GrayView f = in.picture;
      for (int y = 0; y < f.height; ++y)
        std::memcpy(reference_.view().row(y), f.row(y), static_cast<std::size_t>(f.width));
      from_reference_ = {};
      referenced_ = true;
      reference_until_ = now_ + parameters_.reference_time;
      for (Block& b : blocks_) b.references &= static_cast<std::uint8_t>(~kPresent);
    }
    publish();
  }
  clear(mask);
  return is_news();
}

bool BurntIn::is_news() {
  bool same = found_.size() == reported_.size();
  for (std::size_t i = 0; same && i < found_.size(); ++i)
    same = intersection_over_union(found_[i], reported_[i]) >= parameters_.same_report;
  if (same) return false;
  reported_ = found_;
  return true;
}

std::size_t BurntIn::bytes() const {
  return sizeof *this + blocks_.capacity() * sizeof(Block) + changed_.capacity() + static_.capacity() +
         moving_.capacity() + stack_.capacity() * sizeof(std::int32_t) + bits_.bytes() + reference_.bytes();
}

}  // namespace cerberus::vision
