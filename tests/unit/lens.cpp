// SPDX-License-Identifier: LGPL-2.1-or-later
// The lens against angles and distances worked out by hand: 640x480 behind 90 degrees, so f = 320 pixels, tan
// = 1 at the picture's edge.
#include "vision/geometry/lens.h"

#include <check.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr double kDegree = std::numbers::pi / 180;
const Lens kLens(90 * kDegree, {640, 480});

}  // namespace

START_TEST(the_focal_length_follows_from_the_width) {
  ck_assert_double_eq_tol(kLens.focal_length(), 320, 1e-9);
}
END_TEST

START_TEST(the_middle_of_the_picture_is_where_the_camera_looks) {
  const Direction d = kLens.direction({320, 240}, 30 * kDegree, -20 * kDegree);
  ck_assert_double_eq_tol(d.bearing, 30 * kDegree, 1e-12);
  ck_assert_double_eq_tol(d.elevation, -20 * kDegree, 1e-12);
}
END_TEST

START_TEST(right_in_the_picture_is_a_larger_bearing_and_up_a_larger_elevation) {
  ck_assert_double_eq_tol(kLens.direction({640, 240}, 0, 0).bearing, 45 * kDegree, 1e-12);
  ck_assert_double_eq_tol(kLens.direction({0, 240}, 0, 0).bearing, -45 * kDegree, 1e-12);
  ck_assert_double_eq_tol(kLens.direction({320, 0}, 0, 0).elevation, std::atan(0.75), 1e-12);
  // Corner, level: up 0.75, hypot(1, 1) = sqrt 2.
  ck_assert_double_eq_tol(kLens.direction({640, 0}, 0, 0).elevation, std::atan(0.75 / std::sqrt(2.0)), 1e-12);
}
END_TEST

START_TEST(a_tilted_camera_sees_its_sides_further_round_than_a_level_one) {
  // Tilt -45: the ray at the right edge, middle row, is (1, -sqrt(1/2), sqrt(1/2)); bearing = atan(sqrt 2)
  // = 54.7356.
  const Direction d = kLens.direction({640, 240}, 0, -45 * kDegree);
  ck_assert_double_eq_tol(d.bearing / kDegree, 54.735610317245346, 1e-9);
  // elevation = atan(-sqrt(1/2) / sqrt(1.5)) = -30 degrees.
  ck_assert_double_eq_tol(d.elevation / kDegree, -30, 1e-9);
}
END_TEST

START_TEST(bearings_wrap_into_minus_180_to_180) {
  ck_assert_double_eq_tol(kLens.direction({640, 240}, 160 * kDegree, 0).bearing / kDegree, -155, 1e-9);
}
END_TEST

START_TEST(the_floor_is_as_far_as_the_mounting_height_at_45_degrees_down) {
  ck_assert_double_eq_tol(kLens.floor_distance({320, 240}, -45 * kDegree, 0.8), 0.8, 1e-12);
  // Level, 80 of 320 pixels below the horizon: slope 1/4, so 4 x 0.8 m.
  ck_assert_double_eq_tol(kLens.floor_distance({320, 320}, 0, 0.8), 3.2, 1e-12);
  // The same row at the right edge: hypot(1, 1) further along the floor.
  ck_assert_double_eq_tol(kLens.floor_distance({640, 320}, 0, 0.8), 3.2 * std::sqrt(2.0), 1e-12);
}
END_TEST

START_TEST(the_floor_is_nowhere_on_and_above_the_horizon) {
  ck_assert(std::isnan(kLens.floor_distance({320, 240}, 0, 0.8)));
  ck_assert(std::isnan(kLens.floor_distance({320, 100}, 0, 0.8)));
  ck_assert(std::isnan(kLens.floor_distance({320, 400}, 0, 0)));
  ck_assert(std::isnan(kLens.floor_distance({320, 400}, 0, std::numeric_limits<double>::quiet_NaN())));
}
END_TEST

START_TEST(a_person_four_metres_away_has_the_size_it_had_when_drawn) {
  // Level camera at 0.8 m, person 1.7 m tall and 0.48 m wide, 4 m ahead: 80 pixels a metre. Feet 64 pixels
  // below the horizon, head (1.7 - 0.8) x 80 = 72 above; 38.4 wide.
  const Placement p = kLens.place({320 - 19.2, 240 - 72, 38.4, 136}, 0, 0, 0.8);
  ck_assert_double_eq_tol(p.distance, 4, 1e-9);
  ck_assert_double_eq_tol(p.metres_per_pixel, 1 / 80.0, 1e-12);
  ck_assert_double_eq_tol(p.width, 0.48, 1e-9);
  ck_assert_double_eq_tol(p.height, 1.7, 1e-9);
  ck_assert_double_eq_tol(p.bearing, 0, 1e-12);
}
END_TEST

START_TEST(a_tilted_camera_measures_the_same_person) {
  // Tilt -30, camera 3 m up, person 1.7 m tall 5 m ahead. Feet: elevation -atan(3/5), in the picture
  // 320 tan(atan(3/5) - 30) below the middle; head: elevation -atan(1.3/5).
  const double tilt = -30 * kDegree;
  const double foot = 240 + 320 * std::tan(std::atan(3.0 / 5) + tilt);
  const double head = 240 + 320 * std::tan(std::atan(1.3 / 5) + tilt);
  const Placement p = kLens.place({310, head, 20, foot - head}, 10 * kDegree, tilt, 3);
  ck_assert_double_eq_tol(p.distance, 5, 1e-9);
  ck_assert_double_eq_tol(p.height, 1.7, 1e-9);
  ck_assert_double_eq_tol(p.bearing, 10 * kDegree, 1e-12);
  // Depth along the axis: 5 cos 30 + 3 sin 30 = 5.8301; 20 pixels of it / 320.
  ck_assert_double_eq_tol(p.width, 20 * (5 * std::cos(30 * kDegree) + 1.5) / 320, 1e-9);
}
END_TEST

