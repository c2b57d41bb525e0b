// SPDX-License-Identifier: LGPL-2.1-or-later
// How right the camera motion is, on a synthetic scene whose true motion is known exactly.
#include "vision/ego_motion/camera_motion.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <vector>

#include "support/allocations.h"
#include "support/looks.h"
#include "support/suite.h"
#include "vision/geometry/lens.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(a_shift_is_found_to_a_twentieth_of_a_pixel_up_to_a_quarter_of_the_width) {
  const double shifts[][2] = {{0.3, 0}, {-0.4, 0.7}, {1.5, -2.25}, {5.5, 3.1},
                              {-15, 4}, {40, -9},    {-78, 11},    {20, 55}};
  for (const auto& s : shifts) {
    const Transform truth = Transform::translation(s[0], s[1]);
    const CameraMotionResult r = between(Scene(2), truth);
    ck_assert_msg(disagreement(r.transform, truth) < 0.1, "shift %g %g: off by %g", s[0], s[1],
                  disagreement(r.transform, truth));
    const Point centre = r.transform.apply({160, 120});
    ck_assert_double_eq_tol(centre.x - 160, s[0], 0.05);
    ck_assert_double_eq_tol(centre.y - 120, s[1], 0.05);
    ck_assert(!r.still);
    ck_assert_int_eq(r.scene_age, 2);
    ck_assert_double_gt(r.confidence, 0.8);
  }
}
END_TEST

START_TEST(turning_and_zooming_are_found) {
  for (const Transform& truth : {about_centre(1.03, 0.03, 4, -3), about_centre(0.96, -0.05, -11, 6),
                                 about_centre(1.0, 0.004, 0, 0), about_centre(1.08, 0, 10, 10)}) {
    const CameraMotionResult r = between(Scene(3), truth);
    ck_assert_msg(disagreement(r.transform, truth) < 0.2, "off by %g", disagreement(r.transform, truth));
    ck_assert_double_gt(r.confidence, 0.7);
  }
}
END_TEST

START_TEST(a_real_pan_is_a_homography_and_found_without_a_word_from_the_head) {
  // 1.5 degrees of pan and half a degree of roll through a 60 degree lens: K R K^-1.
  const double f = 0.5 * kSize.width / std::tan(30 * M_PI / 180), a = 1.5 * M_PI / 180;
  const double cx = 0.5 * (kSize.width - 1), cy = 0.5 * (kSize.height - 1);
  const Transform k{{f, 0, cx, 0, f, cy, 0, 0, 1}};
  const Transform pan{{std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a)}};
  const Transform truth = k * pan * similarity(1, 0.5 * M_PI / 180, 0, 0) * k.inverse();
  // A similarity with the bend of a turning camera is all that a turn needs.
  for (const MotionModel model : {MotionModel::homography, MotionModel::similarity}) {
    const double off = disagreement(between(Scene(4), truth, model).transform, truth);
    ck_assert_msg(off < 0.25, "model %d is off by %g", static_cast<int>(model), off);
  }
  // The other models do what they can: the middle of the picture is right.
  for (const MotionModel model : {MotionModel::translation, MotionModel::affine}) {
    const CameraMotionResult r = between(Scene(4), truth, model);
    const Point p = truth.apply({cx, cy}), q = r.transform.apply({cx, cy});
    ck_assert_double_lt(std::hypot(p.x - q.x, p.y - q.y), 1.0);
    ck_assert_double_gt(disagreement(r.transform, truth), 0.25);
  }
}
END_TEST

