// SPDX-License-Identifier: LGPL-2.1-or-later
// When the camera stands, and when a scene begins.
#include "vision/ego_motion/camera_motion.h"

#include <check.h>

#include <cmath>
#include <functional>

#include "support/looks.h"
#include "support/sensor.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(the_first_frame_starts_a_scene) {
  CameraMotion camera;
  const CameraMotionResult r = camera.update(picture(Scene(1)).view());
  ck_assert_int_eq(r.scene_age, 1);
  ck_assert(r.transform.is_identity());
  ck_assert(!r.still);
  ck_assert_int_eq(camera.update(picture(Scene(1)).view()).scene_age, 2);
}
END_TEST

START_TEST(a_person_walking_past_a_standing_camera_leaves_it_still) {
  const Image<std::uint8_t> person = picture(Scene(78, 60));
  std::mt19937 random(8);
  CameraMotion camera;
  int still = 0;
  for (int k = 0; k < 40; ++k) {
    Image<std::uint8_t> frame = picture(Scene(8));
    paste(person, frame.view(), -110 + 11 * k, 20, 110, 220);  // a third of the picture, 11 pixels a frame
    add_noise(frame.view(), 2, 4, random);
    const CameraMotionResult r = camera.update(frame.view());
    ck_assert_int_eq(r.scene_age, k + 1);
    still += r.still;
  }
  ck_assert_int_ge(still, 39);
}
END_TEST

START_TEST(a_close_person_swaying_in_half_of_the_picture_leaves_the_camera_still) {
  const Image<std::uint8_t> coat = picture(Scene(91, 60));
  std::mt19937 random(25);
  CameraMotion camera;
  int still = 0;
  for (int k = 0; k < 40; ++k) {
    Image<std::uint8_t> frame = picture(Scene(25));
    paste(coat, frame.view(), 62 + static_cast<int>(std::lround(30 * std::sin(k / 5.0))), 44, 196, 196);
    add_noise(frame.view(), 2, 4, random);
    still += camera.update(frame.view()).still;
  }
  ck_assert_int_ge(still, 39);
}
END_TEST

// Frames, of the 39 after the first, in which a standing camera is reported to move. It sees a dull room, `lamps` that
// flicker, and a person who covers `person` from the lower edge on, with the left edge at left(k) in frame k.
int set_in_motion(std::uint32_t seed, double contrast, Light lamps, Size person,
                  const std::function<int(int)>& left) {
  const Image<std::uint8_t> room = picture(Scene(200 + seed, contrast)), coat = picture(Scene(90 + seed, 60));
  std::mt19937 random(seed);
  CameraMotion camera;
  int moved = 0;
  for (int k = 0; k < 40; ++k) {
    Image<std::uint8_t> frame(kSize);
    paste(room, frame.view(), 0, 0, kSize.width, kSize.height);
    paste(coat, frame.view(), left(k), kSize.height - person.height, person.width, person.height);
    lamps.phase = 0.17 * k;
    frame = mapped(frame, [&](double v, int y) { return v * lamps.at(y); });
    add_noise(frame.view(), 2, 6, random);
    moved += !camera.update(frame.view()).transform.is_identity();
  }
  return moved;
}

// Bands of light and a moving person resemble a motion of less than a pixel, which has a rival or few supporting
// patches. In so dull a room chance sets the camera in motion all the same, in up to 1 frame of 50. Without the test
// of the rival it would be 1 of 7 behind a swaying person; without the test of the support, 1 of 20 behind a walking
// one.
START_TEST(bands_of_light_behind_a_close_swaying_person_leave_the_camera_still) {
  int moved = 0, frames = 0;
  for (std::uint32_t seed = 0; seed < 2; ++seed)
    for (const Size person : {Size{120, 170}, Size{140, 180}})
      for (const double flicker : {0.05, 0.08}) {
        moved +=
            set_in_motion(seed, 30, {.global = flicker, .bands = flicker, .period = 140}, person, [&](int k) {
              return (kSize.width - person.width) / 2 + static_cast<int>(std::lround(30 * std::sin(k / 5.0)));
            });
        frames += 39;
      }
  ck_assert_msg(moved <= 0.03 * frames, "set in motion in %d of %d frames", moved, frames);
}
END_TEST

START_TEST(bands_of_light_behind_a_passing_person_leave_the_camera_still) {
  int moved = 0, frames = 0;
  for (std::uint32_t seed = 0; seed < 4; ++seed)
    for (const int width : {80, 100, 120}) {
      moved += set_in_motion(seed, 36, {.global = 0.1, .bands = 0.1, .period = 80}, {width, 180},
                             [&](int k) { return 10 * k - width; });
      frames += 39;
    }
  ck_assert_msg(moved <= 0.035 * frames, "set in motion in %d of %d frames", moved, frames);
}
END_TEST

