// SPDX-License-Identifier: LGPL-2.1-or-later
// Which components are objects and which are ghosts. Pictures are 320 x 240, the background is 100 everywhere, objects
// are 200; expectations follow from the header's rules by hand.
#include "vision/components/components.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{320, 240};
const FrameWindows kWindows = FrameWindows::of(1 / 25.0);  // of 25 frames a second

struct Rect {
  int x, y, width, height;
};

struct Scene {
  Image<std::uint8_t> frame, background, age, quiet;
  BitMask mask, absorb;
  ForegroundComponents components;

  explicit Scene(int scene_age, Size size = kSize) : frame(size), background(size), age(size), quiet(size) {
    for (auto* picture : {&frame, &background}) picture->fill_bytes(100);
    age.fill_bytes(scene_age);
    quiet.fill_bytes(200);
    for (auto* bits : {&mask, &absorb}) bits->resize(bit_mask_size(size));
    components.preallocate(size);
  }
  static void paint(Image<std::uint8_t>& picture, const Rect& r, int value) {
    for (int y = r.y; y < r.y + r.height; ++y)
      std::fill_n(picture.view().row(y) + r.x, r.width, static_cast<std::uint8_t>(value));
  }
  // These pixels differ from the background and moved `since` frames ago.
  void differs(const Rect& r, int since) {
    for (int y = r.y; y < r.y + r.height; ++y) set_bits(mask.view().row(y), r.x, r.x + r.width);
    paint(quiet, r, since);
  }
  ComponentInput input(bool still = true, bool registered = false) const {
    return {frame.view(), background.view(), age.view(), quiet.view(), still, registered};
  }
  bool classify(bool still = true, bool registered = false) {
    return components.classify(input(still, registered), kWindows, mask.view(), absorb.view());
  }
  void merge_neighbours(bool still = true, bool registered = false) {
    BitMask closed;
    closed.resize(bit_mask_size(kSize));
    std::copy_n(mask.view().data, mask.bytes() / sizeof(std::uint64_t), closed.view().data);
    components.merge_neighbours(input(still, registered), kWindows, closed.view(), mask.view());
  }
};

int count(const BitMask& bits, const Rect& r) {
  int n = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) n += bits.view().row(y)[x / 64] >> (x % 64) & 1;
  return n;
}
int all(const Rect& r) {
  return r.width * r.height;
}

constexpr Rect kPerson{100, 80, 30, 80};

}  // namespace

START_TEST(windows_are_times_not_frames) {
  const FrameWindows slow = FrameWindows::of(1 / 5.0), fast = FrameWindows::of(1 / 100.0);
  ck_assert_int_eq(kWindows.fresh, 1);
  ck_assert_int_eq(kWindows.moving, 3);
  ck_assert_int_eq(kWindows.recent, 25);
  ck_assert_int_eq(kWindows.young, 50);
  ck_assert_int_eq(kWindows.newest, 25);
  ck_assert_int_eq(kWindows.tick, 1);
  ck_assert_int_eq(kWindows.hold, 250);
  ck_assert_int_eq(slow.hold, 50);   // 10 s
  ck_assert_int_eq(slow.young, 10);  // 2 s
  ck_assert_int_eq(slow.moving, 3);  // never fewer than three frames
  ck_assert_int_eq(slow.fresh, 1);
  ck_assert_int_eq(fast.tick, 4);  // frames
  ck_assert_int_eq(fast.fresh, 1);
  ck_assert_int_eq(fast.moving, 3);
  ck_assert_int_eq(fast.recent, 25);
  ck_assert_int_eq(fast.hold, 250);
  ck_assert_int_eq(fast.newest, 100);  // frames, as pixels are learnt in every one of them
  ck_assert_int_eq(fast.young, 200);
}
END_TEST

START_TEST(a_moving_component_is_an_object) {
  Scene s(200);
  Scene::paint(s.frame, kPerson, 200);
  s.differs(kPerson, 0);
  ck_assert(!s.classify());  // an old background
  ck_assert_int_eq(count(s.mask, kPerson), all(kPerson));
  ck_assert_int_eq(count(s.absorb, kPerson), 0);
}
END_TEST

