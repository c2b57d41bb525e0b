// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/regions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "vision/detection/region_parameters.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"
#include "vision/image/morphology.h"
#include "vision/image/preallocate.h"

namespace cerberus::vision {
namespace {

constexpr std::size_t kMostParts = 128;  // components beyond which a picture is clutter, not people
constexpr std::size_t kMostBlocks = 16;  // cars and the like at a time
constexpr std::size_t kMostRegions = 2 * kMostParts;  // persons and the components that they do not explain

// Returns whether a component may be one person: upright, reasonably filled, and not cut by the picture's edge.
bool looks_like_one_person(const Component& c, const Bounds& body, Size picture, const RegionParameters& p) {
  const double aspect = static_cast<double>(body.height()) / body.width();
  return aspect > p.widest && aspect < p.narrowest &&
         c.area > p.least_filled * body.width() * body.height() && c.left > 0 && c.top > 0 &&
         c.right < picture.width && c.bottom < picture.height;
}

Box box_of(const Bounds& w) {
  return {static_cast<double>(w.left), static_cast<double>(w.top), static_cast<double>(w.width()),
          static_cast<double>(w.height())};
}

}  // namespace

struct RegionFinder::State {
  explicit State(const DetectionParameters& numbers = {}) : parameters(numbers) {}

  const DetectionParameters parameters;
  RegionOptions options;
  Size size;
  BitMask moving, closed;
  Change change;  // of this frame
  Morphology morphology;
  Labeller labeller;
  BlobParting parting{parameters.parting};
  HeightPrior prior{parameters.height};
  PeopleFinder people{parameters.people};
  TwoFrameConfirmation newcomers{parameters.confirmation};
  std::vector<Box> blocks, blocks_before;  // groups too wide and too solid for people, now and a frame ago
  std::vector<int> group;                  // of each component
  OutlineFinder outline_finder{parameters.outline};
  std::vector<Outline> outlines;             // of each component
  WalkingBodies walkers{parameters.bodies};  // isolated blobs that look like one person
  WalkingBodies bodies{parameters.bodies};   // with a free head
  std::vector<Region> regions;
  int seen = 0;  // frames of this scene

  std::uint32_t least() const {
    return static_cast<std::uint32_t>(
        options.minimum_area > 0 ? options.minimum_area : parameters.regions.least_share * size.area());
  }
  void preallocate(Size picture);
  void find_components();
  void learn();
  void group_components();
  void explain(int group);
  void explain_unknown(int group, const Bounds& window);
  double walked(const Box& body, const Bounds& window);
  double changed(const Box& body) const;
  void add_plain(std::size_t component, RegionKind kind = RegionKind::thing);
  RegionKind kind_of(const Component& unexplained) const;
  double unexplained(const Bounds& window, std::span<const Person> people) const;
  void add_people(int group, const Bounds& window, std::span<const Person> people);
  long moving_in(const Box& box) const;
};

void RegionFinder::State::preallocate(Size picture) {
  for (BitMask* bits : {&moving, &closed}) bits->resize(bit_mask_size(picture));
  labeller.preallocate(picture);
  parting.preallocate(picture.width);
  people.preallocate(picture);
  newcomers.preallocate();
  const std::size_t parts = labeller.limits().components;
  vision::preallocate(blocks, kMostBlocks);
  vision::preallocate(blocks_before, kMostBlocks);
  vision::preallocate(group, std::min(parts, kMostParts));
  outline_finder.preallocate(picture.width);
  vision::preallocate(outlines, parts);
  walkers.preallocate();
  bodies.preallocate();
  vision::preallocate(regions, std::max(parts, std::min(2 * parts, kMostRegions)));
  size = picture;  // assigned last: after a failed allocation the next call tries again
}

// Finds the components of the closed mask. Blobs are parted where the height of people is not known: where it is,
// PeopleFinder does that. Clutter is left alone.
void RegionFinder::State::find_components() {
  const auto blobs = labeller.find(closed.view(), size.width, least());
  if (!options.people || blobs.size() > kMostParts) return;
  bool parted = false;
  for (std::size_t i = 0; i < blobs.size(); ++i)
    if (prior.height(blobs[i].bottom) <= 0)
      parted |= parting.part(blobs[i], i, labeller.runs(), moving.view(), change, closed.view());
  if (parted) labeller.find(closed.view(), size.width, least());
}

// Only walkers are samples of the height prior: blobs that look like one person, isolated, of the same height for three
// frames, and moving. Fragments of a person close by come in crowds, flicker and stay in place.
void RegionFinder::State::learn() {
  const RegionParameters& p = parameters.regions;
  const auto parts = labeller.components();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Component& c = parts[i];
    const Bounds& body = outlines[i].body;
    if (!looks_like_one_person(c, body, size, p)) continue;
    const double reach = p.alone * c.height();
    const bool alone = std::none_of(parts.begin(), parts.end(),
                                    [&](const Component& o) { return &o != &c && are_within(reach, c, o); });
    const double height = c.height();
    const Box box{static_cast<double>(body.left), static_cast<double>(c.top),
                  static_cast<double>(body.width()), height};
    if (alone && walkers.add(box).farthest > p.walked) prior.learn(c.bottom, height, height);
  }
}