// A shift is off by up to 8 pixels at the corners; on top of the head's reported turn it need not be.
START_TEST(over_a_heads_turn_a_simple_model_is_as_good_as_a_homography) {
  const Lens lens(60 * M_PI / 180, kSize);
  const double pan = 3 * M_PI / 180, tilt = -0.5 * M_PI / 180;
  const Transform truth = lens.turn(0, 0, pan, tilt);
  const auto off = [&](const std::optional<Transform>& prior) {
    return disagreement(between(Scene(4), truth, MotionModel::translation, 2, prior).transform, truth);
  };
  ck_assert_double_gt(off(std::nullopt), 5);
  ck_assert_double_lt(off(truth), 0.3);
  ck_assert_double_lt(off(lens.turn(0, 0, 0.85 * pan, 0)), 2.0);  // a head that is a little late
  ck_assert_double_lt(off(lens.turn(0, 0, -pan, 0)), off(std::nullopt) + 0.3);
  for (const auto& prior : {truth, lens.turn(0, 0, 0.85 * pan, 0), lens.turn(0, 0, -pan, 0)})
    ck_assert_double_lt(
        disagreement(between(Scene(4), truth, MotionModel::similarity, 2, prior).transform, truth), 0.3);
  // A picture that shifts though the head turned (virtualptz: a window over a flat picture) is found as it is.
  const Transform shift = Transform::translation(-14.5, 2);
  for (const MotionModel model : {MotionModel::translation, MotionModel::similarity})
    ck_assert_double_lt(disagreement(between(Scene(4), shift, model, 2, truth).transform, shift), 0.2);
}
END_TEST

START_TEST(an_affine_motion_is_found_by_the_affine_model) {
  const Transform truth{{1.02, 0.015, 2, -0.005, 0.98, -3, 0, 0, 1}};
  ck_assert_double_lt(disagreement(between(Scene(5), truth, MotionModel::affine).transform, truth), 0.25);
  ck_assert_double_lt(disagreement(between(Scene(5), truth, MotionModel::homography).transform, truth), 0.25);
}
END_TEST

START_TEST(translation_alone_gives_translation_alone_and_none_gives_identity) {
  const Transform truth = about_centre(1.01, 0.01, 6, -2);
  const Transform t = between(Scene(6), truth, MotionModel::translation).transform;
  ck_assert(t.m[0] == 1 && t.m[1] == 0 && t.m[3] == 0 && t.m[4] == 1 && t.is_affine());
  const CameraMotionResult none = between(Scene(6), truth, MotionModel::none);
  ck_assert(none.transform.is_identity());
  ck_assert(none.still);
}
END_TEST

START_TEST(objects_over_nearly_half_the_picture_do_not_move_the_camera) {
  const Image<std::uint8_t> object = picture(Scene(77, 60));
  const Transform truth = about_centre(1.0, 0.005, 5, 2);
  Image<std::uint8_t> earlier = picture(Scene(7)), later = picture(Scene(7), truth);
  paste(object, earlier.view(), 80, 30, 150,
        205);  // 40 % of the picture, goes left while the camera's picture goes right
  paste(object, later.view(), 72, 30, 150, 205);
  CameraMotion camera;
  camera.update(earlier.view());
  const CameraMotionResult r = camera.update(later.view());
  ck_assert_msg(disagreement(r.transform, truth) < 0.3, "off by %g", disagreement(r.transform, truth));
  ck_assert_double_lt(r.confidence, 0.75);  // the confidence shows how much disagrees
}
END_TEST

// Frames in which a camera is astray by more than a pixel while it stands for 5 frames and then pans by `pan` pixels a
// frame, 24 in all. A person who covers that many pixels to a side sways before it.
int astray_behind(int side, double pan, double view) {
  const Scene scene(31);
  const Image<std::uint8_t> coat = picture(Scene(90, 60));
  const Lens lens(view * M_PI / 180, kSize);
  std::mt19937 random(24);
  CameraMotion camera;
  Transform motion;
  int astray = 0;
  for (int k = 0; k < 24; ++k) {
    const double angle = k < 5 ? 0 : std::atan(pan / lens.focal_length());
    const Transform turn = lens.turn(0, 0, angle, 0);
    motion = turn * motion;
    Image<std::uint8_t> frame = picture(scene, motion);
    const int x = (kSize.width - side) / 2 + static_cast<int>(std::lround(30 * std::sin(k / 5.0)));
    paste(coat, frame.view(), x, kSize.height - side, side, side);
    add_noise(frame.view(), 2, 4, random);
    const CameraMotionResult r = camera.update(frame.view());
    ck_assert_int_eq(r.scene_age, k + 1);
    if (k > 0) astray += disagreement(r.transform, turn) > 1;
  }
  return astray;
}