// Two halves of one object in a picture of four times the size, and specks beside them, each too far from the next.
START_TEST(in_clutter_no_neighbours_are_merged) {
  constexpr Size kLarge{1280, 960};
  constexpr Rect kLeft{400, 300, 40, 300}, kRight{460, 300, 40, 300}, kBetween{440, 300, 20, 300};
  for (const int specks : {0, 400, 600}) {
    Image<std::uint8_t> frame(kLarge), background(kLarge), age(kLarge), quiet(kLarge);
    for (auto* picture : {&frame, &background}) picture->fill_bytes(100);
    age.fill_bytes(5);
    quiet.fill_bytes(0);
    BitMask mask, closed;
    for (auto* bits : {&mask, &closed}) {
      bits->resize(bit_mask_size(kLarge));
      const auto add = [&](const Rect& r) {
        for (int y = r.y; y < r.y + r.height; ++y) set_bits(bits->view().row(y), r.x, r.x + r.width);
      };
      add(kLeft), add(kRight);
      for (int i = 0; i < specks; ++i) add({700 + 20 * (i % 25), 10 + 30 * (i / 25), 2, 2});
    }
    ForegroundComponents components;
    components.preallocate(kLarge);
    components.merge_neighbours({frame.view(), background.view(), age.view(), quiet.view(), true}, kWindows,
                                closed.view(), mask.view());
    ck_assert_int_eq(count(mask, kBetween), specks > 512 ? 0 : all(kBetween));
    ck_assert_int_eq(count(mask, {700, 0, 580, 960}), 0);  // no speck stays, whatever their number
  }
}
END_TEST

START_TEST(an_object_that_stopped_stays_foreground_for_ten_seconds) {
  for (const int since : {100, 249, 250, 251}) {
    Scene s(255);
    Scene::paint(s.frame, kPerson, 200);
    s.differs(kPerson, since);
    s.classify();
    ck_assert_int_eq(count(s.mask, kPerson), all(kPerson));
    ck_assert_int_eq(count(s.absorb, kPerson), since > 250 ? all(kPerson) : 0);
  }
}
END_TEST

// What is left of a ghost between the sides of a door: they are edges of the frame that go on above it. Not those of a
// thing that was put down there.
START_TEST(what_rests_between_edges_of_the_scene_is_no_object) {
  constexpr Rect kStrip{150, 100, 8, 40};
  for (const bool door : {false, true}) {
    Scene s(200);
    Scene::paint(s.frame, kStrip, 200);
    if (door) {
      for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {150, 60, 8, 80}, 200);
      Scene::paint(s.background, kStrip, 100);
    }
    s.differs(kStrip, 100);
    s.classify();
    ck_assert_int_eq(count(s.mask, kStrip), door ? 0 : all(kStrip));
  }
}
END_TEST

// Over a young background it is absorbed at once: before a camera that moves, where its picture is aligned, after .12 s. Where
// the frame ends beside it, it is not known whether that side goes on.
START_TEST(what_rests_between_edges_of_the_scene_is_absorbed_before_a_moving_camera) {
  constexpr Rect kStrip{150, 100, 8, 40};
  struct Case {
    bool registered, ends_beside;
    int since;
    bool absorbed;
  };
  for (const auto& [registered, ends_beside, since, absorbed] : {Case{false, false, 3, false},
                                                                 {true, false, 3, true},
                                                                 {true, false, 2, false},
                                                                 {true, true, 3, false}}) {
    Scene s(30);
    for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {150, 60, 8, 80}, 200);
    Scene::paint(s.background, kStrip, 100);
    s.differs(kStrip, since);
    std::array<RowSpan, kSize.height> rows;
    rows.fill({ends_beside ? kStrip.x : 0, kSize.width});
    ComponentInput input = s.input(false, registered);
    input.visible = rows;
    s.components.classify(input, kWindows, s.mask.view(), s.absorb.view());
    ck_assert_int_eq(count(s.absorb, kStrip), absorbed ? all(kStrip) : 0);
  }
}
END_TEST

// A side at the picture's edge cannot be compared: one that goes on is not enough.
START_TEST(what_rests_at_the_picture_s_edge_beside_one_edge_of_the_scene_is_an_object) {
  constexpr Rect kStrip{0, 100, 8, 40};
  Scene s(200);
  for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {0, 60, 8, 120}, 200);
  Scene::paint(s.background, kStrip, 100);
  s.differs(kStrip, 100);
  s.classify();
  ck_assert_int_eq(count(s.mask, kStrip), all(kStrip));
}
END_TEST

