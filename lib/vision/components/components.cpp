// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/components.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "vision/components/component_sides.h"
#include "vision/components/fragment_joining.h"

namespace cerberus::vision {
namespace {

// Origin unknown where none is given: kept from the first version. Guard of all: mean F of bench-quality and the cases
// of unit-components.
constexpr struct Parameters {
  // One component by itself.
  double recent_share = 0.1;   // of its area that must have moved within `recent`
  double moving_share = 0.05;  // of a doubtful one that must be moving
  double empty_share =
      0.2;              // of one that was background before, at the picture's edge: its object may have left
  int least_moved = 4;  // pixels: fewer are noise
  int least_rest = 4;   // ticks for which what is not kept rests before it is absorbed
  int shake = 3;        // frames within which a shaken camera has not moved away from what it saw
  double least_ghost = 1 / 8.0;    // of an object's area that its ghost has, and the other way round
  double least_area = 1 / 1280.0;  // of the picture: the outline of a smaller component is no evidence

  // Neighbours. Gaps are shares of the taller one's height.
  double gap = 0.2;           // between two of similar size
  double narrow_gap = 1;      // between two narrow ones
  double fragment_gap = 0.5;  // between one and its fragment, or a narrow one and the rest
  double narrow = 0.3;        // a narrow one's width, of its height
  double level = 0.5;         // of the lower one's height at which they stand beside each other
  double fragment = 1 / 3.0;  // of the larger one's area: below, a component is a fragment

  // Derived: more than 320 x 240 pixels can have (labelling.cpp). So many in a larger picture are rain or snow, and the
  // comparison of all pairs would take longer than a frame.
  std::size_t most_components = 512;
} kParameters;

}  // namespace

FrameWindows FrameWindows::of(double seconds) {
  const auto whole = [](double time, double unit, int least) {
    return static_cast<int>(std::clamp(std::round(time / unit), static_cast<double>(least), 250.0));
  };
  const int tick = whole(0.04, seconds, 1);
  const auto ticks = [&](double time, int least) { return whole(time, tick * seconds, least); };
  return {ticks(0.04, 1),       ticks(0.12, 3),       ticks(1, 8), ticks(10, 50),
          whole(1, seconds, 8), whole(2, seconds, 8), tick,        seconds};
}

void ForegroundComponents::preallocate(Size picture) {
  labeller_.preallocate(picture);
  evidence_.reserve(labeller_.limits().components);
  flashes_.preallocate(picture, labeller_.limits().components);
  origins_.preallocate(picture);
  resting_ghosts_.preallocate(picture);
}

void ForegroundComponents::reset() {
  flashes_.reset();
  origins_.reset();
  moved_ = kParameters.shake;
}

void ForegroundComponents::measure(const ComponentInput& input, const FrameWindows& windows) {
  const int w = input.frame.width;
  // A background that had to be registered is less reliable: only present motion counts.
  const int recent_window = input.still ? windows.recent : windows.moving;
  // A person followed by the camera leaves the place in the picture within a frame or two.
  const int moving_window = input.still ? windows.moving : windows.fresh;
  for (const Run& r : labeller_.runs()) {
    Evidence& evidence = evidence_[r.component];
    const std::uint8_t *quiet = input.quiet.row(r.row), *age = input.age.row(r.row);
    int moving = 0, recent = 0, young = 0, newest = 0;
    for (int x = r.first; x < r.end; ++x)
      moving += quiet[x] < moving_window, recent += quiet[x] < recent_window, young += age[x] < windows.young,
          newest += age[x] < windows.newest;
    evidence.moving_pixels += moving;
    evidence.recent_pixels += recent;
    evidence.young_pixels += young;
    evidence.newest_pixels += newest;
    const RowSpan visible = input.columns().of(r.row);
    const auto contrast = [&](int outside, int inside) {
      ++evidence.outline;
      if (outside < visible.begin || outside >= visible.end) return;
      // Pixels that entered the picture beside an object were learnt from that object: they hold no background edge.
      if (!input.still && age[outside] < std::min(age[inside], kRelearn)) return;
      evidence.contrast.add(input.frame, input.background, r.row, outside, inside);
    };
    if (r.first >= 2) contrast(r.first - 2, std::min(r.first + 1, w - 1));
    if (r.end + 1 < w) contrast(r.end + 1, std::max(r.end - 2, 0));
    if (input.still) origins_.add_overlap(r, evidence.overlap);
  }
}

// Decides about one component by its own evidence.
void ForegroundComponents::decide(const ComponentInput& input, const Component& c, Evidence& evidence) const {
  const Parameters& p = kParameters;
  const Size size = input.frame.size();
  const double area = c.area;
  const bool young = evidence.young_pixels > area / 2, newest = evidence.newest_pixels > area / 2;
  const bool at_edge = c.left == 0 || c.top == 0 || c.right == size.width || c.bottom == size.height;
  const ComponentOrigins::Overlap& before = evidence.overlap;
  const bool inside =
      input.mechanisms.origins && input.still &&
      (before.differed ? 2 * before.inside > before.differed : young || (moved_ == 0 && !at_edge));
  evidence.origin = inside ? ComponentOrigins::Origin::inside : ComponentOrigins::Origin::outside;
  evidence.object = evidence.contrast.is_object();
  evidence.ghost = evidence.contrast.is_ghost();
  // Motion shows at outlines first. Of a large even object a rim as long as its outline is enough.
  evidence.moved_recently =
      evidence.recent_pixels >=
      std::max<double>(p.least_moved, std::min<double>(p.recent_share * area, evidence.outline));
  // At the picture's edge the motion of a place that an object has just left is that object's last.
  const bool was_empty = input.mechanisms.was_empty && young && evidence.contrast.is_certain_ghost();
  const double least =
      was_empty && at_edge ? std::min<double>(p.empty_share * area, evidence.outline) : p.moving_share * area;
  evidence.moving = evidence.moving_pixels >= std::max<double>(p.least_moved, least);
  // A background learnt for moments may show an object that stood there at the start, and outlines are weak evidence in
  // texture. Such a component needs motion like a ghost, or is absorbed at once. A person who walked in a second after
  // the start and stopped has an object's outline.
  evidence.doubtful = evidence.ghost || (input.still && (newest || (young && !evidence.object)));
  // A moving camera has learnt a young background for moments only: a component at rest is an object only by its
  // outline. The outline of a small component is no evidence.
  const bool rests = !input.still && young && evidence.moving_pixels < p.least_moved &&
                     area >= p.least_area * static_cast<double>(size.area());
  // Before a turning camera a ghost is soon far from its object, beyond the reach of merge_neighbours().
  evidence.kept = evidence.moved_recently && (evidence.moving || !evidence.doubtful) &&
                  (evidence.object || !rests) && !(input.registered && was_empty);
}

// The model shows an object that has stood there since the model's start. When the object leaves, its ghost stays. A
// component at rest is a ghost if another one of the same origin moves nearby, unless its outline is certainly an object's.
// That of a small fragment is no evidence.
void ForegroundComponents::find_ghosts() {
  const auto components = labeller_.components();
  for (std::size_t i = 0; i < components.size(); ++i) {
    Evidence& evidence = evidence_[i];
    const Component& a = components[i];
    if (evidence.moving || evidence.origin != ComponentOrigins::Origin::inside) continue;
    const bool newest = 2 * evidence.newest_pixels > static_cast<int>(a.area);
    for (std::size_t j = 0; j < components.size(); ++j) {
      const Evidence& other = evidence_[j];
      if (!other.moved_recently || !other.moving || other.ghost ||
          other.origin != ComponentOrigins::Origin::inside)
        continue;
      const Component& b = components[j];
      if (evidence.contrast.is_certain_object() && !newest && a.area >= kParameters.least_ghost * b.area)
        continue;
      if (b.area > kParameters.least_ghost * a.area && are_within(std::max(a.height(), b.height()), a, b)) {
        evidence.doubtful = true, evidence.kept = false;
        break;
      }
    }
  }
}

bool ForegroundComponents::classify(const ComponentInput& input, const FrameWindows& windows,
                                    MutableBitView mask, MutableBitView absorb) {
  labeller_.find(mask, input.frame.width);
  const auto components = labeller_.components();
  evidence_.assign(components.size(), {});
  if (!input.still && ++moved_ == kParameters.shake) {
    origins_.reset();
    flashes_.reset();
  }
  measure(input, windows);
  for (std::size_t i = 0; i < components.size(); ++i) decide(input, components[i], evidence_[i]);
  if (input.is_aligned() && input.mechanisms.sides_go_on) doubt_edges(input, mask);
  if (input.mechanisms.flashes && input.still) remove_flashes(input, windows, mask);
  if (input.still) {
    if (components.size() <= kParameters.most_components) find_ghosts();
    for (const Run& r : labeller_.runs()) origins_.record(r, evidence_[r.component].origin);
  }
  bool young_objects = false;
  for (std::size_t i = 0; i < components.size(); ++i)
    young_objects = young_objects || (evidence_[i].kept &&
                                      2 * evidence_[i].young_pixels > static_cast<int>(components[i].area));
  absorb_rest(input, windows, absorb);
  if (input.still) origins_.step(mask, absorb);
  for (const Run& r : labeller_.runs()) {
    const Evidence& evidence = evidence_[r.component];
    if (!evidence.kept && (!(input.still && evidence.object) || evidence.doubtful))
      clear_bits(mask.row(r.row), r.first, r.end);
  }
  // Not only where the picture is aligned: the contrasts that a ghost's outline must have are strict enough.
  if (input.mechanisms.resting_ghosts)
    resting_ghosts_.remove(
        {input.frame, input.background, input.quiet, input.still ? GrayView{} : input.age, input.columns()},
        windows.recent, labeller_, mask, absorb);
  origins_.forget(absorb);
  if (input.still) moved_ = 0;
  return young_objects;
}

// Flashes are neither objects nor, as the doubtful are, taken over by the model.
void ForegroundComponents::remove_flashes(const ComponentInput& input, const FrameWindows& windows,
                                          BitView mask) {
  flashes_.find(input.frame.size(), mask, labeller_.components(), labeller_.runs(), windows.seconds);
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    Evidence& evidence = evidence_[i];
    evidence.flash = flashes_.is_flash(i, labeller_.components()[i]);
    if (evidence.flash) evidence.kept = evidence.object = evidence.doubtful = false;
  }
}

