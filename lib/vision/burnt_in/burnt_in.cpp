// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/burnt_in.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kWhole = 255;  // a share of 1

}  // namespace

void BurntIn::reset() {
  changes_.reset();
  edges_.reset();
  std::fill(foreground_.begin(), foreground_.end(), std::uint8_t{0});
  places_.clear();
  found_ = {};
  now_ = searched_ = 0;
}

void BurntIn::prepare(Size size) {
  if (size == grid_.size) return;
  const BlockGrid grid(size);
  changes_.resize(grid);
  edges_.resize(grid);
  foreground_.assign(grid.count(), 0);
  candidate_.assign(grid.count(), 0);
  bits_.assign(2 * static_cast<std::size_t>(grid.words), 0);
  places_.reserve(BurntInBoxes::kMost);
  reported_ = {};
  grid_ = grid;  // last: what threw is tried again
  reset();
}

bool BurntIn::is_active(const Place& p) const {
  for (int y = p.top; y < p.bottom; ++y)
    for (int x = p.left; x < p.right; ++x)
      if (changes_.changed(grid_.at(x, y))) return true;
  return false;
}

// Grows a box to the left (step -1) or right by the columns that change, unless the blocks above or below change, too.
void BurntIn::grow_row(Place& p, int step) {
  const int top = std::max(p.top - 1, 0), bottom = std::min(p.bottom + 1, grid_.rows);
  const auto any = [&](int x, int from, int end, auto&& is) {
    for (int y = std::max(from, 0); y < std::min(end, grid_.rows); ++y)
      if (is(grid_.at(x, y))) return true;
    return false;
  };
  const auto changes = [&](std::size_t b) { return changes_.changed(b); };
  const auto continues = [&](std::size_t b) {
    return changes_.changed(b) || foreground_[b] > kWhole * parameters_.often;
  };
  for (int x = step < 0 ? p.left - 1 : p.right, empty = 0;
       x >= 0 && x < grid_.columns && empty <= parameters_.gap; x += step) {
    if (!any(x, top, bottom, changes)) {
      ++empty;
      continue;
    }
    if (any(x, top - parameters_.far, top, continues) || any(x, bottom, bottom + parameters_.far, continues))
      return;
    empty = 0;
    Place grown = p;
    grown.left = std::min(p.left, x), grown.right = std::max(p.right, x + 1);
    if (is_too_large(grown)) return;
    p = grown;
  }
}

// What changes in the same frame and in the same row as something learnt belongs to it: the tens with the seconds, the
// minutes with the tens.
void BurntIn::grow_rows() {
  for (Place& p : places_) {
    if (!is_active(p)) continue;
    p.quiet = 0;
    p.changes = true;
    for (const int step : {-1, 1}) grow_row(p, step);
  }
  publish(0);
}

void BurntIn::average_foreground(GrayView mask) {
  for (int row = 0; row < grid_.rows; ++row) {
    const std::size_t begin = grid_.at(0, row);
    find_blocks(mask, 0, grid_, row, bits_, candidate_.data() + begin);
    for (std::size_t first = begin; first < begin + grid_.stride(); first += BlockGrid::kWord) {
      if (!load_counts(candidate_.data() + first) && !load_counts(foreground_.data() + first)) continue;
      for (std::size_t i = first; i < first + BlockGrid::kWord; ++i) {
        const int target = candidate_[i] ? kWhole : 0;
        foreground_[i] = static_cast<std::uint8_t>(foreground_[i] +
                                                   (target - foreground_[i]) / parameters_.foreground_memory);
      }
    }
  }
}