// Components that may be pieces of one person: one above the other within half a body height, or almost touching.
void RegionFinder::State::group_components() {
  const RegionParameters& p = parameters.regions;
  const auto parts = labeller.components();
  group.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    group[i] = static_cast<int>(i);
    for (std::size_t j = 0; j < i; ++j) {
      const Component &a = parts[i], &b = parts[j];
      const double height = prior.height(std::max(a.bottom, b.bottom));
      if (height <= 0) continue;
      const int across = gap(a.left, a.right, b.left, b.right), down = gap(a.top, a.bottom, b.top, b.bottom);
      if (across > p.across * height || down > p.down * height ||
          std::max(a.bottom, b.bottom) - std::min(a.top, b.top) > p.joined * height)
        continue;
      const int from = group[i], to = group[j];
      for (std::size_t k = 0; k <= i; ++k)
        if (group[k] == from || group[k] == to) group[k] = std::min(from, to);
    }
  }
}

// What no person explains, where no block was found.
RegionKind RegionFinder::State::kind_of(const Component& c) const {
  const double expected = prior.height(c.bottom);
  if (expected <= 0) return RegionKind::group;
  if (c.height() > parameters.regions.tallest * expected) return RegionKind::thing;
  return c.height() < parameters.regions.usual_least * expected ? RegionKind::part : RegionKind::group;
}

void RegionFinder::State::add_plain(std::size_t i, RegionKind kind) {
  const RegionParameters& p = parameters.regions;
  const bool person = kind == RegionKind::person_like;
  const Component& c = labeller.components()[i];
  if (regions.size() == regions.capacity()) return;
  Box box = box_of(outlines[i].whole);
  const double filled = c.area / box.area();
  // An object that was there when the scene began uncovers its place: the foreground edge has the object on one side
  // and the place on the other, and in a young scene they cannot be distinguished. The box takes in both.
  if (options.people && !person && seen <= p.young) {
    const double rim = std::max(1.0, std::round(p.rim * size.width / 320));
    const double left = std::max(box.x - rim, 0.0), top = std::max(box.y - rim, 0.0);
    box = {left, top, std::min(box.right() + rim, static_cast<double>(size.width)) - left,
           std::min(box.bottom() + rim, static_cast<double>(size.height)) - top};
  }
  regions.push_back({box, 0,
                     person ? std::min(1.0, p.confidence + (1 - p.confidence) * filled)
                            : std::min(1.0, p.confidence * filled),
                     static_cast<int>(i) + 1, kind});
}

// Pixels of the cleaned mask whose centres lie in the box.
long RegionFinder::State::moving_in(const Box& box) const {
  const auto side = [](double at, int most) {
    return std::clamp(static_cast<int>(std::ceil(at - 0.5)), 0, most);
  };
  const int left = side(box.x, size.width), right = side(box.right(), size.width);
  long pixels = 0;
  for (int y = side(box.y, size.height); y < side(box.bottom(), size.height); ++y) {
    const std::uint64_t* row = closed.view().row(y);
    for_words(left, right, [&](int word, std::uint64_t ones) { pixels += std::popcount(row[word] & ones); });
  }
  return pixels;
}

// Share of the moving pixels in the window that lie in no person's box, nor just outside.
double RegionFinder::State::unexplained(const Bounds& window, std::span<const Person> found) const {
  long all = 0, beside = 0;
  for (int y = window.top; y < window.bottom; ++y)
    for_words(window.left, window.right, [&](int word, std::uint64_t ones) {
      std::uint64_t rest = moving.view().row(y)[word] & ones;
      if (!rest) return;
      all += std::popcount(rest);
      // The first bit of the word at or beyond a place.
      const auto bit = [&](double x) {
        return static_cast<int>(std::clamp(std::ceil(x) - 64 * word, 0.0, 64.0));
      };
      for (const Person& person : found) {
        const Box& b = person.box;
        const double slack = parameters.regions.slack * b.height;
        if (y < b.y - slack || y >= b.bottom() + slack) continue;
        const int first = bit(b.x - slack), end = bit(b.right() + slack);
        if (first < end) rest &= ~bits_between(first, end);
      }
      beside += std::popcount(rest);
    });
  return all > 0 ? static_cast<double>(beside) / static_cast<double>(all) : 0;
}