START_TEST(feet_that_are_not_in_the_picture_give_no_distance) {
  const Placement p = kLens.place({300, 100, 40, 380}, 0, 0, 0.8);
  ck_assert(std::isnan(p.distance));
  ck_assert(std::isnan(p.width));
  ck_assert(std::isnan(p.height));
  ck_assert(std::isnan(p.metres_per_pixel));
  ck_assert_double_eq_tol(p.bearing, 0, 1e-12);
}
END_TEST

// direction() is the oracle: a far point is seen in the same direction before and after.
START_TEST(what_is_far_stays_where_it_is_when_the_camera_turns) {
  const Lens lens(1, {640, 480});
  for (const double pan : {-0.2, 0.0, 0.15})
    for (const double tilt : {-0.1, 0.0, 0.12})
      for (const Point p : {Point{320, 240}, Point{30, 400}, Point{600, 20}}) {
        const Transform moved = lens.turn(0.3, 0.05, 0.3 + pan, 0.05 + tilt);
        const Point q = moved.apply({p.x - 0.5, p.y - 0.5});
        const Direction before = lens.direction(p, 0.3, 0.05);
        const Direction after = lens.direction({q.x + 0.5, q.y + 0.5}, 0.3 + pan, 0.05 + tilt);
        ck_assert_double_eq_tol(after.bearing, before.bearing, 1e-9);
        ck_assert_double_eq_tol(after.elevation, before.elevation, 1e-9);
      }
  ck_assert(Lens().turn(0, 0, 1, 1).is_identity());
}
END_TEST

START_TEST(an_unset_lens_is_unknown) {
  for (const double fov : {0.0, -1.0, std::numbers::pi, 4.0, std::numeric_limits<double>::quiet_NaN()}) {
    const Lens lens(fov, {640, 480});
    ck_assert(!lens.known());
    ck_assert(std::isnan(lens.direction({1, 2}, 0, 0).bearing));
    ck_assert(std::isnan(lens.place({300, 100, 40, 100}, 0, 0, 0.8).distance));
  }
  ck_assert(!Lens(1, {0, 0}).known());
}
END_TEST

START_TEST(a_direction_is_found_again_in_the_picture_where_it_was_seen) {
  // tan 45 = 1 to the right is the picture's edge; half of it is atan 0.5; straight up by atan 0.75 is the upper edge.
  const auto edge = kLens.project({75 * kDegree, 0}, 30 * kDegree, 0);
  ck_assert(edge.has_value());
  ck_assert_double_eq_tol(edge->x, 640, 1e-9);
  ck_assert_double_eq_tol(edge->y, 240, 1e-9);
  const auto half = kLens.project({-std::atan(0.5), 0}, 0, 0);
  ck_assert_double_eq_tol(half->x, 160, 1e-9);
  const auto top =
      kLens.project({170 * kDegree, std::atan(0.75) - 20 * kDegree}, 170 * kDegree, -20 * kDegree);
  ck_assert_double_eq_tol(top->x, 320, 1e-9);
  ck_assert_double_eq_tol(top->y, 0, 1e-9);
  for (const double pan : {-170.0, 0.0, 95.0})
    for (const double tilt : {-40.0, 0.0, 25.0})
      for (const Point p : {Point{0, 0}, Point{17, 400}, Point{640, 480}}) {
        const auto back =
            kLens.project(kLens.direction(p, pan * kDegree, tilt * kDegree), pan * kDegree, tilt * kDegree);
        ck_assert(back.has_value());
        ck_assert_double_eq_tol(back->x, p.x, 1e-6);
        ck_assert_double_eq_tol(back->y, p.y, 1e-6);
      }
}
END_TEST

START_TEST(what_is_not_ahead_of_the_camera_has_no_place_in_the_picture) {
  ck_assert(kLens.project({86 * kDegree, 0}, 0, 0).has_value());
  for (const double bearing : {88.0, 90.0, 150.0, 180.0, -90.0})
    ck_assert(!kLens.project({bearing * kDegree, 0}, 0, 0).has_value());
  ck_assert(!kLens.project({0, 60 * kDegree}, 0, -40 * kDegree).has_value());
  ck_assert(!Lens().project({0, 0}, 0, 0).has_value());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ck_assert(!kLens.project({nan, 0}, 0, 0).has_value());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "lens",
      {the_focal_length_follows_from_the_width, the_middle_of_the_picture_is_where_the_camera_looks,
       right_in_the_picture_is_a_larger_bearing_and_up_a_larger_elevation,
       a_tilted_camera_sees_its_sides_further_round_than_a_level_one, bearings_wrap_into_minus_180_to_180,
       the_floor_is_as_far_as_the_mounting_height_at_45_degrees_down,
       the_floor_is_nowhere_on_and_above_the_horizon,
       a_person_four_metres_away_has_the_size_it_had_when_drawn, a_tilted_camera_measures_the_same_person,
       feet_that_are_not_in_the_picture_give_no_distance, what_is_far_stays_where_it_is_when_the_camera_turns,
       a_direction_is_found_again_in_the_picture_where_it_was_seen,
       what_is_not_ahead_of_the_camera_has_no_place_in_the_picture, an_unset_lens_is_unknown});
}