// A table whose right leg stands on a post: only the right one of its two outer sides goes on.
START_TEST(only_the_outer_sides_of_what_rests_may_be_edges_of_the_scene) {
  constexpr Rect kTop{150, 100, 28, 4}, kLegs[]{{150, 104, 8, 36}, {170, 104, 8, 36}};
  Scene s(200);
  for (const Rect& r : {kTop, kLegs[0], kLegs[1]}) {
    Scene::paint(s.frame, r, 200);
    s.differs(r, 100);
  }
  for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {170, 140, 8, 20}, 200);
  s.classify();
  for (const Rect& r : {kTop, kLegs[0], kLegs[1]}) ck_assert_int_eq(count(s.mask, r), all(r));
}
END_TEST

START_TEST(a_ghost_is_absorbed_at_once) {
  for (const bool young : {false, true}) {
    Scene s(young ? 10 : 255);
    Scene::paint(s.background, kPerson, 200);  // the background shows an object
    s.differs(kPerson, 20);
    ck_assert(!s.classify());
    ck_assert_int_eq(count(s.mask, kPerson), 0);
    ck_assert_int_eq(count(s.absorb, kPerson), all(kPerson));
  }
}
END_TEST

START_TEST(a_ghost_that_somebody_passes_is_absorbed_as_well) {
  for (const bool still : {true, false}) {
    Scene s(200);
    constexpr Rect kPlace{100, 80, 30, 80}, kWalker{130, 80, 40, 80};  // one component
    Scene::paint(s.background, kPlace, 200);
    Scene::paint(s.frame, kWalker, 180);
    s.differs(kPlace, 30);
    s.differs(kWalker, 0);
    s.classify(still);
    ck_assert_int_eq(count(s.mask, kPlace), 0);
    ck_assert_int_eq(count(s.absorb, kPlace), all(kPlace));
    ck_assert_int_eq(count(s.mask, kWalker), all(kWalker));
  }
}
END_TEST

START_TEST(over_a_young_background_a_component_needs_motion) {
  // Learnt for less than a second: whatever its outline; for less than two: if its outline is no edge of the frame.
  struct Case {
    int age;
    bool outline, kept_at_rest;
  };
  for (const Case& c : {Case{24, true, false}, {25, true, true}, {49, true, true}, {49, false, false}})
    for (const int since : {2, 3}) {
      Scene s(c.age);
      if (c.outline) Scene::paint(s.frame, kPerson, 200);
      s.differs(kPerson, since);
      const bool kept = since < 3 || c.kept_at_rest;
      s.classify();
      ck_assert_int_eq(count(s.mask, kPerson), kept ? all(kPerson) : 0);
      ck_assert_int_eq(count(s.absorb, kPerson), kept ? 0 : all(kPerson));
    }
}
END_TEST

START_TEST(objects_over_a_young_background_are_reported) {
  for (const int age : {49, 50}) {
    Scene s(age);
    Scene::paint(s.frame, kPerson, 200);
    s.differs(kPerson, 0);
    ck_assert(s.classify() == (age < 50));
  }
}
END_TEST

START_TEST(for_a_moving_camera_only_present_motion_counts) {
  for (const int since : {2, 3}) {
    Scene s(255);
    Scene::paint(s.frame, kPerson, 200);
    s.differs(kPerson, since);
    s.classify(false);
    ck_assert_int_eq(count(s.mask, kPerson), since < 3 ? all(kPerson) : 0);
  }
}
END_TEST

START_TEST(for_a_moving_camera_a_ghost_needs_motion_in_the_last_frame) {
  struct Case {
    int since;
    bool kept;
  };
  for (const Case& c : {Case{0, true}, {1, false}, {2, false}}) {
    Scene s(255);
    Scene::paint(s.background, kPerson, 200);
    s.differs(kPerson, c.since);
    s.classify(false);
    ck_assert_int_eq(count(s.mask, kPerson), c.kept ? all(kPerson) : 0);
  }
}
END_TEST

