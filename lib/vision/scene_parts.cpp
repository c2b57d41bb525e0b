// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::vision {
namespace {

constexpr double kMovingShare = 0.1;  // of a part that must have moved lately
constexpr double kFreshShare = 0.05;  // of a doubtful part that must move now
constexpr double kEmptyShare = 0.2;   // and of one whose owner may be out of the picture
constexpr int kLeastMoved = 4;        // pixels
// Shares of the taller part's height.
constexpr double kGap = 0.2;       // between neighbours that are one
constexpr double kFrontGap = 1;    // between two fronts of one
constexpr double kPieceGap = 0.5;  // between a part and its pieces, a front and the rest
constexpr double kNarrow = 0.3;    // a front is narrower than this share of its height
constexpr double kLevel = 0.5;     // share of the lower one's height at which they stand beside each other
constexpr double kLeast = 1 / 1280.0;  // share of the picture below which a part says nothing yet
constexpr double kPiece = 1 / 3.0;     // share of the bigger part's area below which a part is a piece

}  // namespace

SceneWindows SceneWindows::of(double seconds) {
  const auto frames = [seconds](double time, int least) {
    return static_cast<int>(std::clamp(std::round(time / seconds), static_cast<double>(least), 250.0));
  };
  return {frames(0.04, 1), frames(0.12, 3), frames(1, 8), frames(2, 8), frames(10, 50)};
}

void SceneParts::make_room(Size picture) {
  labeller_.make_room(picture);
  parts_.reserve(labeller_.limits().components);
}

bool SceneParts::judge(const ScenePlanes& planes, const SceneWindows& windows, MutableBitView mask,
                       MutableBitView absorb) {
  const GrayView &f = planes.present, &m = planes.memory;
  const int w = f.width;
  labeller_.find(mask, w);
  const auto components = labeller_.components();
  parts_.assign(components.size(), {});
  // A memory that has to be registered is believed less: what does not move now is not believed.
  const int lately = planes.still ? windows.lately : windows.now;
  // Somebody whom the camera follows is away from the place he was in within a frame or two.
  const int fresh_window = planes.still ? windows.now : windows.fresh;
  for (const Run& r : labeller_.runs()) {
    Part& part = parts_[r.component];
    const std::uint8_t *quiet = planes.quiet.row(r.row), *age = planes.age.row(r.row);
    int now = 0, before = 0, young = 0, newest = 0;
    for (int x = r.first; x < r.end; ++x)
      now += quiet[x] < fresh_window, before += quiet[x] < lately, young += age[x] < windows.young,
          newest += age[x] < windows.lately;
    part.now += now;
    part.lately += before;
    part.young += young;
    part.newest += newest;
    const auto contrast = [&](int outside, int inside) {
      part.frame += std::abs(f.at(outside, r.row) - f.at(inside, r.row));
      part.memory += std::abs(m.at(outside, r.row) - m.at(inside, r.row));
      ++part.outline;
    };
    if (r.first >= 2) contrast(r.first - 2, std::min(r.first + 1, w - 1));
    if (r.end + 1 < w) contrast(r.end + 1, std::max(r.end - 2, 0));
  }
  for (int y = 0; y < absorb.height; ++y) std::fill_n(absorb.row(y), absorb.width, std::uint64_t{0});
  bool young_objects = false;
  for (const Run& r : labeller_.runs()) {
    const Part& part = parts_[r.component];
    const double area = components[r.component].area;
    const bool object = part.outline > 0 && part.frame > 1.3 * part.memory + 2 * part.outline;
    const bool ghost = part.outline > 0 && part.memory > 1.3 * part.frame + 2 * part.outline;
    // Motion shows at outlines first: of something large and even, a rim as long as its outline is enough.
    const bool moving =
        part.lately >= std::max<double>(kLeastMoved, std::min<double>(kMovingShare * area, part.outline));
    // At the picture's edge the motion of a place that somebody has just left is his last.
    const Component& c = components[r.component];
    const bool was_here = part.memory > 2 * part.frame + 4 * part.outline && part.young > area / 2;
    const bool at_edge = c.left == 0 || c.top == 0 || c.right == w || c.bottom == f.height;
    const double least =
        was_here && at_edge ? std::min<double>(kEmptyShare * area, part.outline) : kFreshShare * area;
    const bool fresh = part.now >= std::max<double>(kLeastMoved, least);
    // What the memory saw only for moments may be an object's place at the start, and outlines tell little where all is
    // textured: like a ghost it needs its owner's motion, or it goes at once. Who walked in a second after the start and
    // stopped has the outline of an object.
    const bool young = planes.still && (part.newest > area / 2 || (part.young > area / 2 && !object));
    const bool doubtful = ghost || young;
    // Where the camera turns, a place that was left is soon far from its owner, and no join() will bring them together.
    const bool left = planes.followed && was_here;
    if (moving && (fresh || !doubtful) && !left) {
      young_objects = young_objects || part.young > area / 2;
      continue;
    }
    if (!(planes.still && object) || doubtful) clear_bits(mask.row(r.row), r.first, r.end);
    for (int x = r.first; x < r.end; ++x) {
      const int patience = planes.still && object
                               ? windows.hold
                               : std::clamp<int>(planes.age.at(x, r.row), kLeastMoved, windows.hold);
      if (doubtful || planes.quiet.at(x, r.row) > patience) set_bits(absorb.row(r.row), x, x + 1);
    }
  }
  return young_objects;
}

void SceneParts::join(const ScenePlanes& planes, const SceneWindows& windows, MutableBitView closed,
                      MutableBitView mask) {
  labeller_.find(closed, planes.present.width);
  const auto components = labeller_.components();
  parts_.assign(components.size(), {});
  for (const Run& r : labeller_.runs()) {
    const std::uint8_t* age = planes.age.row(r.row);
    for (int x = r.first; x < r.end; ++x) parts_[r.component].young += age[x] < windows.young;
  }
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Component& a = components[i];
    if (2 * parts_[i].young < static_cast<int>(a.area)) continue;
    parts_[i].piece = a.area < kLeast * planes.present.size().area();
    for (std::size_t j = 0; j < components.size(); ++j) {
      const Component& b = components[j];
      if (i == j || b.area < a.area || (b.area == a.area && j < i)) continue;
      const int tall = std::max(a.height(), b.height());
      const int across = gap(a.left, a.right, b.left, b.right), down = gap(a.top, a.bottom, b.top, b.bottom);
      const bool level = -down > kLevel * std::min(a.height(), b.height());
      const bool narrow_a = a.width() < kNarrow * a.height(), narrow_b = b.width() < kNarrow * b.height();
      const double reach = narrow_a && narrow_b ? kFrontGap : narrow_a || narrow_b ? kPieceGap : kGap;
      const bool two = a.area >= kPiece * b.area || narrow_a || narrow_b;
      if (level && across > 0 && across < reach * tall && two && !parts_[i].piece) {
        for (int y = std::max(a.top, b.top); y < std::min(a.bottom, b.bottom); ++y)
          set_bits(mask.row(y), std::min(a.right, b.right), std::max(a.left, b.left));
        parts_[i].whole = parts_[j].whole = true;
      } else if (across < kPieceGap * tall && down < kPieceGap * tall && a.area < kPiece * b.area) {
        parts_[i].piece = true;
      }
    }
  }
  for (const Run& r : labeller_.runs())
    if (parts_[r.component].piece && !parts_[r.component].whole) clear_bits(mask.row(r.row), r.first, r.end);
}

std::size_t SceneParts::bytes() const {
  return labeller_.bytes() + parts_.capacity() * sizeof(Part);
}

}  // namespace cerberus::vision
