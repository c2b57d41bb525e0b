// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's motion over dropped frames, against a lens and worked out by hand.
#include "vision/camera_path.h"

#include <cmath>

#include "support/motions.h"
#include "support/suite.h"
#include "vision/geometry/lens.h"

using namespace cerberus;
using namespace cerberus::vision;
using Link = CameraFollower::Link;

namespace {

constexpr Size kFrame{320, 240};
constexpr std::uint64_t kNever = ~std::uint64_t{0} - 1;  // no frame is from then

CameraPathPoint measured(const Transform& step, unsigned scene_age, std::uint64_t from = 0) {
  CameraPathPoint point;
  point.step = step;
  point.still = false;
  point.scene_age = scene_age;
  point.from = from;
  return point;
}

Transform shift(double x) {
  return tests::similarity(1, 0, x, 0);
}

}  // namespace

// Three times round: of a path this long the steps are still right, however many frames were missed. The truth is a
// lens's.
START_TEST(a_path_of_many_turns_gives_the_steps) {
  const Lens lens(60 * M_PI / 180, kFrame);
  constexpr double kStep = 2 * M_PI / 180;
  CameraPath path;
  CameraFollower follower;
  for (unsigned k = 0; k <= 540; ++k) {
    CameraPathPoint point = measured(lens.turn(0, -0.1, kStep, -0.1), k + 1);
    path.extend(point, kFrame);
    if (k % 5) continue;
    const auto seen = follower.next(point, kNever, kFrame);
    ck_assert_msg(k == 0 || seen.connected, "lost at %u", k);
    if (k == 0) continue;
    const Transform truth = lens.turn(0, -0.1, 5 * kStep, -0.1);
    for (const Point p : {Point{0, 0}, {319, 0}, {0, 239}, {319, 239}}) {
      const Point is = seen.motion.transform.apply(p), should = truth.apply(p);
      ck_assert_msg(std::hypot(is.x - should.x, is.y - should.y) < 0.01, "%u: %f %f, not %f %f", k, is.x,
                    is.y, should.x, should.y);
    }
  }
}
END_TEST

// A camera that zooms on without end: when rounding has consumed the steps a new path begins.
START_TEST(a_path_that_rounding_has_consumed_begins_anew) {
  CameraPath path;
  unsigned first = 0, last = 0;
  for (unsigned k = 0; k < 2000; ++k) {
    CameraPathPoint point = measured(tests::similarity(0.5, 0, 80, 60), k + 1);
    path.extend(point, kFrame);
    for (const double v : point.path.m) ck_assert(std::isfinite(v));
    last = point.path_id;
    if (k == 0) first = last;
  }
  ck_assert(first != 0 && last != first);
}
END_TEST

START_TEST(no_two_paths_have_the_same_number) {
  CameraPath one, two;
  CameraPathPoint a = measured(shift(1), 1), b = a;
  one.extend(a, kFrame);
  two.extend(b, kFrame);
  ck_assert(a.path_id != b.path_id);
  CameraFollower follower;
  follower.next(a, 0, kFrame);
  b.scene_age = 2;
  ck_assert(follower.next(b, 0, kFrame).link == Link::lost);  // another camera's stream
}
END_TEST

START_TEST(without_a_path_only_the_frame_before_is_connected) {
  CameraFollower follower;
  ck_assert(follower.next({}, 0, kFrame).link == Link::unmeasured);
  ck_assert(follower.next(measured(shift(1), 1), 0, kFrame).link == Link::cut);
  auto step = follower.next(measured(shift(3), 2, 40), 40, kFrame);
  ck_assert(step.link == Link::follows && !step.connected);
  ck_assert_double_eq_tol(step.motion.transform.apply({0, 0}).x, 3, 1e-12);
  ck_assert(follower.next(measured(shift(3), 3, 80), 79, kFrame).link == Link::lost);    // from another frame
  ck_assert(follower.next(measured(shift(3), 5, 120), 120, kFrame).link == Link::lost);  // one is missing
  ck_assert(follower.next(measured(shift(std::nan("")), 6, 160), 160, kFrame).link ==
            Link::lost);  // no camera does that
  ck_assert(follower.next({}, 160, kFrame).link == Link::lost);
  ck_assert(follower.next({}, 160, kFrame).link == Link::unmeasured);
}
END_TEST

START_TEST(a_camera_that_stood_still_over_dropped_frames_gives_exactly_the_identity) {
  CameraPath path;
  CameraFollower follower;
  for (unsigned k = 1; k <= 9; ++k) {
    CameraPathPoint point = measured(k < 4 ? shift(5) : Transform{}, k);
    point.still = k >= 4;
    path.extend(point, kFrame);
    if (k == 4) follower.next(point, kNever, kFrame);
    if (k < 9) continue;
    const auto step = follower.next(point, kNever, kFrame);
    ck_assert(step.link == Link::follows && step.connected && step.motion.still);
  }
}
END_TEST

int main() {
  return tests::run_suite(
      "camera_path", {a_path_of_many_turns_gives_the_steps, a_path_that_rounding_has_consumed_begins_anew,
                      no_two_paths_have_the_same_number, without_a_path_only_the_frame_before_is_connected,
                      a_camera_that_stood_still_over_dropped_frames_gives_exactly_the_identity});
}