START_TEST(a_pan_is_measured_behind_a_close_person) {
  for (const double view : {60.0, 95.0})
    for (const double pan : {1.0, 4.0, 10.0}) {
      const int fifth = astray_behind(120, pan, view), quarter = astray_behind(138, pan, view);
      ck_assert_msg(fifth == 0 && quarter <= 1, "a lens of %g, %g pixels a frame: %d and %d frames astray",
                    view, pan, fifth, quarter);
    }
}
END_TEST

// A close person at rest covers a third of the picture when the camera begins to pan. On the coarse picture most
// patches follow the person; the finer levels must search for the motion of the others, too.
START_TEST(a_pan_that_begins_behind_a_close_person_at_rest_is_found_on_finer_levels) {
  constexpr int kStands = 3, kFrames = 7, kMostPan = 20, kWay = kMostPan * (kFrames - kStands);
  constexpr Size kPerson{180, 140};
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const Image<std::uint8_t> coat = picture(Scene(90 + seed, 60), {}, kPerson);
    const Image<std::uint8_t> room = picture(Scene(31 + seed), {}, {kWay + kSize.width + kWay, kSize.height});
    std::mt19937 random(24 + seed);
    for (const int pan : {-kMostPan, -10, -6, 6, 10, kMostPan}) {
      CameraMotion camera;
      for (int k = 0; k < kFrames; ++k) {
        const int left = kWay + pan * std::max(k - kStands + 1, 0);
        Image<std::uint8_t> frame(kSize);
        for (int y = 0; y < kSize.height; ++y)
          std::copy_n(room.view().row(y) + left, kSize.width, frame.view().row(y));
        paste(coat, frame.view(), (kSize.width - kPerson.width) / 2, kSize.height - kPerson.height,
              kPerson.width, kPerson.height);
        add_noise(frame.view(), 2, 4, random);
        const CameraMotionResult r = camera.update(frame.view());
        // Noise costs a tenth of a pixel at the corners where all of the picture has patches. A fit that takes him for
        // the background is off by the whole pan.
        const double off = disagreement(r.transform, Transform::translation(k < kStands ? 0 : -pan, 0));
        ck_assert_msg(off < 0.5, "seed %u, %d pixels a frame, frame %d: off by %g", seed, pan, k, off);
      }
    }
  }
}
END_TEST

constexpr int kPan = 4;

// By how many pixels a camera is astray in each frame that pans by kPan of them past shelves, and then along a wall
// with these things on it. The model is none from frame none_from on.
std::vector<double> pan_along_a_wall(std::initializer_list<std::array<int, 4>> things, int frames,
                                     int none_from = -1) {
  std::mt19937 random(21);
  const Image<std::uint8_t> texture = picture(Scene(84, 60));
  Image<std::uint8_t> wall = flat(130, random, {kSize.width + kPan * frames, kSize.height});
  paste(texture, wall.view(), 0, 0, 250, 240);
  for (const auto [x, y, width, height] : things) paste(texture, wall.view(), x, y, width, height);
  CameraMotion camera;
  std::vector<double> astray;
  for (int k = 0; k < frames; ++k) {
    Image<std::uint8_t> frame(kSize);
    for (int y = 0; y < kSize.height; ++y)
      std::copy_n(wall.view().row(y) + kPan * k, kSize.width, frame.view().row(y));
    add_noise(frame.view(), 2, 4, random);
    if (k == none_from) camera.set_options({MotionModel::none});
    const CameraMotionResult r = camera.update(frame.view());
    ck_assert_int_eq(r.scene_age, k + 1);
    if (k > 0) astray.push_back(disagreement(r.transform, Transform::translation(-kPan, 0)));
  }
  return astray;
}

START_TEST(a_camera_that_pans_along_a_bare_wall_goes_on) {
  const auto astray = pan_along_a_wall({{330, 70, 50, 60}, {600, 20, 60, 50}, {830, 150, 50, 60}}, 140);
  ck_assert_double_lt(*std::ranges::max_element(astray), 2);
  ck_assert_double_lt(std::accumulate(astray.begin(), astray.end(), 0.0), 0.3 * 139);
}
END_TEST