// Persons, and the components of the group that they do not explain.
void RegionFinder::State::add_people(int g, const Bounds& window, std::span<const Person> found) {
  const auto parts = labeller.components();
  const auto first = std::ranges::find(group, g) - group.begin();
  for (std::size_t k = 0; k < found.size() && regions.size() < regions.capacity(); ++k)
    regions.push_back({fit_box(moving.view(), change, window, k, found, parameters.box), 0,
                       std::clamp(0.5 + 0.5 * found[k].score, 0.5, 1.0), static_cast<int>(first) + 1,
                       RegionKind::person_like});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (group[i] != g) continue;
    const Box box = box_of(outlines[i].body);
    double covered = 0;
    for (const Person& person : found) covered += overlap_area(person.box, box);
    if (covered < parameters.regions.explained * box.area())
      add_plain(i, people.found_wide_block() ? RegionKind::thing : kind_of(parts[i]));
  }
}

// Records a body of this frame. Returns how far it has been from its first place, in heights of the body, its head free
// frame after frame; 0: it stands, or its head is hidden. It teaches its height by every stride, as a walker does: where
// people are never alone, and where the line of the heights is steeper than expected. window: of its blob. Where the picture
// cuts off its feet, its height is not known.
double RegionFinder::State::walked(const Box& body, const Bounds& window) {
  if (!has_free_head(moving.view(), size, body, parameters.head)) return 0;
  const WalkingBodies::Walk walk = bodies.add(body, changed(body) >= parameters.regions.stirs);
  const bool cut =
      window.bottom == size.height && body.bottom() > size.height - parameters.regions.feet * body.height;
  if (walk.goes_on && !cut) prior.learn(body.bottom(), body.height, body.height);
  return walk.farthest;
}

// Share of a body's foreground that differs from the frame before: the place that a person has left rests.
double RegionFinder::State::changed(const Box& body) const {
  const int left = std::clamp(static_cast<int>(body.x), 0, size.width),
            right = std::clamp(static_cast<int>(body.right()), 0, size.width);
  long all = 0, changed = 0;
  for (int y = std::max(0, static_cast<int>(body.y));
       y < std::min(size.height, static_cast<int>(body.bottom())); ++y)
    for_bits(moving.view().row(y), left, right, [&](int x) {
      ++all;
      changed += change.at(x, y);
    });
  return all > 0 ? static_cast<double>(changed) / static_cast<double>(all) : 0;
}

// A blob before the height of people is known. The bodies that explain it are persons where their heads are seen and they
// walk: bodies explain cars, noise and the place that a person has left as well. Otherwise several bodies are a group, and
// so is one that leaves much unexplained, if there are the gaps that people leave.
void RegionFinder::State::explain_unknown(int g, const Bounds& window) {
  const RegionParameters& p = parameters.regions;
  const auto found = people.find(moving.view(), window, prior);
  std::array<Person, PeopleFinder::kMostPeople> persons;
  const auto end = std::ranges::copy_if(found, persons.begin(), [&](const Person& person) {
                     return walked(person.box, window) > p.walked;
                   }).out;
  const std::span<const Person> walking(persons.begin(), end);
  const double rest = unexplained(window, found);
  if (!walking.empty() && !(found.size() == 1 && rest > p.loose)) return add_people(g, window, walking);
  const bool several = !people.found_block() && (found.size() > 1 || (found.size() == 1 && rest > p.beside));
  add_plain(static_cast<std::size_t>(g), several ? RegionKind::group : RegionKind::thing);
}

