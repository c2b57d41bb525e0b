// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/components.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "vision/background/background_light.h"
#include "vision/background/component_fronts.h"

namespace cerberus::vision {
namespace {

constexpr double kMovingShare = 0.1;  // of a part that must have moved lately
constexpr double kFreshShare = 0.05;  // of a doubtful part that must move now
constexpr double kEmptyShare = 0.2;   // and of one whose owner may be out of the picture
constexpr int kShake = 3;             // frames a camera moves and stands again
constexpr int kLeastMoved = 4;        // pixels
constexpr int kEdge = 6;              // grey levels of contrast: what is noise to the comparison is so here
// Times as many places of an outline are an edge of the frame only as of the memory only: an object, and one beyond
// doubt.
constexpr double kClear = 2, kSure = 5;
constexpr double kOutline = 0.1;    // share of the outline that says so at least
constexpr double kOwner = 1 / 8.0;  // share of its owner's area that a place has, or an owner of its place's
// Shares of the taller part's height.
constexpr double kGap = 0.2;       // between neighbours that are one
constexpr double kFrontGap = 1;    // between two fronts of one
constexpr double kPieceGap = 0.5;  // between a part and its pieces, a front and the rest
constexpr double kNarrow = 0.3;    // a front is narrower than this share of its height
// Grey levels by which a pixel would surely differ from the memory, and the share of what lies between two fronts of
// one that may be as uneven.
constexpr int kShows = 12;
constexpr double kUneven = 0.25;
constexpr double kLevel = 0.5;  // share of the lower one's height at which they stand beside each other
constexpr double kLeast = 1 / 1280.0;       // share of the picture below which a part says nothing yet
constexpr double kPiece = 1 / 3.0;          // share of the bigger part's area below which a part is a piece
constexpr double kLeastFront = 1 / 2560.0;  // share of the picture below which a part is no front of anybody
constexpr std::size_t kMostFronts = 128;    // parts beyond which a picture is clutter
// More than 320 x 240 pixels can have (labelling.cpp): of larger pictures so many are rain, or snow, and to compare each
// with each other would take longer than a frame.
constexpr std::size_t kMostParts = 512;

struct Between {
  int left, top, right, bottom;
};

// Inside of what moves only an even part differs from nothing. What is uneven over as many pixels as it would have
// moved, the width of the fronts, and has not changed is the scene behind two things.
bool is_even(GrayView frame, const Between& part, int moved) {
  const int step = std::max(std::min(moved, (part.right - part.left) / 2), 1);
  int uneven = 0, seen = 0;
  for (int y = part.top; y < part.bottom; ++y)
    for (int x = part.left; x + step < part.right; ++x) {
      ++seen;
      uneven += std::abs(frame.at(x + step, y) - frame.at(x, y)) > kShows;
    }
  return uneven <= kUneven * seen;
}

}  // namespace

ClassificationWindows ClassificationWindows::of(double seconds) {
  const auto frames = [seconds](double time, int least) {
    return static_cast<int>(std::clamp(std::round(time / seconds), static_cast<double>(least), 250.0));
  };
  return {frames(0.04, 1), frames(0.12, 3), frames(1, 8), frames(2, 8), frames(10, 50)};
}

void ForegroundComponents::preallocate(Size picture) {
  labeller_.preallocate(picture);
  parts_.reserve(labeller_.limits().components);
  origins_.preallocate(picture);
}

void ForegroundComponents::begin() {
  origins_.begin();
  moved_ = kShake;
}

void ForegroundComponents::measure(const ClassificationPlanes& planes, const ClassificationWindows& windows,
                                   BitView mask) {
  const GrayView &f = planes.present, &m = planes.memory;
  const int w = f.width;
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
    const RowSpan shown =
        planes.shown.empty() ? RowSpan{0, w} : planes.shown[static_cast<std::size_t>(r.row)];
    const auto contrast = [&](int outside, int inside) {
      ++part.outline;
      if (outside < shown.begin || outside >= shown.end) return;
      // What has just come into the picture beside a thing is learnt from that thing: its end is no edge of the scene.
      if (!planes.still && age[outside] < std::min(age[inside], kRelearn)) return;
      part.frame += std::abs(f.at(outside, r.row) - f.at(inside, r.row));
      part.memory += std::abs(m.at(outside, r.row) - m.at(inside, r.row));
      ++part.compared;
    };
    if (r.first >= 2) contrast(r.first - 2, std::min(r.first + 1, w - 1));
    if (r.end + 1 < w) contrast(r.end + 1, std::max(r.end - 2, 0));
    if (!planes.still) continue;
    measure_edges(planes, r, mask, part);
    origins_.add(r, part.before);
  }
}