// What rests and is an object by its sides only is none where these are edges of the scene.
void ForegroundComponents::doubt_edges(const ComponentInput& input, BitView mask) {
  const auto components = labeller_.components();
  if (components.size() > kParameters.most_components) return;
  for (std::size_t i = 0; i < components.size(); ++i) {
    Evidence& evidence = evidence_[i];
    if (!evidence.object || evidence.moved_recently ||
        !sides_go_on(input.frame, input.columns(), mask, labeller_.runs(), i))
      continue;
    evidence.object = false;
    evidence.doubtful = evidence.doubtful || 2 * evidence.young_pixels > static_cast<int>(components[i].area);
  }
}

// absorb := pixels of the components that are not kept: doubtful ones at once, the others after as long at rest as the
// background had been learnt for, objects before a standing camera after `hold`.
void ForegroundComponents::absorb_rest(const ComponentInput& input, const FrameWindows& windows,
                                       MutableBitView absorb) const {
  for (int y = 0; y < absorb.height; ++y) std::fill_n(absorb.row(y), absorb.width, std::uint64_t{0});
  for (const Run& r : labeller_.runs()) {
    const Evidence& evidence = evidence_[r.component];
    if (evidence.kept || evidence.flash) continue;
    for (int x = r.first; x < r.end; ++x) {
      const int age = input.age.at(x, r.row);  // 255: or more
      const int patience = (input.still && evidence.object) || age == 255
                               ? windows.hold
                               : std::clamp(age / windows.tick, kParameters.least_rest, windows.hold);
      if (evidence.doubtful || input.quiet.at(x, r.row) > patience) set_bits(absorb.row(r.row), x, x + 1);
    }
  }
}

