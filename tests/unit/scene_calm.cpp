// SPDX-License-Identifier: LGPL-2.1-or-later
// How calm a scene is, from the corners of synthetic pictures.
#include "vision/ego_motion/scene_calm.h"

#include <check.h>

#include "support/looks.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr double kFrame = 0.04;
const Transform kMoves = Transform::translation(2, 0);

// The share after three seconds in which the camera moves by `step` a frame; the lower part of the picture, from row `near` on, by
// `parallax` pixels more.
double calm_of(const Transform& step, int near, double parallax, std::span<const Box> objects = {},
               double noise = 2) {
  std::mt19937 random(3);
  CameraMotion camera;
  SceneCalm calm;
  Transform far;
  for (int k = 0; k < 75; ++k, far = step * far) {
    Image<std::uint8_t> frame = picture(Scene(5), far);
    const Image<std::uint8_t> front = picture(Scene(6), Transform::translation(k * parallax, 0) * far);
    for (int y = near; y < kSize.height; ++y)
      std::copy_n(front.view().row(y), kSize.width, frame.view().row(y));
    add_noise(frame.view(), noise, noise, random);
    const CameraMotionResult result = camera.update(frame.view());
    calm.add(result.corners, result.transform, objects, kSize, kFrame);
  }
  return calm.share();
}

SceneCorners corners(int count, int fitting) {
  SceneCorners c;
  for (int i = 0; i < count; ++i) c.corner[c.count++] = {static_cast<std::uint8_t>(8 * i), 20, i < fitting};
  return c;
}

}  // namespace

START_TEST(a_scene_that_only_the_camera_moves_is_calm) {
  ck_assert_double_gt(calm_of({}, kSize.height, 0), 0.97);
  ck_assert_double_gt(calm_of(Transform::translation(2.3, -0.8), kSize.height, 0), 0.97);
  ck_assert_double_gt(calm_of(about_centre(1.004, 0.003, 1.5, 0.5), kSize.height, 0), 0.95);
}
END_TEST

START_TEST(a_scene_whose_near_half_moves_by_parallax_is_not) {
  ck_assert_double_lt(calm_of(Transform::translation(1.5, 0), kSize.height / 2, 1.2), 0.7);
  ck_assert_double_lt(calm_of(Transform::translation(1.5, 0), kSize.height / 3, 3), 0.7);
}
END_TEST

START_TEST(what_is_within_a_track_says_nothing_of_the_scene) {
  const Box near{0, 160, 320, 80};
  const double with = calm_of(Transform::translation(1.5, 0), 160, 3);
  ck_assert_double_lt(with, 0.8);
  ck_assert_double_gt(calm_of(Transform::translation(1.5, 0), 160, 3, {&near, 1}), 0.95);
}
END_TEST

START_TEST(the_share_is_a_running_mean_of_a_second_from_one_on) {
  SceneCalm calm;
  ck_assert_double_eq(calm.share(), 1);
  calm.add(corners(20, 10), kMoves, {}, kSize, 0.1);
  ck_assert_double_eq_tol(calm.share(), 0.95, 1e-9);
  for (int i = 0; i < 60; ++i) calm.add(corners(20, 4), kMoves, {}, kSize, 0.1);
  ck_assert_double_eq_tol(calm.share(), 0.2, 0.01);
  calm.add(corners(20, 20), kMoves, {}, kSize, 0);  // as long as the step before
  ck_assert_double_eq_tol(calm.share(), 0.28, 0.01);
  calm.add(corners(20, 10), kMoves, {}, kSize, 2);  // more than the memory at once
  ck_assert_double_eq_tol(calm.share(), 0.5, 1e-9);
  calm.reset();
  ck_assert_double_eq(calm.share(), 1);
}
END_TEST

START_TEST(few_corners_say_nothing) {
  SceneCalm calm;
  calm.add(corners(7, 0), kMoves, {}, kSize, 1);
  ck_assert_double_eq(calm.share(), 1);
  calm.add(corners(10, 5), kMoves, {}, kSize, 1);
  ck_assert_double_eq_tol(calm.share(), 0.5, 1e-9);
  const Box most{0, 0, 40, 40};  // touches five of ten
  calm.add(corners(10, 0), kMoves, {&most, 1}, kSize, 1);
  ck_assert_double_eq_tol(calm.share(), 0.5, 1e-9);
}
END_TEST

START_TEST(a_camera_that_hardly_moves_is_calm_whatever_noise_does_to_its_corners) {
  // Half a pixel of a picture 320 wide.
  for (const double step : {0.0, 0.4}) {
    SceneCalm calm;
    calm.add(corners(20, 0), kMoves, {}, kSize, 1);
    ck_assert_double_eq_tol(calm.share(), 0, 1e-9);
    for (int i = 0; i < 50; ++i) calm.add(corners(20, 0), Transform::translation(step, 0), {}, kSize, 0.1);
    ck_assert_double_gt(calm.share(), 0.98);
    calm.add(corners(20, 0), Transform::translation(0.6, 0), {}, kSize, 1);
    ck_assert_double_eq_tol(calm.share(), 0, 1e-9);
  }
}
END_TEST

int main() {
  return run_suite(
      "scene_calm",
      {a_scene_that_only_the_camera_moves_is_calm, a_scene_whose_near_half_moves_by_parallax_is_not,
       what_is_within_a_track_says_nothing_of_the_scene, the_share_is_a_running_mean_of_a_second_from_one_on,
       few_corners_say_nothing, a_camera_that_hardly_moves_is_calm_whatever_noise_does_to_its_corners});
}