void ForegroundComponents::measure_edges(const ClassificationPlanes& planes, const Run& r, BitView mask,
                                         Part& part) const {
  const GrayView &f = planes.present, &m = planes.memory;
  const auto across = [&](int x_out, int y_out, int x_in, int y_in) {
    const int frame = std::abs(f.at(x_out, y_out) - f.at(x_in, y_in));
    const int memory = std::abs(m.at(x_out, y_out) - m.at(x_in, y_in));
    part.frame_only += frame > kEdge && frame > 2 * memory;
    part.memory_only += memory > kEdge && memory > 2 * frame;
    ++part.places;
  };
  const int w = f.width, h = f.height, y = r.row;
  if (r.first >= 2) across(r.first - 2, y, std::min(r.first + 1, w - 1), y);
  if (r.end + 1 < w) across(r.end + 1, y, std::max(r.end - 2, 0), y);
  const auto along = [&](int beyond, int y_out, int y_in) {
    if (y_out < 0 || y_in < 0 || y_out >= h || y_in >= h) return;
    const std::uint64_t *row = mask.row(y), *next = mask.row(beyond);
    for_words(r.first, r.end, [&](int word, std::uint64_t ones) {
      for (std::uint64_t left = row[word] & ~next[word] & ones; left; left &= left - 1) {
        const int x = 64 * word + std::countr_zero(left);
        across(x, y_out, x, y_in);
      }
    });
  };
  along(y - 1, y - 2, y + 1);
  along(y + 1, y + 2, y - 1);
}

// By itself.
void ForegroundComponents::weigh(const ClassificationPlanes& planes, const Component& c, Part& part) const {
  const Size size = planes.present.size();
  const double area = c.area;
  const bool young = part.young > area / 2, newest = part.newest > area / 2;
  const bool at_edge = c.left == 0 || c.top == 0 || c.right == size.width || c.bottom == size.height;
  const ComponentOrigins::Before& b = part.before;
  const bool here = planes.still && (b.any ? 2 * b.here > b.any : young || (moved_ == 0 && !at_edge));
  part.origin = here ? ComponentOrigins::Origin::here : ComponentOrigins::Origin::elsewhere;
  part.object = part.compared > 0 && part.frame > 1.3 * part.memory + 2 * part.compared;
  part.ghost = part.compared > 0 && part.memory > 1.3 * part.frame + 2 * part.compared;
  // Motion shows at outlines first: of something large and even, a rim as long as its outline is enough.
  part.moving =
      part.lately >= std::max<double>(kLeastMoved, std::min<double>(kMovingShare * area, part.outline));
  // At the picture's edge the motion of a place that somebody has just left is his last.
  const bool was_here = part.memory > 2 * part.frame + 4 * part.compared && young;
  const double least =
      was_here && at_edge ? std::min<double>(kEmptyShare * area, part.outline) : kFreshShare * area;
  part.fresh = part.now >= std::max<double>(kLeastMoved, least);
  // What the memory saw only for moments may be an object's place at the start, and outlines tell little where all is
  // textured: like a ghost it needs its owner's motion, or it goes at once. Who walked in a second after the start and
  // stopped has the outline of an object.
  part.doubtful = part.ghost || (planes.still && (newest || (young && !part.object)));
  // What a camera that moves has learnt for moments only may be anybody's place: who rests altogether in this frame is
  // an object if his outline says so. That of a small part says nothing.
  const bool rests =
      !planes.still && young && part.now < kLeastMoved && area >= kLeast * static_cast<double>(size.area());
  // Where the camera turns, a place that was left is soon far from its owner, and no join() will bring them together.
  part.kept = part.moving && (part.fresh || !part.doubtful) && (part.object || !rests) &&
              !(planes.followed && was_here);
}

// Where somebody stood since the scene began the memory has his picture. He goes, the place stays: what rests while
// something moves on that began there, too, is a place, unless its outline leaves no doubt. By itself the outline of a
// piece of a place tells little: it ends where what stood there and what is there now happen to be alike. That of a
// small piece tells nothing.
void ForegroundComponents::find_places() {
  const auto components = labeller_.components();
  for (std::size_t i = 0; i < components.size(); ++i) {
    Part& part = parts_[i];
    const Component& a = components[i];
    const bool newest = 2 * part.newest > static_cast<int>(a.area);
    const bool sure =
        part.object && !newest && part.frame_only > kSure * part.memory_only + kOutline * part.places;
    if (part.fresh || part.origin != ComponentOrigins::Origin::here) continue;
    for (std::size_t j = 0; j < components.size(); ++j) {
      const Part& other = parts_[j];
      if (!other.moving || !other.fresh || other.ghost || other.origin != ComponentOrigins::Origin::here)
        continue;
      const Component& b = components[j];
      if (sure && a.area >= kOwner * b.area) continue;
      if (b.area > kOwner * a.area && are_within(std::max(a.height(), b.height()), a, b)) {
        part.doubtful = true, part.kept = false;
        break;
      }
    }
  }
}

