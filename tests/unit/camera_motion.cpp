// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera motion estimate on a synthetic scene whose true motion is known exactly.
#include "vision/camera_motion.h"

#include <check.h>

#include <functional>
#include <vector>

#include "support/allocations.h"
#include "support/pictures.h"
#include "support/suite.h"
#include "vision/lens.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{320, 240};

// Motion about the middle of the picture, where cameras turn and zoom.
Transform about_centre(double scale, double angle, double dx, double dy, Size size = kSize) {
  const double cx = 0.5 * (size.width - 1), cy = 0.5 * (size.height - 1);
  return Transform::translation(cx + dx, cy + dy) * Transform::similarity(scale, angle, 0, 0) *
         Transform::translation(-cx, -cy);
}

// Largest distance between where two motions take a grid of points.
double disagreement(const Transform& a, const Transform& b, Size size = kSize) {
  double worst = 0;
  for (int y = 0; y <= 4; ++y)
    for (int x = 0; x <= 4; ++x) {
      const Point p{x * size.width / 4.0, y * size.height / 4.0}, q = a.apply(p), r = b.apply(p);
      worst = std::max(worst, std::hypot(q.x - r.x, q.y - r.y));
    }
  return worst;
}

Image<std::uint8_t> picture(const Scene& scene, const Transform& motion = {}, Size size = kSize) {
  Image<std::uint8_t> image(size);
  look(scene, motion, image.view());
  return image;
}

Image<std::uint8_t> mapped(const Image<std::uint8_t>& image,
                           const std::function<double(double, int)>& light) {
  Image<std::uint8_t> out(image.size());
  for (int y = 0; y < image.size().height; ++y)
    for (int x = 0; x < image.size().width; ++x)
      out.view().at(x, y) = to_byte(light(image.view().at(x, y), y));
  return out;
}

// A picture of this level, with hardly any noise.
Image<std::uint8_t> flat(int level, std::mt19937& random, Size size = kSize) {
  Image<std::uint8_t> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.view().at(x, y) = to_byte(level + static_cast<int>(random() % 3) - 1);
  return image;
}

void paste(const Image<std::uint8_t>& from, MutableGrayView onto, int left, int top, int width, int height) {
  for (int y = top; y < top + height; ++y)
    for (int x = std::max(left, 0); x < std::min(left + width, onto.width); ++x)
      onto.at(x, y) = from.view().at(x - left, y - top);
}

// The motion found between two looks at a scene.
CameraMotionResult between(const Scene& scene, const Transform& motion,
                           MotionModel model = MotionModel::similarity, double noise = 2,
                           const std::optional<Transform>& prior = std::nullopt, Size size = kSize) {
  std::mt19937 random(1);
  CameraMotion camera;
  camera.set_options({model});
  Image<std::uint8_t> earlier = picture(scene, {}, size), later = picture(scene, motion, size);
  add_noise(earlier.view(), noise, noise, random);
  add_noise(later.view(), noise, noise, random);
  camera.update(earlier.view());
  return camera.update(later.view(), prior);
}

}  // namespace

START_TEST(the_first_frame_starts_a_scene) {
  CameraMotion camera;
  const CameraMotionResult r = camera.update(picture(Scene(1)).view());
  ck_assert_int_eq(r.scene_age, 1);
  ck_assert(r.transform.is_identity());
  ck_assert(!r.still);
  ck_assert_int_eq(camera.update(picture(Scene(1)).view()).scene_age, 2);
}
END_TEST

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

START_TEST(a_real_pan_is_a_homography_and_found_as_one) {
  // 1.5 degrees of pan and half a degree of roll through a 60 degree lens: K R K^-1.
  const double f = 0.5 * kSize.width / std::tan(30 * M_PI / 180), a = 1.5 * M_PI / 180;
  const double cx = 0.5 * (kSize.width - 1), cy = 0.5 * (kSize.height - 1);
  const Transform k{{f, 0, cx, 0, f, cy, 0, 0, 1}};
  const Transform pan{{std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a)}};
  const Transform truth = k * pan * Transform::similarity(1, 0.5 * M_PI / 180, 0, 0) * k.inverse();
  const CameraMotionResult homography = between(Scene(4), truth, MotionModel::homography);
  ck_assert_msg(disagreement(homography.transform, truth) < 0.25, "off by %g",
                disagreement(homography.transform, truth));
  // The simpler models do what they can: the middle of the picture is right.
  for (const MotionModel model : {MotionModel::translation, MotionModel::similarity, MotionModel::affine}) {
    const CameraMotionResult r = between(Scene(4), truth, model);
    const Point p = truth.apply({cx, cy}), q = r.transform.apply({cx, cy});
    ck_assert_double_lt(std::hypot(p.x - q.x, p.y - q.y), 1.0);
    ck_assert_double_gt(disagreement(r.transform, truth), 0.25);
  }
}
END_TEST