// Returns whether there is no foreground around a place; nor, where the camera stands, changes since the place began to
// change.
bool BurntIn::is_quiet_around(const Place& p, bool still) const {
  double begun = 0;  // seconds ago
  if (still)
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x)
        if (changes_.is_candidate(grid_.at(x, y)))
          begun = std::max(begun, changes_.since_begin(grid_.at(x, y)));
  const auto goes_on = [&](std::size_t b) {
    return foreground_[b] > kWhole * parameters_.often || (still && changes_.since_change(b) <= begun);
  };
  const int far = parameters_.far, beside = still ? far : 0;
  int going_on = 0, around = 0;
  for (int y = std::max(p.top - far, 0); y < std::min(p.bottom + far, grid_.rows); ++y)
    for (int x = std::max(p.left - beside, 0); x < std::min(p.right + beside, grid_.columns); ++x) {
      if (x >= p.left - 1 && x <= p.right && y >= p.top - 1 && y <= p.bottom) continue;
      ++around;
      going_on += goes_on(grid_.at(x, y));
    }
  return going_on <= static_cast<int>(parameters_.around * around);
}

bool BurntIn::changes_together(const Place& p) const {
  const auto for_candidates = [&](auto&& each) {
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x)
        if (changes_.is_candidate(grid_.at(x, y))) each(changes_.since_change(grid_.at(x, y)));
  };
  double newest = parameters_.keep;  // seconds ago; a candidate has changed later
  for_candidates([&](double ago) { newest = std::min(newest, ago); });
  const double within = newest + (parameters_.changes.change_frames + 0.5) * period_;
  int all = 0, together = 0;
  for_candidates([&](double ago) { ++all, together += ago <= within; });
  return together >= parameters_.together * all;
}

bool BurntIn::is_too_large(const Place& p) const {
  return p.right - p.left > parameters_.widest * grid_.columns ||
         p.bottom - p.top > parameters_.highest * grid_.rows;
}

// Grows a place by foreground that lasts beside its static edges: of a running count only the outline is static, and a
// box behind writing is wider than its letters. Above and below, the place grows by half its height at most: a part of
// a person followed by the head has more foreground there.
void BurntIn::grow_foreground(Place& p) const {
  const auto is_foreground = [&](int left, int top, int right, int bottom) {
    int n = 0;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) n += foreground_[grid_.at(x, y)] > kWhole * parameters_.often;
    return n > std::floor(parameters_.often * std::max(right - left, bottom - top));
  };
  for (const int step : {-1, 1})
    for (int x = step < 0 ? p.left - 1 : p.right, empty = 0;
         x >= 0 && x < grid_.columns && empty <= parameters_.gap; x += step) {
      if (!is_foreground(x, p.top, x + 1, p.bottom)) {
        ++empty;
        continue;
      }
      empty = 0;
      p.left = std::min(p.left, x), p.right = std::max(p.right, x + 1);
    }
  const int margin = std::max((p.bottom - p.top) / 2, 1), top = std::max(p.top - margin, 0),
            bottom = std::min(p.bottom + margin, grid_.rows);
  while (p.top > top && is_foreground(p.left, p.top - 1, p.right, p.top)) --p.top;
  while (p.bottom < bottom && is_foreground(p.left, p.bottom, p.right, p.bottom + 1)) ++p.bottom;
}

// The box of the candidates around (x0, y0) that are near one another, across gaps between digits. Takes their marks.
BurntIn::Place BurntIn::take_component(int x0, int y0) {
  Place place{x0, y0, x0 + 1, y0 + 1};
  for (bool grown = true; grown;) {
    grown = false;
    const int gap = parameters_.gap, left = std::max(place.left - gap, 0),
              right = std::min(place.right + gap, grid_.columns);
    for (int y = std::max(place.top - 1, 0); y < std::min(place.bottom + 1, grid_.rows); ++y)
      for (int x = left; x < right; ++x) {
        if (!candidate_[grid_.at(x, y)]) continue;
        candidate_[grid_.at(x, y)] = 0;
        place.left = std::min(place.left, x), place.top = std::min(place.top, y);
        place.right = std::max(place.right, x + 1), place.bottom = std::max(place.bottom, y + 1);
        grown = true;
      }
  }
  return place;
}