void ForegroundComponents::merge_neighbours(const ComponentInput& input, const FrameWindows& windows,
                                            MutableBitView closed, MutableBitView mask) {
  if (!input.mechanisms.merge_neighbours) return;
  const Parameters& p = kParameters;
  labeller_.find(closed, input.frame.width);
  const auto components = labeller_.components();
  evidence_.assign(components.size(), {});
  for (const Run& r : labeller_.runs()) {
    const std::uint8_t* age = input.age.row(r.row);
    for (int x = r.first; x < r.end; ++x) evidence_[r.component].young_pixels += age[x] < windows.young;
  }
  const auto is_object = [&](std::size_t i, bool right, const Rows& rows) {
    return is_side_of_object(input.frame, input.background, input.columns(), labeller_.runs(), i, right,
                             rows);
  };
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Component& a = components[i];
    if (2 * evidence_[i].young_pixels < static_cast<int>(a.area)) continue;
    evidence_[i].fragment = a.area < p.least_area * input.frame.size().area();
    const Rows own{a.top, a.bottom};
    std::optional<bool> sides;  // are both its own an object's? Asked for once
    for (std::size_t j = 0; components.size() <= p.most_components && j < components.size(); ++j) {
      const Component& b = components[j];
      if (i == j || b.area < a.area || (b.area == a.area && j < i)) continue;
      const int tall = std::max(a.height(), b.height());
      const int across = gap(a.left, a.right, b.left, b.right), down = gap(a.top, a.bottom, b.top, b.bottom);
      const Gap between{std::min(a.right, b.right), std::max(a.top, b.top), std::max(a.left, b.left),
                        std::min(a.bottom, b.bottom)};
      const bool level = -down > p.level * std::min(a.height(), b.height());
      const bool narrow_a = a.width() < p.narrow * a.height(), narrow_b = b.width() < p.narrow * b.height();
      const double reach = narrow_a && narrow_b   ? p.narrow_gap
                           : narrow_a || narrow_b ? p.fragment_gap
                                                  : p.gap;
      const bool two = a.area >= p.fragment * b.area || narrow_a || narrow_b;
      const Rows beside{between.top, between.bottom};
      const bool a_is_left = a.left < b.left;
      if (level && across > 0 && across < reach * tall && two && !evidence_[i].fragment &&
          is_even(input.frame, between, std::min(a.width(), b.width())) &&
          !(input.is_aligned() && is_object(i, a_is_left, beside) && is_object(j, !a_is_left, beside))) {
        for (int y = between.top; y < between.bottom; ++y) set_bits(mask.row(y), between.left, between.right);
        evidence_[i].merged = evidence_[j].merged = true;
      } else if (!evidence_[i].fragment && across < p.fragment_gap * tall && down < p.fragment_gap * tall &&
                 a.area < p.fragment * b.area) {
        if (!sides) sides = input.still && is_object(i, true, own) && is_object(i, false, own);
        evidence_[i].fragment = !*sides;
      }
    }
  }
  for (const Run& r : labeller_.runs())
    if (evidence_[r.component].fragment && !evidence_[r.component].merged)
      clear_bits(mask.row(r.row), r.first, r.end);
}

void ForegroundComponents::join_fragments(const ComponentInput& input, MutableBitView closed,
                                          MutableBitView mask) {
  if (!input.still) return;
  const Size size = input.frame.size();
  const auto components =
      labeller_.find(closed, size.width, static_cast<std::uint32_t>(kParameters.least_area * size.area()));
  if (components.size() <= kParameters.most_components) vision::join_fragments(input.frame, components, mask);
}

std::size_t ForegroundComponents::bytes() const {
  return labeller_.bytes() + evidence_.capacity() * sizeof(Evidence) + flashes_.bytes() + origins_.bytes() +
         resting_ghosts_.bytes();
}

}  // namespace cerberus::vision
