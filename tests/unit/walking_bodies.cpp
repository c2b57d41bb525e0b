// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/walking_bodies.h"

#include <algorithm>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

struct Scene {
  WalkingBodies bodies;
  Scene() { bodies.preallocate(); }
  double see(const Box& body, const Transform& motion = {}) {
    bodies.advance(motion);
    return bodies.add(body).farthest;
  }
};

}  // namespace

// 100 pixels tall, 10 pixels a frame.
START_TEST(a_body_has_walked_from_its_third_frame_on_and_as_far_as_it_ever_was) {
  Scene s;
  ck_assert_double_eq(s.see({100, 50, 36, 100}), 0);
  ck_assert_double_eq(s.see({110, 50, 36, 100}), 0);
  ck_assert_double_eq_tol(s.see({120, 50, 36, 100}), 0.2, 1e-6);
  ck_assert_double_eq_tol(s.see({130, 50, 36, 100}), 0.3, 1e-6);
  ck_assert_double_eq_tol(s.see({110, 50, 36, 100}), 0.3, 1e-6);
}
END_TEST

// It is found at places farther and farther away, and differs from the frame before in the first four frames only.
START_TEST(a_body_that_rests_goes_nowhere_and_keeps_its_walk) {
  WalkingBodies bodies;
  bodies.preallocate();
  for (int k = 0; k < 8; ++k) {
    bodies.advance({});
    const WalkingBodies::Walk walk = bodies.add({100.0 + 10 * k, 50, 36, 100}, k < 4);
    ck_assert_double_eq_tol(walk.farthest, k < 2 ? 0 : std::min(0.1 * k, 0.3), 1e-6);
    ck_assert(walk.goes_on == (k == 2 || k == 3));
  }
}
END_TEST

START_TEST(a_body_that_stays_in_the_scene_has_not_walked_however_the_camera_turns) {
  Scene still, turning;
  for (int k = 0; k < 10; ++k) {
    ck_assert_double_eq(still.see({100, 50, 36, 100}), 0);
    ck_assert_double_eq_tol(turning.see({100.0 + 12 * k, 50, 36, 100}, Transform::translation(12, 0)), 0,
                            1e-6);
  }
}
END_TEST

// Two frames at one place, then beyond the reach of a quarter of the height, of another height, or with a frame in between.
START_TEST(a_body_that_is_not_where_it_is_expected_begins_anew) {
  for (const Box& other : {Box{126, 50, 36, 100}, Box{100, 81, 36, 100}, Box{106, 71, 28, 79}}) {
    Scene s;
    s.see({95, 50, 36, 100});
    s.see({100, 50, 36, 100});
    ck_assert_double_eq(s.see(other), 0);
  }
  Scene s;
  s.see({95, 50, 36, 100});
  s.see({100, 50, 36, 100});
  s.bodies.advance({});
  ck_assert_double_eq(s.see({105, 50, 36, 100}), 0);
}
END_TEST

// 100 pixels tall, a stride is 8: after 12 pixels, and again 9 pixels after that; then it stands.
START_TEST(a_body_goes_on_by_strides_from_where_it_last_went_on) {
  WalkingBodies bodies;
  bodies.preallocate();
  const double places[] = {100, 106, 112, 115, 118, 121, 121, 121};
  const bool goes_on[] = {false, false, true, false, false, true, false, false};
  for (int k = 0; k < 8; ++k) {
    bodies.advance(Transform::translation(7, 0));
    ck_assert_int_eq(bodies.add({places[k] + 7 * k, 50, 36, 100}).goes_on, goes_on[k]);
  }
}
END_TEST

START_TEST(of_two_bodies_each_goes_on_from_the_nearer_place) {
  WalkingBodies bodies;
  bodies.preallocate();
  double left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    bodies.advance({});
    left = bodies.add({100, 50, 36, 100}).farthest;
    right = bodies.add({140.0 + 5 * k, 50, 36, 100}).farthest;
  }
  ck_assert_double_eq(left, 0);
  ck_assert_double_eq_tol(right, 0.1, 1e-6);
}
END_TEST

START_TEST(more_bodies_than_there_is_memory_for_have_not_walked) {
  WalkingBodies bodies;
  bodies.preallocate();
  const std::size_t bytes = bodies.bytes();
  for (int k = 0; k < 4; ++k) {
    bodies.advance({});
    for (std::size_t i = 0; i < WalkingBodies::kMost; ++i)
      ck_assert_double_eq(bodies.add({100.0 * static_cast<double>(i), 50, 36, 100}).farthest, 0);
    ck_assert_double_eq(bodies.add({-500 + 20.0 * k, 50, 36, 100}).farthest, 0);
  }
  ck_assert_uint_eq(bodies.bytes(), bytes);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "walking_bodies",
      {a_body_has_walked_from_its_third_frame_on_and_as_far_as_it_ever_was,
       a_body_that_rests_goes_nowhere_and_keeps_its_walk,
       a_body_that_stays_in_the_scene_has_not_walked_however_the_camera_turns,
       a_body_that_is_not_where_it_is_expected_begins_anew,
       a_body_goes_on_by_strides_from_where_it_last_went_on, of_two_bodies_each_goes_on_from_the_nearer_place,
       more_bodies_than_there_is_memory_for_have_not_walked});
}