// Whose place has been found came from there, and is an object wherever it stops. A piece of a place beside another one
// is no such thing: its outline is not clear.
void ForegroundComponents::find_owners() {
  const auto components = labeller_.components();
  for (std::size_t i = 0; i < components.size(); ++i) {
    Part& part = parts_[i];
    if (part.origin != ComponentOrigins::Origin::here || !part.moving || !part.fresh || part.ghost) continue;
    if (!part.object || part.frame_only < kClear * part.memory_only) continue;
    const Component& a = components[i];
    for (std::size_t j = 0; j < components.size(); ++j) {
      const Component& b = components[j];
      if (parts_[j].kept || !parts_[j].ghost) continue;
      if (b.area >= kOwner * a.area && are_within(std::max(a.height(), b.height()), a, b)) {
        part.origin = ComponentOrigins::Origin::found;
        break;
      }
    }
  }
}

bool ForegroundComponents::judge(const ClassificationPlanes& planes, const ClassificationWindows& windows,
                                 MutableBitView mask, MutableBitView absorb) {
  labeller_.find(mask, planes.present.width);
  const auto components = labeller_.components();
  parts_.assign(components.size(), {});
  // A shake is over before anything has gone far.
  if (!planes.still && ++moved_ == kShake) origins_.begin();
  measure(planes, windows, mask);
  for (std::size_t i = 0; i < components.size(); ++i) weigh(planes, components[i], parts_[i]);
  if (planes.still) {
    if (components.size() <= kMostParts) {
      find_places();
      find_owners();
    }
    for (const Run& r : labeller_.runs()) origins_.note(r, parts_[r.component].origin);
  }
  bool young_objects = false;
  for (std::size_t i = 0; i < components.size(); ++i)
    young_objects =
        young_objects || (parts_[i].kept && 2 * parts_[i].young > static_cast<int>(components[i].area));
  for (int y = 0; y < absorb.height; ++y) std::fill_n(absorb.row(y), absorb.width, std::uint64_t{0});
  for (const Run& r : labeller_.runs()) {
    const Part& part = parts_[r.component];
    if (part.kept) continue;
    for (int x = r.first; x < r.end; ++x) {
      const int patience = planes.still && part.object
                               ? windows.hold
                               : std::clamp<int>(planes.age.at(x, r.row), kLeastMoved, windows.hold);
      if (part.doubtful || planes.quiet.at(x, r.row) > patience) set_bits(absorb.row(r.row), x, x + 1);
    }
  }
  if (planes.still) origins_.step(mask, absorb);
  for (const Run& r : labeller_.runs()) {
    const Part& part = parts_[r.component];
    if (!part.kept && (!(planes.still && part.object) || part.doubtful))
      clear_bits(mask.row(r.row), r.first, r.end);
  }
  if (planes.still) moved_ = 0;
  return young_objects;
}

void ForegroundComponents::join(const ClassificationPlanes& planes, const ClassificationWindows& windows,
                                MutableBitView closed, MutableBitView mask) {
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
    for (std::size_t j = 0; components.size() <= kMostParts && j < components.size(); ++j) {
      const Component& b = components[j];
      if (i == j || b.area < a.area || (b.area == a.area && j < i)) continue;
      const int tall = std::max(a.height(), b.height());
      const int across = gap(a.left, a.right, b.left, b.right), down = gap(a.top, a.bottom, b.top, b.bottom);
      const Between between{std::min(a.right, b.right), std::max(a.top, b.top), std::max(a.left, b.left),
                            std::min(a.bottom, b.bottom)};
      const bool level = -down > kLevel * std::min(a.height(), b.height());
      const bool narrow_a = a.width() < kNarrow * a.height(), narrow_b = b.width() < kNarrow * b.height();
      const double reach = narrow_a && narrow_b ? kFrontGap : narrow_a || narrow_b ? kPieceGap : kGap;
      const bool two = a.area >= kPiece * b.area || narrow_a || narrow_b;
      if (level && across > 0 && across < reach * tall && two && !parts_[i].piece &&
          is_even(planes.present, between, std::min(a.width(), b.width()))) {
        for (int y = between.top; y < between.bottom; ++y) set_bits(mask.row(y), between.left, between.right);
        parts_[i].whole = parts_[j].whole = true;
      } else if (across < kPieceGap * tall && down < kPieceGap * tall && a.area < kPiece * b.area) {
        parts_[i].piece = true;
      }
    }
  }
  for (const Run& r : labeller_.runs())
    if (parts_[r.component].piece && !parts_[r.component].whole) clear_bits(mask.row(r.row), r.first, r.end);
}

void ForegroundComponents::join_fronts(const ClassificationPlanes& planes, MutableBitView closed,
                                       MutableBitView mask) {
  if (!planes.still || labeller_.components().size() < 2) return;
  const Size size = planes.present.size();
  const auto parts =
      labeller_.find(closed, size.width, static_cast<std::uint32_t>(kLeastFront * size.area()));
  if (parts.size() <= kMostFronts) vision::join_fronts(planes.present, parts, mask);
}

std::size_t ForegroundComponents::bytes() const {
  return labeller_.bytes() + parts_.capacity() * sizeof(Part) + origins_.bytes();
}

}  // namespace cerberus::vision