START_TEST(for_a_moving_camera_the_outline_decides_about_rest_over_a_young_background) {
  // The component moved one frame ago and rests now, but for some rows or none; its outline is an edge of the frame
  // only, or of the background as well.
  struct Case {
    Rect part;
    int age, moving_rows;
    bool object, kept;
  };
  constexpr Rect kSmall{100, 80, 8, 7}, kLarger{100, 80, 8, 8};  // about 1/1280 of the picture, 60 pixels
  for (const Case& c : {Case{kPerson, 10, 0, true, true},
                        {kPerson, 10, 0, false, false},
                        {kPerson, 49, 0, false, false},
                        {kPerson, 50, 0, false, true},
                        {kPerson, 10, 1, false, true},
                        {kLarger, 10, 0, false, false},
                        {kSmall, 10, 0, false, true}}) {
    Scene s(c.age);
    Scene::paint(s.frame, c.part, 200);
    if (!c.object) Scene::paint(s.background, c.part, 190);
    s.differs(c.part, 1);
    s.differs({c.part.x, c.part.y, c.part.width, c.moving_rows}, 0);
    s.classify(false);
    ck_assert_int_eq(count(s.mask, c.part), c.kept ? all(c.part) : 0);
    ck_assert_int_eq(count(s.absorb, c.part), 0);  // not absorbed before it has rested for longer
  }
}
END_TEST

START_TEST(two_rims_are_one_object_over_a_young_background) {
  // A body of 40 x 80 that has moved by 6: a strip before it, a strip behind it.
  constexpr Rect kBehind{100, 80, 6, 80}, kBetween{106, 80, 34, 80}, kBefore{140, 80, 6, 80};
  for (const int age : {10, 100}) {
    Scene s(age);
    s.differs(kBehind, 1);
    s.differs(kBefore, 1);
    s.merge_neighbours();
    ck_assert_int_eq(count(s.mask, kBetween), age < 50 ? all(kBetween) : 0);
    ck_assert_int_eq(count(s.mask, kBehind), all(kBehind));
    ck_assert_int_eq(count(s.mask, kBefore), all(kBefore));
  }
}
END_TEST

// The components are as high and as far from each other as the rims of one body. The gap has not changed; a brick wall
// or a slope would have, had it moved by the rims' width, so these are two people.
START_TEST(two_people_before_a_textured_background_are_not_the_rims_of_one) {
  enum Wall { even, bricks, slope };
  struct Case {
    Wall wall;
    int width;  // of each
    bool one;
  };
  for (const Case& c : {Case{even, 20, true}, {bricks, 20, false}, {slope, 20, false}, {slope, 10, true}}) {
    const Rect left{120 - c.width, 80, c.width, 80}, right{180, 80, c.width, 80}, between{120, 80, 60, 80};
    Scene s(10);
    for (int x = 0; x < 256; ++x)
      if (c.wall == slope || (c.wall == bricks && x % 16 < 8))
        for (auto* picture : {&s.frame, &s.background})
          Scene::paint(*picture, {x, 0, 1, kSize.height}, c.wall == slope ? x : 120);
    s.differs(left, 1);
    s.differs(right, 1);
    s.merge_neighbours();
    ck_assert_int_eq(count(s.mask, between), c.one ? all(between) : 0);
    ck_assert_int_eq(count(s.mask, left) + count(s.mask, right), all(left) + all(right));
  }
}
END_TEST

// Both sides of the gap are edges of the frame. Those of one body are not: its front rim ends in the body. Before a camera
// that moves this counts where its picture fits the background.
START_TEST(two_people_before_an_even_wall_are_not_the_rims_of_one) {
  constexpr Rect kLeft{100, 80, 20, 80}, kRight{180, 80, 20, 80}, kBetween{120, 80, 60, 80};
  struct Case {
    bool body, still, registered, one;
  };
  for (const auto& [body, still, registered, one] : {Case{false, true, false, false},
                                                     {true, true, false, true},
                                                     {false, false, true, false},
                                                     {true, false, true, true},
                                                     {false, false, false, true}}) {
    Scene s(10);
    for (const Rect& r : {kLeft, kRight}) Scene::paint(s.frame, r, 200);
    if (body) {  // from 120 to 180 it was before: what it left is background now
      Scene::paint(s.frame, {120, 80, 80, 80}, 200);
      Scene::paint(s.frame, kLeft, 100);
      Scene::paint(s.background, {100, 80, 80, 80}, 200);
    }
    s.differs(kLeft, 1);
    s.differs(kRight, 1);
    s.merge_neighbours(still, registered);
    ck_assert_int_eq(count(s.mask, kBetween), one ? all(kBetween) : 0);
    ck_assert_int_eq(count(s.mask, kLeft) + count(s.mask, kRight), all(kLeft) + all(kRight));
  }
}
END_TEST