START_TEST(a_person_before_a_blank_wall_is_not_the_camera) {
  const Image<std::uint8_t> person = picture(Scene(79, 60));
  std::mt19937 random(20);
  CameraMotion camera;
  for (int k = 0; k < 20; ++k) {
    Image<std::uint8_t> frame = flat(120, random);
    paste(person, frame.view(), 60 + 7 * std::max(k - 2, 0), 100, 60, 130);  // stands, then walks
    const CameraMotionResult r = camera.update(frame.view());
    ck_assert(r.transform.is_identity());
    if (k > 2) ck_assert_double_eq(r.confidence, 0);
    // A reported pose of the head has priority.
    if (k == 19) {
      Image<std::uint8_t> last = flat(120, random);
      paste(person, last.view(), 60 + 7 * 18, 100, 60, 130);
      ck_assert_double_lt(disagreement(camera.update(last.view(), Transform::translation(5, 0)).transform,
                                       Transform::translation(5, 0)),
                          1e-9);
    }
  }
}
END_TEST

START_TEST(a_camera_that_stood_before_a_bare_wall_is_set_in_motion_by_all_that_is_on_it) {
  // A doorway and no more. What is wider than a person is no person.
  const Image<std::uint8_t> door = picture(Scene(81, 60));
  std::mt19937 random(22);
  CameraMotion camera;
  Point before{180, 70};
  for (int k = 0; k < 20; ++k) {
    const Point at = k < 4 ? before : Point{180.0 + 4 * (k * 7 % 5 - 2), 70.0 + 3 * (k * 3 % 4 - 1.0)};
    Image<std::uint8_t> frame = flat(120, random);
    paste(door, frame.view(), static_cast<int>(at.x), static_cast<int>(at.y), 120, 130);
    const CameraMotionResult r = camera.update(frame.view());
    if (k > 3) {
      const Point moved = r.transform.apply({240, 135});
      ck_assert_double_eq_tol(moved.x - 240, at.x - before.x, 0.2);
      ck_assert_double_eq_tol(moved.y - 135, at.y - before.y, 0.2);
      ck_assert_double_gt(r.confidence, 0.5);
    } else if (k > 0) {
      ck_assert(r.still);
    }
    before = at;
  }
}
END_TEST

START_TEST(patches_left_behind_on_a_bare_wall_show_that_the_camera_stands) {
  const Image<std::uint8_t> car = picture(Scene(82, 60)), picture_on_the_wall = picture(Scene(83, 60));
  std::mt19937 random(23);
  CameraMotion camera;
  for (int k = 0; k < 20; ++k) {
    Image<std::uint8_t> frame = flat(120, random);
    paste(picture_on_the_wall, frame.view(), 40, 20, 40, 30);
    paste(car, frame.view(), 60 + 6 * std::max(k - 2, 0), 130, 115, 90);
    const CameraMotionResult r = camera.update(frame.view());
    ck_assert_msg(r.transform.is_identity(), "frame %d", k);
  }
}
END_TEST

START_TEST(a_standing_camera_is_exactly_still_under_noise_flicker_and_exposure) {
  std::mt19937 random(9);
  const Image<std::uint8_t> scene = picture(Scene(9));
  // 100 Hz light seen by a rolling shutter: bands that wander; exposure that drifts, and that steps.
  const std::function<double(double, int, int)> lights[] = {
      [](double v, int, int) { return v; },
      [](double v, int y, int k) { return v * (1 + 0.08 * std::sin(0.9 * k + 0.03 * y)); },
      [](double v, int, int k) { return v * (1 - 0.004 * k); },
      [](double v, int, int k) { return k / 10 % 2 ? 1.4 * v - 10 : 0.8 * v + 10; }};
  for (const auto& light : lights) {
    CameraMotion camera;
    int still = 0;
    for (int k = 0; k < 100; ++k) {
      Image<std::uint8_t> frame = mapped(scene, [&](double v, int y) { return light(v, y, k); });
      add_noise(frame.view(), 2, 6, random);
      const CameraMotionResult r = camera.update(frame.view());
      ck_assert_int_eq(r.scene_age, k + 1);
      still += r.still;
      ck_assert(!r.still || r.transform.is_identity());
    }
    ck_assert_int_ge(still, 98);
  }
}
END_TEST