// Although it moves past a wall without texture.
START_TEST(a_camera_that_moved_stands_from_the_frame_on_in_which_the_model_is_none) {
  const auto astray = pan_along_a_wall({{330, 70, 50, 60}}, 90, 80);
  ck_assert_double_lt(*std::max_element(astray.begin(), astray.begin() + 79), 2);
  for (std::size_t k = 79; k < astray.size(); ++k) ck_assert_double_eq(astray[k], kPan);
}
END_TEST

START_TEST(a_camera_before_a_blank_wall_is_measured_again_from_the_first_wide_object) {
  const auto astray = pan_along_a_wall({{330, 70, 50, 60}, {720, 180, 240, 40}}, 180);
  ck_assert_double_lt(*std::max_element(astray.begin(), astray.begin() + 90),
                      2);               // one thing in view at least
  ck_assert_double_gt(astray[105], 3);  // nothing, and nothing made up
  ck_assert_double_lt(*std::max_element(astray.end() - 20, astray.end()), 2);
}
END_TEST

START_TEST(an_exposure_step_in_mid_pan_is_no_cut_and_costs_no_accuracy) {
  const Transform truth = Transform::translation(9.5, -4);
  for (const double gain : {0.5, 0.7, 1.4}) {
    CameraMotion camera;
    camera.update(picture(Scene(12)).view());
    const CameraMotionResult r =
        camera.update(mapped(picture(Scene(12), truth), [&](double v, int) { return gain * v + 8; }).view());
    ck_assert_int_eq(r.scene_age, 2);
    ck_assert_msg(disagreement(r.transform, truth) < 0.2, "gain %g: off by %g", gain,
                  disagreement(r.transform, truth));
  }
}
END_TEST

START_TEST(the_heads_pose_finds_what_no_search_reaches_and_a_wrong_one_is_not_believed) {
  const Transform truth = Transform::translation(130, -20);  // 40 % of the width
  ck_assert_double_lt(
      disagreement(
          between(Scene(15), truth, MotionModel::similarity, 2, Transform::translation(127, -22)).transform,
          truth),
      0.2);
  const Transform slow = Transform::translation(2, 1);
  for (const Transform& wrong : {Transform::translation(-60, 30), Transform{{1, 0, NAN, 0, 1, 0, 0, 0, 1}},
                                 Transform{{0, 0, 0, 0, 0, 0, 0, 0, 0}}})
    ck_assert_double_lt(
        disagreement(between(Scene(15), slow, MotionModel::similarity, 2, wrong).transform, slow), 0.1);
}
END_TEST

START_TEST(odd_sizes_work_and_nothing_outside_the_picture_is_read) {
  const Size sizes[] = {{1, 1},   {1, 50},  {7, 5},     {15, 300}, {16, 16},
                        {33, 35}, {65, 17}, {321, 179}, {1021, 67}};
  for (const Size size : sizes) {
    CameraMotion camera;
    const GuardedPicture first(size, 3), second(size, 3);
    look(Scene(17), {}, first.view());
    look(Scene(17), Transform::translation(2, 1), second.view());
    camera.update(first.view());
    const CameraMotionResult r = camera.update(second.view());
    ck_assert(r.transform.is_sane(size));
    if (std::min(size.width, size.height) >= 32)
      ck_assert_double_lt(disagreement(r.transform, Transform::translation(2, 1), size), 0.5);
  }
  CameraMotion camera;
  ck_assert(camera.update({}).transform.is_identity());
}
END_TEST

START_TEST(the_same_frames_give_the_same_numbers_whatever_becomes_of_them_afterwards) {
  std::vector<CameraMotionResult> first;
  std::vector<Image<std::uint8_t>> frames(12);  // all stay where they are
  for (int run = 0; run < 2; ++run) {
    std::mt19937 random(18);
    CameraMotion camera;
    for (int k = 0; k < 6; ++k) {
      Image<std::uint8_t>& frame = frames[static_cast<std::size_t>(6 * run + k)];
      frame = picture(Scene(18), about_centre(1 + 0.01 * k, 0.01 * k, 3 * k, k));
      add_noise(frame.view(), 2, 5, random);
      const CameraMotionResult r = camera.update(frame.view());
      if (run == 1) frame.fill_bytes(99);
      if (run == 0)
        first.push_back(r);
      else
        ck_assert(r.transform.m == first[static_cast<std::size_t>(k)].transform.m &&
                  r.confidence == first[static_cast<std::size_t>(k)].confidence);
    }
  }
}
END_TEST