START_TEST(a_rim_belongs_to_its_neighbour) {
  Scene s(10);
  constexpr Rect kFront{155, 80, 8, 80};  // 25 away: between a fifth and half of their height
  s.differs(kPerson, 1);
  s.differs(kFront, 1);
  s.merge_neighbours();
  ck_assert_int_eq(count(s.mask, {130, 80, 25, 80}), all({130, 80, 25, 80}));
}
END_TEST

START_TEST(rims_far_apart_or_of_other_heights_are_two_objects) {
  Scene apart(10);
  apart.differs({100, 80, 6, 80}, 1);
  apart.differs({190, 80, 6, 80}, 1);  // 84 between them, 80 high
  apart.merge_neighbours();
  ck_assert_int_eq(count(apart.mask, {106, 80, 84, 80}), 0);
  Scene heights(10);
  heights.differs({100, 20, 6, 80}, 1);
  heights.differs({130, 80, 6, 80}, 1);  // only 20 of 80 beside each other
  heights.merge_neighbours();
  ck_assert_int_eq(count(heights.mask, {106, 20, 24, 140}), 0);
}
END_TEST

START_TEST(a_fragment_near_a_large_component_is_dropped_over_a_young_background) {
  constexpr Rect kPiece{150, 100, 10, 20};  // 20 away: a quarter of the person's height
  for (const int age : {10, 100}) {
    Scene s(age);
    s.differs(kPerson, 1);
    s.differs(kPiece, 1);
    s.merge_neighbours();
    ck_assert_int_eq(count(s.mask, kPerson), all(kPerson));
    ck_assert_int_eq(count(s.mask, kPiece), age < 50 ? 0 : all(kPiece));
  }
  Scene far(10);
  constexpr Rect kFar{175, 100, 10, 20};  // 45 away: more than half of the person's height
  far.differs(kPerson, 1);
  far.differs(kFar, 1);
  far.merge_neighbours();
  ck_assert_int_eq(count(far.mask, kFar), all(kFar));
}
END_TEST

// A person of whom the picture's edge shows little, beside another one: both sides are a person's, or cannot be seen. Before
// a camera that moves this is no evidence.
START_TEST(a_small_object_near_a_large_one_is_no_fragment_of_it) {
  struct Case {
    int left;
    bool still;
  };
  for (const auto& [left, still] : {Case{0, true}, {60, true}, {60, false}}) {
    Scene s(10);
    const Rect small{left, 100, 12, 60}, large{left + 35, 60, 60, 110};
    for (const Rect& r : {small, large}) {
      Scene::paint(s.frame, r, 200);
      s.differs(r, 1);
    }
    s.merge_neighbours(still, !still);
    ck_assert_int_eq(count(s.mask, small), still ? all(small) : 0);
    ck_assert_int_eq(count(s.mask, {left + 12, 100, 23, 60}), 0);
  }
}
END_TEST

// Merged with its neighbour it would add a strip of background between the corners of two boxes.
START_TEST(a_fragment_beside_a_large_component_is_dropped_not_merged) {
  constexpr Rect kPiece{140, 140, 12, 20}, kTiny{140, 100, 7, 7};  // 10 away: less than a fifth of the height
  for (const Rect& piece : {kPiece, kTiny}) {
    Scene s(10);
    s.differs(kPerson, 1);
    s.differs(piece, 1);
    s.merge_neighbours();
    ck_assert_int_eq(count(s.mask, {0, 0, 320, 240}), all(kPerson));
  }
}
END_TEST

START_TEST(a_ghost_at_the_picture_s_edge_needs_more_motion) {
  // A fifteenth of it moves: the last motion of an object that may be out of the picture.
  constexpr Rect kAtEdge{0, 80, 10, 30}, kMoves{0, 80, 10, 2}, kInside{9, 80, 10, 30},
      kMovesInside{9, 80, 10, 2};
  for (const auto& [place, moves] : {std::pair{kAtEdge, kMoves}, {kInside, kMovesInside}}) {
    Scene s(10);
    Scene::paint(s.background, place, 200);
    s.differs(place, 20);
    Scene::paint(s.quiet, moves, 0);
    s.classify();
    ck_assert_int_eq(count(s.mask, place), place.x == 0 ? 0 : all(place));
  }
}
END_TEST