// One group of components: persons, or what it is otherwise.
void RegionFinder::State::explain(int g) {
  const RegionParameters& p = parameters.regions;
  const auto parts = labeller.components();
  Bounds window{size.width, size.height, 0, 0}, body = window;
  int members = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (group[i] != g) continue;
    ++members;
    const auto unite = [](Bounds& all, int left, int top, int right, int bottom) {
      all = {std::min(all.left, left), std::min(all.top, top), std::max(all.right, right),
             std::max(all.bottom, bottom)};
    };
    unite(window, parts[i].left, parts[i].top, parts[i].right, parts[i].bottom);
    const Bounds& own = outlines[i].body;
    unite(body, own.left, own.top, own.right, own.bottom);
  }
  const auto add_all = [&](auto kind) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (group[i] == g) add_plain(i, kind(parts[i]));
  };
  const double expected = prior.height(window.bottom);
  if (expected <= 0 && window.height() >= p.least_unknown && window.top > 0)
    return explain_unknown(g, window);
  if (expected <= 0 || window.height() > p.tallest * expected)
    return add_all([](const Component&) { return RegionKind::thing; });
  const Box whole = box_of(window);
  const bool was_block = std::any_of(blocks_before.begin(), blocks_before.end(), [&](const Box& b) {
    return intersection_over_union(b, whole) > p.same_block;
  });
  const auto found = people.find(moving.view(), window, prior, was_block);
  if (people.found_wide_block() && blocks.size() < kMostBlocks) blocks.push_back(whole);
  const bool slender = body.height() > p.widest * body.width();
  if (found.empty() && slender && window.height() > p.usual_least * expected &&
      window.height() < p.usual_most * expected) {
    // Much of a person may look like the floor: a group as high and as slender as one person is one.
    if (members == 1) return add_all([](const Component&) { return RegionKind::person_like; });
    const double middle = (body.left + body.right) / 2.0, width = window.height() / p.widest / 2;
    const Person person{{middle - width / 2, whole.y, width, whole.height}, 0};
    return add_people(g, window, {&person, 1});
  }
  for (const Person& person : found) walked(person.box, window);
  const bool alone = found.size() == 1;
  // A person who lunges or bends: upright bodies do not explain the blob, which is no higher than one. Or several people.
  if (alone && members == 1 && window.height() < p.usual_most * expected) {
    const double rest = unexplained(window, found);
    const auto kind = rest > p.beside ? RegionKind::group : RegionKind::person_like;
    if (rest > p.loose) return add_all([kind](const Component&) { return kind; });
    // A body in stride may fit without its feet: a blob as high and as slender as one person is one.
    if (slender && window.height() > p.usual_least * expected &&
        window.bottom - found[0].box.bottom() > p.feet * window.height())
      return add_all([](const Component&) { return RegionKind::person_like; });
  }
  add_people(g, window, found);
}

RegionFinder::RegionFinder() : state_(std::make_unique<State>()) {}
RegionFinder::~RegionFinder() = default;
RegionFinder::RegionFinder(RegionFinder&&) noexcept = default;
RegionFinder& RegionFinder::operator=(RegionFinder&&) noexcept = default;

void RegionFinder::set_options(const RegionOptions& options) {
  state_->options = options;
}

void RegionFinder::set_parameters(const DetectionParameters& parameters) {
  const RegionOptions options = state_->options;
  state_ = std::make_unique<State>(parameters);
  state_->options = options;
}

void RegionFinder::reset() {
  state_->prior.reset();
  state_->walkers.reset();
  state_->bodies.reset();
  state_->blocks.clear();
  state_->blocks_before.clear();
  state_->regions.clear();
  state_->newcomers.reset();
  state_->seen = 0;
}

std::size_t RegionFinder::bytes() const {
  const State& s = *state_;
  return sizeof(State) + s.moving.bytes() + s.closed.bytes() + s.morphology.bytes() + s.labeller.bytes() +
         s.parting.bytes() + s.people.bytes() + s.newcomers.bytes() + s.walkers.bytes() + bytes_of(s.blocks) +
         bytes_of(s.blocks_before) + bytes_of(s.group) + bytes_of(s.outlines) + s.bodies.bytes() +
         s.outline_finder.bytes() + bytes_of(s.regions);
}

std::span<const Region> RegionFinder::update(MutableGrayView mask, View<std::uint16_t> labels,
                                             const Transform& motion, const Change& change) {
  State& s = *state_;
  s.regions.clear();
  std::swap(s.blocks, s.blocks_before);
  s.blocks.clear();
  if (mask.size() != s.size) {
    s.preallocate(mask.size());
    reset();
  }
  ++s.seen;
  s.prior.advance(motion, s.size);
  s.walkers.advance(motion);
  s.bodies.advance(motion);
  pack(mask, s.moving.view());
  s.change = change.difference.size() == mask.size() ? change : Change{};
  std::memcpy(s.closed.view().data, s.moving.view().data, s.moving.bytes());
  const int side = static_cast<int>(std::lround(s.options.closing * mask.width / 320.0));
  s.morphology.close(s.closed.view(), mask.width, side);
  s.find_components();
  const auto parts = s.labeller.components();
  unpack(s.closed.view(), mask);
  if (!labels.empty()) s.labeller.write(labels);  // empty: not wanted
  s.outlines.clear();
  for (std::size_t i = 0; i < parts.size(); ++i)
    s.outlines.push_back(s.outline_finder.outline(parts[i], i, s.labeller.runs(), s.moving.view()));
  if (!s.options.people || parts.size() > kMostParts) {
    for (std::size_t i = 0; i < parts.size(); ++i) s.add_plain(i);
  } else {
    s.learn();
    s.group_components();
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (s.group[i] == static_cast<int>(i)) s.explain(static_cast<int>(i));
  }
  for (Region& r : s.regions) r.area = static_cast<double>(s.moving_in(r.box));
  if (s.options.people) s.newcomers.filter(s.regions, s.seen, s.options.minimum_area, motion, s.size);
  s.change = {};  // the picture is the caller's
  return s.regions;
}

}  // namespace cerberus::vision