void BurntIn::search(bool still) {
  for (std::size_t i = 0; i < candidate_.size(); ++i)
    candidate_[i] = still ? changes_.is_candidate(i) : edges_.is_candidate(i);
  for (int y = 0; y < grid_.rows; ++y)
    for (int x = 0; x < grid_.columns; ++x) {
      if (!candidate_[grid_.at(x, y)]) continue;
      Place place = take_component(x, y);
      if (!still) grow_foreground(place);
      if (is_too_large(place) || !is_quiet_around(place, still)) continue;
      if (still && !changes_together(place)) continue;
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
    Place joined = p;
    joined.left = std::min(p.left, found.left), joined.top = std::min(p.top, found.top);
    joined.right = std::max(p.right, found.right), joined.bottom = std::max(p.bottom, found.bottom);
    if (!is_too_large(joined)) p = joined;
    return;
  }
  if (places_.size() < BurntInBoxes::kMost) places_.push_back(found);
}

// compared: static edges were compared in this frame.
void BurntIn::forget(double seconds, bool still, bool compared) {
  for (Place& p : places_) {
    if (p.changes && still) p.quiet += seconds;
    if (!compared) continue;
    int fixed = 0, moved = 0;
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x)
        fixed += edges_.fixed(grid_.at(x, y)), moved += edges_.moved(grid_.at(x, y));
    if (edges_.is_contrary(fixed, moved))
      p.against += seconds;
    else if (fixed > 0)
      p.against = 0;
  }
  std::erase_if(places_, [&](const Place& p) {
    if (p.quiet <= parameters_.keep && p.against <= parameters_.keep_against) return false;
    for (int y = p.top; y < p.bottom; ++y)
      for (int x = p.left; x < p.right; ++x) {
        const std::size_t block = grid_.at(x, y);
        changes_.forget(block);
        edges_.forget(block);
        foreground_[block] = 0;
      }
    return true;
  });
}

// seconds: since the last search; 0 between searches.
void BurntIn::publish(double seconds) {
  const BurntInBoxes before = found_;
  found_ = {};
  const int margin = parameters_.margin;
  for (Place& p : places_) {
    const double left = std::max(p.left * BlockGrid::kWidth - margin, 0),
                 top = std::max(p.top * BlockGrid::kHeight - margin, 0);
    const Box box{left, top, std::min(p.right * BlockGrid::kWidth + margin, grid_.size.width) - left,
                  std::min(p.bottom * BlockGrid::kHeight + margin, grid_.size.height) - top};
    const auto is_same = [&](const Box& b) {
      return b.x == box.x && b.y == box.y && b.width == box.width && b.height == box.height;
    };
    p.unchanged = std::ranges::any_of(before.boxes(), is_same) ? p.unchanged + seconds : 0;
    const auto overlaps = [&](const Box& other) { return overlap_area(box, other) > 0; };
    if (p.unchanged >= parameters_.settled && reported_.count < BurntInBoxes::kMost &&
        std::ranges::none_of(reported_.boxes(), overlaps)) {
      reported_.box[reported_.count++] = box;
      found_.is_new.set(found_.count);
    }
    found_.box[found_.count++] = box;
  }
}

void BurntIn::look_for(const BurntInInput& in, GrayView mask, double seconds) {
  const bool compared = edges_.compare(in.picture);
  average_foreground(mask);
  search(in.still);
  forget(seconds, in.still, compared);
  edges_.renew(in.picture, now_);
  publish(seconds);
}

bool BurntIn::update(const BurntInInput& in, MutableGrayView mask) {
  prepare(mask.size());
  if (in.seconds > 0) period_ = in.seconds;
  now_ += period_;
  changes_.set_time(now_, period_);
  const std::size_t before = found_.count;
  found_.is_new.reset();
  if (in.still && changes_.update(in.difference, in.threshold)) grow_rows();
  edges_.follow(in.motion);
  const double since = now_ - searched_;
  if (since >= parameters_.search_period - period_ / 2) {
    searched_ = now_;
    look_for(in, mask, since);
  }
  clear_boxes(boxes(), mask);
  return found_.count != before;
}

std::size_t BurntIn::bytes() const {
  return sizeof *this + changes_.bytes() + edges_.bytes() + foreground_.capacity() + candidate_.capacity() +
         bits_.capacity() * sizeof(std::uint64_t);
}

}  // namespace cerberus::vision
