// SPDX-License-Identifier: LGPL-2.1-or-later
// Points and boxes that are followed from picture to picture.
#include "vision/tracking/evidence/picture_follower.h"

#include <cmath>
#include <limits>

#include "support/suite.h"
#include "support/textures.h"
#include "vision/tracking/evidence/sparse_flow.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{160, 120};
constexpr int kLevels = 3;

// Two pictures of one pattern.
struct Pair {
  Image<std::uint8_t> first{kSize}, second{kSize};
  Pyramid before, now;
  Pair(double x, double y, double size = 1) {
    paint(first, all_of(kSize), 80, 60, 1);
    paint(second, all_of(kSize), 80 + x, 60 + y, 1, size);
    before.borrow(first.view(), kLevels);
    now.borrow(second.view(), kLevels);
  }
};

}  // namespace

START_TEST(a_point_is_found_to_a_tenth_of_a_pixel) {
  const Pair pair(2.3, -1.6);
  for (const Point at : {Point{40, 40}, Point{80.5, 60.25}, Point{120, 90}}) {
    const auto found = follow_point(pair.before, pair.now, at, at);
    ck_assert(found);
    ck_assert_double_eq_tol(found->x, at.x + 2.3, 0.1);
    ck_assert_double_eq_tol(found->y, at.y - 1.6, 0.1);
  }
}
END_TEST

START_TEST(a_point_far_off_is_found_from_a_guess_nearby) {
  const Pair pair(31, 17);
  const auto found = follow_point(pair.before, pair.now, {60, 50}, {90, 69});
  ck_assert(found);
  ck_assert_double_eq_tol(found->x, 91, 0.1);
  ck_assert_double_eq_tol(found->y, 67, 0.1);
}
END_TEST

START_TEST(no_point_is_found_without_texture_or_at_the_pictures_edge) {
  const Pair pair(1, 1);
  ck_assert(!follow_point(pair.before, pair.now, {3, 60}, {3, 60}));
  ck_assert(!follow_point(pair.before, pair.now, {80, 118}, {80, 118}));
  ck_assert(!follow_point(pair.before, pair.now, {80, 60}, {500, 60}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ck_assert(!follow_point(pair.before, pair.now, {nan, 60}, {80, 60}));
  ck_assert(!follow_point(pair.before, pair.now, {80, 60}, {nan, nan}));
  Image<std::uint8_t> grey(kSize);
  Pyramid flat;
  flat.borrow(grey.view(), kLevels);
  ck_assert(!follow_point(flat, pair.now, {80, 60}, {80, 60}));
}
END_TEST

START_TEST(a_box_moves_and_grows_with_what_is_in_it) {
  const Pair pair(3.5, -2, 1.02);
  const auto step = follow_box(pair.before, pair.now, {60, 30, 40, 60}, {0, 0});
  ck_assert(step);
  ck_assert_double_eq_tol(step->shift.x, 3.5, 0.3);
  ck_assert_double_eq_tol(step->shift.y, -2, 0.3);
  ck_assert_double_eq_tol(step->growth, 1.02, 0.005);
}
END_TEST

START_TEST(a_box_is_not_followed_where_another_thing_stands_now) {
  Pair pair(0, 0);
  paint(pair.second, all_of(kSize), 0, 0, 7, 1.6);
  pair.now.borrow(pair.second.view(), kLevels);
  ck_assert(!follow_box(pair.before, pair.now, {60, 30, 40, 60}, {0, 0}));
}
END_TEST

int main() {
  return run_suite(
      "picture_follower",
      {a_point_is_found_to_a_tenth_of_a_pixel, a_point_far_off_is_found_from_a_guess_nearby,
       no_point_is_found_without_texture_or_at_the_pictures_edge, a_box_moves_and_grows_with_what_is_in_it,
       a_box_is_not_followed_where_another_thing_stands_now});
}