// A moving camera shows new columns and hides others. Neither boundary is an edge of an object.
START_TEST(the_boundary_of_the_visible_background_is_no_edge) {
  constexpr Rect kAll{5, 80, 40, 30}, kFar{25, 80, 20, 30}, kStrip{0, 0, 5, 240};
  const auto judge = [&](Scene& s, std::span<const RowSpan> shown) {
    s.differs(kAll, 0);
    ComponentInput planes = s.input(false);
    planes.registered = true;
    planes.visible = shown;
    s.components.classify(planes, kWindows, s.mask.view(), s.absorb.view());
    return count(s.mask, kAll);
  };
  // A person is there, his far side little brighter than the scene. The strip that has just come in shows him, and the
  // background was learnt from it.
  for (const int strip_age : {1, 10}) {
    Scene s(10);
    Scene::paint(s.frame, kAll, 200);
    Scene::paint(s.frame, kFar, 120);
    for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {0, 80, 5, 30}, 200);
    Scene::paint(s.age, kStrip, strip_age);
    ck_assert_int_eq(judge(s, {}), strip_age == 1 ? all(kAll) : 0);
  }
  // A person was there, and the frame ends beside that place.
  for (const bool ends : {true, false}) {
    Scene s(10);
    Scene::paint(s.background, kAll, 200);
    Scene::paint(s.frame, kStrip, 0);
    const std::vector<RowSpan> shown(kSize.height, RowSpan{ends ? 5 : 0, kSize.width});
    ck_assert_int_eq(judge(s, shown), ends ? 0 : all(kAll));
  }
}
END_TEST

START_TEST(two_people_stay_two) {
  // 20 away: more than a fifth of their height. The child has 0.42 of the other's area: more than a fragment.
  constexpr Rect kOther{150, 80, 30, 80}, kChild{150, 110, 20, 50};
  for (const Rect& other : {kOther, kChild}) {
    Scene s(10);
    s.differs(kPerson, 1);
    s.differs(other, 1);
    s.merge_neighbours();
    ck_assert_int_eq(count(s.mask, {0, 0, 320, 240}), all(kPerson) + all(other));
  }
}
END_TEST

START_TEST(a_tiny_component_is_dropped_over_a_young_background) {
  constexpr Rect kTiny{200, 100, 7, 8}, kSmall{200, 200, 8, 8};  // 60 pixels are 1 / 1280
  Scene s(10);
  s.differs(kTiny, 1);
  s.differs(kSmall, 1);
  s.merge_neighbours();
  ck_assert_int_eq(count(s.mask, kTiny), 0);
  ck_assert_int_eq(count(s.mask, kSmall), all(kSmall));
}
END_TEST

// The old object was 160 on the right, the new one is 200 on the left: half of the outline is an edge of the frame,
// half one of the background.
void half_and_half(Scene& s, const Rect& r) {
  Scene::paint(s.frame, {r.x, r.y, r.width / 2, r.height}, 200);
  Scene::paint(s.background, {r.x + r.width / 2, r.y, r.width - r.width / 2, r.height}, 160);
}

constexpr Rect kWalker{170, 80, 30, 80};  // forty pixels from kPerson

START_TEST(a_fragment_of_a_ghost_is_absorbed) {
  // A component that came in at the left edge stays for its second at rest, and so does one at rest while no object
  // leaves.
  struct Case {
    bool from_outside, somebody_leaves, kept;
  };
  for (const Case& c : {Case{false, true, false}, {true, true, true}, {false, false, true}}) {
    Scene s(255);
    s.classify();  // the camera stands, the frame fits the background
    half_and_half(s, kPerson);
    Scene::paint(s.frame, kWalker, 200);
    if (c.from_outside) s.differs({0, 80, 100, 80}, 0);
    s.differs(kPerson, 0);
    if (c.somebody_leaves) s.differs(kWalker, 0);
    s.classify();
    s.mask.fill_bytes(0);
    s.differs(kPerson, 10);
    if (c.somebody_leaves) s.differs(kWalker, 0);
    s.classify();
    ck_assert_int_eq(count(s.mask, kPerson), c.kept ? all(kPerson) : 0);
    ck_assert_int_eq(count(s.absorb, kPerson), c.kept ? 0 : all(kPerson));
    ck_assert_int_eq(count(s.mask, kWalker), c.somebody_leaves ? all(kWalker) : 0);
  }
}
END_TEST