// A similarity is off by up to 8 pixels at the corners; over the turn that the head told it need not be.
START_TEST(over_a_heads_turn_a_simple_model_is_as_good_as_a_homography) {
  const Lens lens(60 * M_PI / 180, kSize);
  const double pan = 3 * M_PI / 180, tilt = -0.5 * M_PI / 180;
  const Transform truth = lens.turn(0, 0, pan, tilt);
  const auto off = [&](const std::optional<Transform>& prior) {
    return disagreement(between(Scene(4), truth, MotionModel::similarity, 2, prior).transform, truth);
  };
  ck_assert_double_gt(off(std::nullopt), 5);
  ck_assert_double_lt(off(truth), 0.3);
  ck_assert_double_lt(off(lens.turn(0, 0, 0.85 * pan, 0)), 2.0);  // a head that is a little late
  ck_assert_double_lt(off(lens.turn(0, 0, -pan, 0)), off(std::nullopt) + 0.3);
  // A picture that shifts though the head turned (virtualptz: a window over a flat picture) is found as it is.
  const Transform shift = Transform::translation(-14.5, 2);
  ck_assert_double_lt(
      disagreement(between(Scene(4), shift, MotionModel::similarity, 2, truth).transform, shift), 0.2);
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
  ck_assert_double_lt(r.confidence, 0.75);  // it says how much disagrees
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
    // The head knows better, if it says so.
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

START_TEST(the_same_frames_give_the_same_numbers) {
  std::vector<CameraMotionResult> first;
  for (int run = 0; run < 2; ++run) {
    std::mt19937 random(18);
    CameraMotion camera;
    for (int k = 0; k < 6; ++k) {
      Image<std::uint8_t> frame = picture(Scene(18), about_centre(1 + 0.01 * k, 0.01 * k, 3 * k, k));
      add_noise(frame.view(), 2, 5, random);
      const CameraMotionResult r = camera.update(frame.view());
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
  ck_assert_uint_lt(camera.bytes(), 5u * static_cast<unsigned>(kSize.area()));
}
END_TEST

int main() {
  return run_suite("camera_motion",
                   {the_first_frame_starts_a_scene,
                    a_shift_is_found_to_a_twentieth_of_a_pixel_up_to_a_quarter_of_the_width,
                    turning_and_zooming_are_found,
                    a_real_pan_is_a_homography_and_found_as_one,
                    over_a_heads_turn_a_simple_model_is_as_good_as_a_homography,
                    an_affine_motion_is_found_by_the_affine_model,
                    translation_alone_gives_translation_alone_and_none_gives_identity,
                    objects_over_nearly_half_the_picture_do_not_move_the_camera,
                    a_person_walking_past_a_standing_camera_leaves_it_still,
                    a_person_before_a_blank_wall_is_not_the_camera,
                    a_standing_camera_is_exactly_still_under_noise_flicker_and_exposure,
                    vibration_of_three_tenths_of_a_pixel_is_not_snapped_away,
                    a_drift_too_slow_to_see_between_two_frames_adds_up,
                    an_exposure_step_in_mid_pan_is_no_cut_and_costs_no_accuracy,
                    a_cut_starts_a_scene_and_the_next_frame_continues_it,
                    a_cut_to_black_and_back_is_found,
                    a_featureless_picture_stands_still_without_confidence,
                    the_heads_pose_finds_what_no_search_reaches_and_a_wrong_one_is_not_believed,
                    a_new_picture_size_and_a_reset_start_a_scene,
                    odd_sizes_work_and_nothing_outside_the_picture_is_read,
                    the_same_frames_give_the_same_numbers,
                    the_steady_state_allocates_nothing_and_memory_is_small});
}
