// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/trails.h"

#include <check.h>

#include <limits>

#include "support/motions.h"
#include "support/suite.h"

using namespace cerberus::overlay;
using namespace cerberus::vision;

static const Size kFrame{320, 240};

static void step(Trails& trails, double time, const Transform& motion, std::uint32_t id, double x, double y) {
  const TrailMark mark{id, {x, y}};
  trails.update(time, 1.0, motion, kFrame, {&mark, 1});
}

START_TEST(a_trail_grows_by_one_point_a_frame_and_keeps_its_order) {
  Trails trails;
  for (int k = 0; k < 5; ++k) step(trails, 0.1 * k, {}, 7, 10.0 * k, 5);
  ck_assert_int_eq(trails.trails().size(), 1);
  ck_assert_int_eq(trails.trails()[0].points.size(), 5);
  ck_assert_double_eq(trails.trails()[0].points[0].position.x, 0);
  ck_assert_double_eq(trails.trails()[0].points[4].position.x, 40);
}
END_TEST

START_TEST(points_older_than_the_duration_go) {
  Trails trails;
  for (int k = 0; k < 40; ++k) step(trails, 0.25 * k, {}, 7, k, 5);
  // At 9.75 s, one second back: 8.75, 9.0, 9.25, 9.5, 9.75.
  ck_assert_int_eq(trails.trails()[0].points.size(), 5);
  ck_assert_double_eq(trails.trails()[0].points[0].position.x, 35);
}
END_TEST

START_TEST(a_trail_lies_still_on_the_scene_while_the_camera_pans) {
  Trails trails;
  // A person who stands: the picture moves 3 pixels left a frame, and so does the mark.
  for (int k = 0; k < 8; ++k)
    step(trails, 0.1 * k, Transform::translation(-3, 1), 7, 100 - 3.0 * k, 50 + 1.0 * k);
  for (const TrailPoint& p : trails.trails()[0].points) {
    ck_assert_double_eq_tol(p.position.x, 79, 1e-9);
    ck_assert_double_eq_tol(p.position.y, 57, 1e-9);
  }
}
END_TEST

START_TEST(a_lost_object_leaves_its_trail_until_the_duration_is_over) {
  Trails trails;
  step(trails, 0, {}, 7, 10, 10);
  trails.update(0.9, 1.0, {}, kFrame, {});
  ck_assert_int_eq(trails.trails().size(), 1);
  trails.update(1.1, 1.0, {}, kFrame, {});
  ck_assert_int_eq(trails.trails().size(), 0);
}
END_TEST

START_TEST(points_carried_far_away_are_dropped_with_all_before_them) {
  Trails trails;
  step(trails, 0.0, {}, 7, 10, 10);
  step(trails, 0.1, {}, 7, 300, 10);
  // Scaling by 10 about the origin: (10, 10) stays near the picture, the newer (300, 10) does not.
  step(trails, 0.2, cerberus::tests::similarity(10, 0, 0, 0), 7, 50, 60);
  ck_assert_int_eq(trails.trails()[0].points.size(), 1);
  ck_assert_double_eq(trails.trails()[0].points[0].position.x, 50);
}
END_TEST

START_TEST(not_a_number_leaves_no_mark) {
  Trails trails;
  step(trails, 0.0, {}, 7, std::numeric_limits<double>::quiet_NaN(), 10);
  ck_assert_int_eq(trails.trails().size(), 0);
  step(trails, 0.1, {}, 7, 1, 10);
  Transform broken;
  broken.m[2] = std::numeric_limits<double>::infinity();
  trails.update(0.2, 1.0, broken, kFrame, {});
  ck_assert_int_eq(trails.trails().size(), 0);
}
END_TEST

START_TEST(a_trail_is_bounded_whatever_the_duration) {
  Trails trails;
  const TrailMark mark{1, {1, 1}};
  for (std::size_t k = 0; k < 3 * Trails::kMostPoints; ++k)
    trails.update(1e-3 * k, 1e9, {}, kFrame, {&mark, 1});
  ck_assert_int_eq(trails.trails()[0].points.size(), Trails::kMostPoints);
  ck_assert_double_eq(trails.trails()[0].points.back().time, 1e-3 * (3 * Trails::kMostPoints - 1));
}
END_TEST

START_TEST(long_gone_trails_make_room_for_new_ones) {
  Trails trails;
  const int most = static_cast<int>(Trails::kMostTrails);
  for (int k = 0; k < most + 10; ++k) {
    const TrailMark mark{static_cast<std::uint32_t>(k + 1), {1, 1}};
    trails.update(k, 1e9, {}, kFrame, {&mark, 1});
  }
  ck_assert_int_eq(trails.trails().size(), most);
  for (const auto& trail : trails.trails()) ck_assert_int_gt(trail.id, 10);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "trails", {a_trail_grows_by_one_point_a_frame_and_keeps_its_order, points_older_than_the_duration_go,
                 a_trail_lies_still_on_the_scene_while_the_camera_pans,
                 a_lost_object_leaves_its_trail_until_the_duration_is_over,
                 points_carried_far_away_are_dropped_with_all_before_them, not_a_number_leaves_no_mark,
                 a_trail_is_bounded_whatever_the_duration, long_gone_trails_make_room_for_new_ones});
}