START_TEST(the_steady_state_allocates_nothing_and_memory_is_small) {
  std::vector<Image<std::uint8_t>> frames;
  for (int k = 0; k < 6; ++k) frames.push_back(picture(Scene(19), about_centre(1, 0.01 * k, 4 * k, k)));
  CameraMotion camera;
  camera.set_options({MotionModel::homography});
  for (const auto& frame : frames) camera.update(frame.view());
  const std::size_t before = allocations();
  for (int round = 0; round < 3; ++round)
    for (const auto& frame : frames) camera.update(frame.view());
  ck_assert_uint_eq(allocations() - before, 0);
  ck_assert_uint_lt(camera.bytes(), 3u * static_cast<unsigned>(kSize.area()));
}
END_TEST

// A large clock keeps its place before a wall on which little is seen: with its patches the camera stands.
START_TEST(a_box_that_shows_no_scene_has_no_say_in_the_motion) {
  const Box clock{40, 30, 240, 120};
  const Scene scene(6), writing(7);
  const Transform truth = Transform::translation(6, 0);
  const auto seen = [&](const Transform& motion) {
    Image<std::uint8_t> image = picture(scene, motion);
    paste(picture(writing), image.view(), static_cast<int>(clock.x), static_cast<int>(clock.y),
          static_cast<int>(clock.width), static_cast<int>(clock.height));
    for (int y = 150; y < 210; ++y) std::fill_n(image.view().row(y), kSize.width, std::uint8_t{90});
    return image;
  };
  const Image<std::uint8_t> earlier = seen({}), later = seen(truth);
  const auto motion = [&](std::span<const Box> before, std::span<const Box> now) {
    CameraMotion camera;
    camera.update(earlier.view(), {}, before);
    return camera.update(later.view(), {}, now).transform;
  };
  ck_assert_double_gt(disagreement(motion({}, {}), truth), 3);
  ck_assert_double_lt(disagreement(motion({&clock, 1}, {&clock, 1}), truth), 0.5);
  // Learnt after the patches were chosen.
  ck_assert_double_lt(disagreement(motion({}, {&clock, 1}), truth), 0.5);
}
END_TEST

int main() {
  return run_suite(
      "camera_motion",
      {a_shift_is_found_to_a_twentieth_of_a_pixel_up_to_a_quarter_of_the_width, turning_and_zooming_are_found,
       a_real_pan_is_a_homography_and_found_without_a_word_from_the_head,
       over_a_heads_turn_a_simple_model_is_as_good_as_a_homography,
       an_affine_motion_is_found_by_the_affine_model,
       translation_alone_gives_translation_alone_and_none_gives_identity,
       objects_over_nearly_half_the_picture_do_not_move_the_camera, a_pan_is_measured_behind_a_close_person,
       a_pan_that_begins_behind_a_close_person_at_rest_is_found_on_finer_levels,
       a_camera_that_pans_along_a_bare_wall_goes_on,
       a_camera_that_moved_stands_from_the_frame_on_in_which_the_model_is_none,
       a_camera_before_a_blank_wall_is_measured_again_from_the_first_wide_object,
       an_exposure_step_in_mid_pan_is_no_cut_and_costs_no_accuracy,
       the_heads_pose_finds_what_no_search_reaches_and_a_wrong_one_is_not_believed,
       a_box_that_shows_no_scene_has_no_say_in_the_motion,
       odd_sizes_work_and_nothing_outside_the_picture_is_read,
       the_same_frames_give_the_same_numbers_whatever_becomes_of_them_afterwards,
       the_steady_state_allocates_nothing_and_memory_is_small});
}