START_TEST(vibration_of_three_tenths_of_a_pixel_is_not_snapped_away) {
  std::mt19937 random(10);
  CameraMotion camera;
  double before = 0;
  for (int k = 0; k < 40; ++k) {
    const double x = k % 2 ? 0.3 : 0;
    Image<std::uint8_t> frame = picture(Scene(10), Transform::translation(x, 0));
    add_noise(frame.view(), 2, 4, random);
    const CameraMotionResult r = camera.update(frame.view());
    if (k > 0) {
      ck_assert(!r.still);
      ck_assert_double_eq_tol(r.transform.apply({160, 120}).x - 160, x - before, 0.06);
    }
    before = x;
  }
}
END_TEST

START_TEST(a_drift_too_slow_to_see_between_two_frames_adds_up) {
  std::mt19937 random(11);
  CameraMotion camera;
  Transform total;
  for (int k = 0; k < 100; ++k) {
    Image<std::uint8_t> frame = picture(Scene(11), Transform::translation(0.05 * k, 0));
    add_noise(frame.view(), 2, 2, random);
    total = camera.update(frame.view()).transform * total;
    ck_assert_double_eq_tol(total.apply({160, 120}).x - 160, 0.05 * k, 0.35);
  }
}
END_TEST

START_TEST(a_cut_starts_a_scene_and_the_next_frame_continues_it) {
  CameraMotion camera;
  for (std::uint32_t scene = 100; scene < 140; ++scene) {
    const CameraMotionResult cut = camera.update(picture(Scene(scene)).view());
    ck_assert_int_eq(cut.scene_age, 1);
    ck_assert(cut.transform.is_identity());
    ck_assert_int_eq(camera.update(picture(Scene(scene), Transform::translation(3, 1)).view()).scene_age, 2);
  }
}
END_TEST

START_TEST(a_cut_to_black_and_back_is_found) {
  std::mt19937 random(13);
  const Image<std::uint8_t> scene = picture(Scene(13)), black = flat(16, random),
                            more_black = flat(16, random);
  CameraMotion camera;
  const int ages[] = {1, 2, 1, 2, 1, 2};
  const Image<std::uint8_t>* frames[] = {&scene, &scene, &black, &more_black, &scene, &scene};
  for (int k = 0; k < 6; ++k) ck_assert_int_eq(camera.update(frames[k]->view()).scene_age, ages[k]);
}
END_TEST

START_TEST(a_featureless_picture_stands_still_without_confidence) {
  std::mt19937 random(14);
  CameraMotion camera;
  for (int k = 0; k < 10; ++k) {
    const CameraMotionResult r = camera.update(flat(120, random).view());
    ck_assert_int_eq(r.scene_age, k + 1);
    ck_assert(r.transform.is_identity());
    ck_assert_double_eq(r.confidence, 0);
  }
}
END_TEST

START_TEST(a_new_picture_size_and_a_reset_start_a_scene) {
  CameraMotion camera;
  camera.update(picture(Scene(16)).view());
  ck_assert_int_eq(camera.update(picture(Scene(16)).view()).scene_age, 2);
  ck_assert_int_eq(camera.update(picture(Scene(16), {}, {160, 120}).view()).scene_age, 1);
  ck_assert_int_eq(camera.update(picture(Scene(16), {}, {160, 120}).view()).scene_age, 2);
  camera.reset();
  ck_assert_int_eq(camera.update(picture(Scene(16), {}, {160, 120}).view()).scene_age, 1);
}
END_TEST

int main() {
  return run_suite(
      "camera_stands",
      {the_first_frame_starts_a_scene, a_person_walking_past_a_standing_camera_leaves_it_still,
       a_close_person_swaying_in_half_of_the_picture_leaves_the_camera_still,
       bands_of_light_behind_a_close_swaying_person_leave_the_camera_still,
       bands_of_light_behind_a_passing_person_leave_the_camera_still,
       a_person_before_a_blank_wall_is_not_the_camera,
       a_camera_that_stood_before_a_bare_wall_is_set_in_motion_by_all_that_is_on_it,
       patches_left_behind_on_a_bare_wall_show_that_the_camera_stands,
       a_standing_camera_is_exactly_still_under_noise_flicker_and_exposure,
       vibration_of_three_tenths_of_a_pixel_is_not_snapped_away,
       a_drift_too_slow_to_see_between_two_frames_adds_up,
       a_cut_starts_a_scene_and_the_next_frame_continues_it, a_cut_to_black_and_back_is_found,
       a_featureless_picture_stands_still_without_confidence, a_new_picture_size_and_a_reset_start_a_scene});
}
