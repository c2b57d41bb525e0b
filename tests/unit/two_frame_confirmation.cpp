// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/two_frame_confirmation.h"

#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{320, 240};
const Transform kPan = Transform::translation(8, 0);

Region region(const Box& box, double area = 0) {
  return {box, area > 0 ? area : box.area() / 2, 0.4, 1};
}
constexpr Box kSmall{100, 100, 20, 30}, kLarge{100, 100, 30, 40};  // 0.008 and 0.016 of the picture

struct Scene {
  TwoFrameConfirmation confirmation;
  std::vector<Region> regions;
  int frames = 3;

  Scene() { confirmation.preallocate(); }
  // How many of these are left in the next frame.
  int see(std::vector<Region> found, const Transform& motion = kPan, double minimum_area = 0) {
    regions = std::move(found);
    confirmation.filter(regions, frames++, minimum_area, motion, kSize);
    return static_cast<int>(regions.size());
  }
};

}  // namespace

START_TEST(a_small_region_passes_in_its_second_frame) {
  for (const Transform& motion : {kPan, Transform{}}) {
    Scene s;
    s.frames = 5;
    ck_assert_int_eq(s.see({region(kSmall)}, motion), 0);
    Box next = kSmall;
    next.x += motion.m[2] + 3;  // it has walked, too
    ck_assert_int_eq(s.see({region(next)}, motion), 1);
    ck_assert_int_eq(s.see({}, motion), 0);
    ck_assert_int_eq(s.see({region(next)}, motion), 0);
  }
}
END_TEST

START_TEST(a_region_is_compared_at_its_place_in_the_scene) {
  Scene s;
  const Transform far = Transform::translation(60, 0);
  ck_assert_int_eq(s.see({region(kSmall)}), 0);
  ck_assert_int_eq(s.see({region(kSmall)}, far), 0);
}
END_TEST

// A quarter of the smaller side and 4 pixels: 9 of a box of 20 x 30, with its half in what was there 19, in 20 x 50 as
// well.
START_TEST(a_region_may_move_by_a_quarter_of_its_smaller_side) {
  for (const double height : {30.0, 50.0})
    for (const double step : {18.0, 20.0}) {
      Scene s;
      s.frames = 5;
      ck_assert_int_eq(s.see({region({100, 100, 20, height})}, {}), 0);
      ck_assert_int_eq(s.see({region({100 + step, 100, 20, height})}, {}), step < 19);
    }
}
END_TEST

START_TEST(a_fragment_of_a_region_of_the_frame_before_passes) {
  Scene s;
  ck_assert_int_eq(s.see({region(kLarge)}), 1);
  ck_assert_int_eq(
      s.see({region({kLarge.x + 8, kLarge.y, 15, 20}), region({kLarge.x + 8, kLarge.y + 25, 15, 15})}), 2);
}
END_TEST

START_TEST(a_large_region_passes_at_once) {
  Scene s;
  ck_assert_int_eq(s.see({region(kLarge), region(kSmall)}), 1);
}
END_TEST

START_TEST(the_time_of_confirmation_depends_on_camera_and_border) {
  const Box at_left{0, 100, 20, 30}, at_top{100, 0, 20, 30}, at_right{300, 100, 20, 30},
      at_bottom{100, 210, 20, 30};
  struct Case {
    Box box;
    Transform motion;
    int first, last;  // frames in which it is held back
  };
  for (const Case& c : {Case{kSmall, kPan, 3, 25},
                        {at_left, kPan, 3, 12},
                        {at_top, kPan, 3, 12},
                        {at_right, kPan, 3, 12},
                        {at_bottom, kPan, 3, 12},
                        {kSmall, {}, 4, 12}})
    for (int frame = 3; frame < 30; ++frame) {
      Scene s;
      s.frames = frame;
      ck_assert_int_eq(s.see({region(c.box)}, c.motion), frame < c.first || frame > c.last);
    }
}
END_TEST

START_TEST(a_speck_is_removed_unless_a_minimum_area_is_set) {
  for (const double minimum : {0.0, 20.0}) {
    Scene s;
    s.see({region(kSmall, 59), region(kSmall, 60)}, kPan, minimum);
    // 60 pixels are 1 / 1280 of the picture.
    ck_assert_int_eq(s.see({region(kSmall, 59), region(kSmall, 60), {kSmall, 59, 0.6, 1}}, kPan, minimum),
                     minimum > 0 ? 3 : 1);
  }
}
END_TEST

START_TEST(clutter_is_survived_without_allocation) {
  Scene s;
  std::vector<Region> many;
  for (int k = 0; k < 300; ++k) many.push_back(region({k % 300 * 1.0, 10, 10, 20}));
  const std::size_t bytes = s.confirmation.bytes();
  s.regions = many;
  const std::size_t before = cerberus::tests::allocations();
  for (int frame = 3; frame < 30; ++frame) s.confirmation.filter(s.regions, frame, 0, {}, kSize);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
  ck_assert_uint_eq(s.confirmation.bytes(), bytes);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "confirmation",
      {a_small_region_passes_in_its_second_frame, a_region_is_compared_at_its_place_in_the_scene,
       a_region_may_move_by_a_quarter_of_its_smaller_side, a_fragment_of_a_region_of_the_frame_before_passes,
       a_large_region_passes_at_once, the_time_of_confirmation_depends_on_camera_and_border,
       a_speck_is_removed_unless_a_minimum_area_is_set, clutter_is_survived_without_allocation});
}
