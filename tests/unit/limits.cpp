// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/limits.h"

#include <check.h>

#include <limits>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Placement kUnknown{kNan, kNan, kNan, kNan, kNan};
// 80 pixels a metre, a box of 40 x 140 pixels.
constexpr Placement kNear{0, 4, 1 / 80.0, 0.5, 1.75};

}  // namespace

START_TEST(a_range_holds_its_ends_and_what_is_unknown) {
  const Range range{2, 5};
  ck_assert(range.holds(2) && range.holds(5) && range.holds(kNan));
  ck_assert(!range.holds(1.99) && !range.holds(5.01));
  ck_assert(Range{}.holds(1e9) && Range{}.holds(0));
  ck_assert((Range{3, 0}.holds(1e9)) && !(Range{3, 0}.holds(2)));
}
END_TEST

START_TEST(sizes_are_judged_in_pixels_everywhere_and_in_metres_where_known) {
  const Box box{0, 0, 40, 140};
  ck_assert(passes(SizeLimits{}, box, kNear));
  ck_assert(passes(SizeLimits{.width = {40, 40}, .height = {140, 0}}, box, kUnknown));
  ck_assert(!passes(SizeLimits{.width = {41, 0}}, box, kUnknown));
  ck_assert(!passes(SizeLimits{.height = {0, 139}}, box, kUnknown));
  ck_assert(!passes(SizeLimits{.metres_wide = {0.6, 0}}, box, kNear));
  ck_assert(!passes(SizeLimits{.metres_high = {0, 1.7}}, box, kNear));
  ck_assert(passes(SizeLimits{.metres_wide = {0.6, 0}, .metres_high = {0, 1.7}}, box, kUnknown));
}
END_TEST

START_TEST(the_human_size_accepts_people_and_rejects_cats_and_cars) {
  const Box box{0, 0, 40, 140};
  for (const double width : {0.25, 0.48, 0.9, 1.4}) {
    Placement place = kNear;
    place.width = width;
    ck_assert(passes(human_size(), box, place));
  }
  for (const double width : {0.2, 1.8, 4.2}) {
    Placement place = kNear;
    place.width = width;
    ck_assert(!passes(human_size(), box, place));
  }
}
END_TEST

START_TEST(the_human_speed_is_a_tenth_to_four_metres_a_second) {
  // 80 pixels a metre: 8 to 320 pixels a second.
  ck_assert(passes(human_speed(), 112, 112, kNear));
  ck_assert(passes(human_speed(), 320, 320, kNear));
  ck_assert(!passes(human_speed(), 321, 321, kNear));
  ck_assert(!passes(human_speed(), 7.9, 7.9, kNear));
  ck_assert(passes(human_speed(), 1000, 1000, kUnknown));
}
END_TEST

START_TEST(an_object_that_has_walked_may_stand_and_one_that_only_sways_may_not) {
  ck_assert(passes(human_speed(), 0, 112, kNear));
  ck_assert(!passes(human_speed(), 0, 5, kNear));
  ck_assert(!passes(SpeedLimits{.pixels = {20, 0}}, 0, 19, kUnknown));
  ck_assert(passes(SpeedLimits{.pixels = {20, 0}}, 0, 20, kUnknown));
}
END_TEST

START_TEST(pixels_are_metres_by_the_scale_of_the_place) {
  ck_assert_double_eq_tol(to_metres(112, kNear), 1.4, 1e-9);
}
END_TEST

int main() {
  return cerberus::tests::run_suite("gates",
                                    {a_range_holds_its_ends_and_what_is_unknown,
                                     sizes_are_judged_in_pixels_everywhere_and_in_metres_where_known,
                                     the_human_size_accepts_people_and_rejects_cats_and_cars,
                                     the_human_speed_is_a_tenth_to_four_metres_a_second,
                                     an_object_that_has_walked_may_stand_and_one_that_only_sways_may_not,
                                     pixels_are_metres_by_the_scale_of_the_place});
}