// Even with a certain outline: an eighth of the object that leaves is 300 pixels.
START_TEST(a_small_component_beside_a_leaving_object_is_a_fragment_of_its_ghost) {
  for (const int side : {17, 18}) {
    const Rect piece{120, 100, side, side};
    Scene s(255);
    s.classify();
    for (const int since : {0, 10}) {
      s.mask.fill_bytes(0);
      for (const Rect& r : {piece, kWalker}) Scene::paint(s.frame, r, 200);
      s.differs(piece, since);
      s.differs(kWalker, 0);
      s.classify();
    }
    ck_assert_int_eq(count(s.mask, piece), side < 18 ? 0 : all(piece));
    ck_assert_int_eq(count(s.absorb, piece), side < 18 ? all(piece) : 0);
  }
}
END_TEST

// So many components are rain, and the search for ghosts would take too long. Two components and specks.
START_TEST(in_clutter_ghosts_are_not_searched) {
  constexpr Rect kPlace{120, 100, 17, 17};
  for (const int components : {2, 512, 513}) {
    Scene s(255, {1280, 960});
    s.classify();
    for (const int since : {0, 10}) {
      s.mask.fill_bytes(0);
      for (int i = 2; i < components; ++i) s.differs({700 + 20 * (i % 25), 10 + 30 * (i / 25), 2, 2}, 0);
      for (const Rect& r : {kPlace, kWalker}) Scene::paint(s.frame, r, 200);
      s.differs(kPlace, since);
      s.differs(kWalker, 0);
      s.classify();
    }
    ck_assert_int_eq(count(s.mask, kPlace), components > 512 ? all(kPlace) : 0);
    ck_assert_int_eq(count(s.absorb, kPlace), components > 512 ? 0 : all(kPlace));
    ck_assert_int_eq(count(s.mask, kWalker), all(kWalker));
  }
}
END_TEST

// Six streaks a frame, each time elsewhere, before a camera that then moves for some frames and stands again.
START_TEST(what_has_flashed_before_the_camera_moved_is_forgotten) {
  for (const int moved : {0, 2, 3, 10}) {
    Scene s(255);
    for (int k = 0; k <= 25 + moved; ++k) {
      s.mask.fill_bytes(0);
      for (int i = 0; i < 6; ++i) s.differs({10 + 50 * i + 10 * (k % 4), 20, 4, 20}, 0);
      s.classify(k < 25 || k == 25 + moved);
    }
    const bool forgotten = moved >= 3;
    ck_assert_msg((count(s.mask, {0, 20, kSize.width, 20}) > 0) == forgotten, "%d", moved);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "components", {windows_are_times_not_frames,
                     a_moving_component_is_an_object,
                     in_clutter_no_neighbours_are_merged,
                     an_object_that_stopped_stays_foreground_for_ten_seconds,
                     what_rests_between_edges_of_the_scene_is_no_object,
                     what_rests_between_edges_of_the_scene_is_absorbed_before_a_moving_camera,
                     what_rests_at_the_picture_s_edge_beside_one_edge_of_the_scene_is_an_object,
                     only_the_outer_sides_of_what_rests_may_be_edges_of_the_scene,
                     a_ghost_is_absorbed_at_once,
                     a_ghost_that_somebody_passes_is_absorbed_as_well,
                     over_a_young_background_a_component_needs_motion,
                     objects_over_a_young_background_are_reported,
                     for_a_moving_camera_only_present_motion_counts,
                     for_a_moving_camera_a_ghost_needs_motion_in_the_last_frame,
                     for_a_moving_camera_the_outline_decides_about_rest_over_a_young_background,
                     two_rims_are_one_object_over_a_young_background,
                     two_people_before_a_textured_background_are_not_the_rims_of_one,
                     two_people_before_an_even_wall_are_not_the_rims_of_one,
                     a_rim_belongs_to_its_neighbour,
                     rims_far_apart_or_of_other_heights_are_two_objects,
                     a_fragment_near_a_large_component_is_dropped_over_a_young_background,
                     a_small_object_near_a_large_one_is_no_fragment_of_it,
                     a_fragment_beside_a_large_component_is_dropped_not_merged,
                     a_ghost_at_the_picture_s_edge_needs_more_motion,
                     the_boundary_of_the_visible_background_is_no_edge,
                     two_people_stay_two,
                     a_tiny_component_is_dropped_over_a_young_background,
                     a_small_component_beside_a_leaving_object_is_a_fragment_of_its_ghost,
                     a_fragment_of_a_ghost_is_absorbed,
                     in_clutter_ghosts_are_not_searched,
                     what_has_flashed_before_the_camera_moved_is_forgotten});
}
