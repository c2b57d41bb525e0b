// SPDX-License-Identifier: LGPL-2.1-or-later
// The foreground mask: Eq. 3 and the set algebra by hand, and the background model in its typical situations.
#include "vision/background/foreground_mask.h"

#include <check.h>

#include <random>
#include <vector>

#include "support/allocations.h"
#include "support/area.h"
#include "support/motions.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr double kContrast = 12;  // grey levels: about what walls, streets and lawns have at this size

// Levels from dark to bright with some structure, so that noise is of every strength.
double static_scene(int x, int y, Size size) {
  double v = 20 + 200.0 * x / size.width;
  if ((x / 20 + y / 20) & 1) v += 15;
  if (y > size.height * 3 / 4) v = 40;
  if (x > size.width / 3 && x < size.width / 2 && y > size.height / 3 && y < size.height / 2) v = 235;
  return v;
}

struct Light {
  double flicker = 0, bands = 0;  // amplitudes
  bool steps = false;
};

// Frames with a mask, over `frames` of a static scene with noise of sigma 2 (dark) to 6 (bright).
int frames_with_motion(Size size, int frames, const Light& light, unsigned seed) {
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(seed);
  std::vector<float> noise(1 << 16);
  std::normal_distribution<float> normal;
  for (auto& n : noise) n = normal(random);
  int bad = 0, since_step = 1000;
  double exposure = 1;
  for (int k = 0; k < frames; ++k) {
    ++since_step;
    if (light.steps && k % 100 == 60) exposure = exposure == 1 ? 0.75 : 1, since_step = 0;
    const double phase = 2 * M_PI * 100 * k / 30.0 * 1.001;
    const std::size_t start = random();
    for (int y = 0; y < size.height; ++y) {
      const double gain = exposure * (1 + light.flicker * std::sin(phase)) *
                          (1 + light.bands * std::sin(phase + 2 * M_PI * 2.7 * y / size.height));
      std::size_t at = start + static_cast<std::size_t>(random());
      for (int x = 0; x < size.width; ++x) {
        const double v = static_scene(x, y, size) * gain;
        picture.view().at(x, y) = to_byte(v + (2 + 4 * v / 255) * noise[(at++ * 40503u) & 0xffff]);
      }
    }
    const auto result = chain.feed(picture.view());
    ck_assert(result.ready == (k >= 2));
    bad += chain.moving() > 0 && since_step >= 3;
  }
  return bad;
}

Histogram histogram_of(GrayView d) {
  Histogram h{};
  for (int y = 0; y < d.height; ++y)
    for (int x = 0; x < d.width; ++x) ++h[d.at(x, y)];
  return h;
}

}  // namespace

START_TEST(the_paper_s_sets_are_formed_from_one_threshold) {
  // The linear threshold of these counts is 4 (computed by hand), so 5 and more moves (Eq. 3).
  const int counts[] = {30, 60, 5, 4, 1, 5, 20, 12};
  Image<std::uint8_t> now({137, 1}), before({137, 1}), mask({137, 1}), picture({137, 1});
  for (int v = 0, x = 0; v < 8; ++v)
    for (int i = 0; i < counts[v]; ++i) now.view().at(x++, 0) = static_cast<std::uint8_t>(v);
  for (int x = 0; x < 137; ++x) before.view().at(x, 0) = x % 2 ? 5 : 4;
  const Histogram h = histogram_of(now.view());
  ForegroundMaskOptions o;
  o.threshold = {Weighting::linear, Extremes::subset, 1, 0.3964, false};
  o.noise_floor = o.background_model = false;
  ForegroundMaskInput in;
  in.picture = picture.view();
  in.current = now.view();
  in.previous = before.view();
  in.histogram = &h;
  in.frames = 3;
  for (const Area area : {Area::all, Area::common, Area::leading}) {
    o.area = area;
    ForegroundMask stage;
    stage.set_options(o);
    const auto result = stage.update(in, mask.view());
    ck_assert_int_eq(result.threshold, 4);
    ck_assert_int_eq(result.fuzzy_threshold, 4);
    ck_assert(result.ready);
    for (int x = 0; x < 137; ++x) {
      const bool d = now.view().at(x, 0) > 4, p = x % 2;
      const bool expected = area == Area::all ? d : area == Area::common ? d && p : d && !(d && p);
      ck_assert_int_eq(mask.view().at(x, 0), expected ? 255 : 0);
    }
  }
  in.frames = 2;  // two frames make no motion
  const auto says_nothing = [&] {
    ForegroundMask stage;
    stage.set_options(o);
    ck_assert(!stage.update(in, mask.view()).ready);
    for (int x = 0; x < 137; ++x) ck_assert_int_eq(mask.view().at(x, 0), 0);
  };
  says_nothing();
  in.frames = 3;
  in.previous = {};  // nor do sets of differences while one is missing
  for (const Area area : {Area::common, Area::leading}) {
    o.area = area;
    says_nothing();
  }
  o.area = Area::all;
  ForegroundMask stage;
  stage.set_options(o);
  ck_assert(stage.update(in, mask.view()).ready);
  for (int x = 0; x < 137; ++x) ck_assert_int_eq(mask.view().at(x, 0), now.view().at(x, 0) > 4 ? 255 : 0);
}
END_TEST

START_TEST(noise_that_grows_with_brightness_is_no_motion_in_1000_frames) {
  ck_assert_int_eq(frames_with_motion({160, 120}, 1000, {}, 1), 0);
}
END_TEST

START_TEST(flicker_of_the_mains_is_no_motion_in_1000_frames) {
  ck_assert_int_eq(frames_with_motion({160, 120}, 1000, {0.05, 0, false}, 2), 0);
}
END_TEST

START_TEST(bands_of_a_rolling_shutter_are_no_motion_in_1000_frames) {
  ck_assert_int_eq(frames_with_motion({160, 240}, 1000, {0, 0.05, false}, 3), 0);
}
END_TEST

START_TEST(exposure_steps_cost_three_frames_at_most) {
  ck_assert_int_eq(frames_with_motion({160, 120}, 1000, {0, 0, true}, 4), 0);
}
END_TEST

START_TEST(a_square_before_a_still_camera_is_found) {
  const Size size{160, 120};
  const Scene scene(21, kContrast), texture(22, kContrast);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(5);
  Score score;
  for (int k = 0; k < 50; ++k) {
    look(scene, {}, picture.view());
    const Square square{10 + 2.0 * k, 40, 28};
    draw(picture.view(), square, texture);
    add_noise(picture.view(), 1, 3, random);
    chain.feed(picture.view());
    if (k >= 20) score.add(chain.mask.view(), square);
  }
  ck_assert_double_gt(score.f(), 0.9);
}
END_TEST

START_TEST(a_square_before_a_panning_camera_is_found) {
  const Size size{160, 120};
  const Scene scene(31, kContrast), texture(32, kContrast);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(6);
  Score score;
  for (int k = 0; k < 60; ++k) {
    // The world runs to the left, the square stays in the picture; the motion handed in is off by 0.15 pixels.
    look(scene, Transform::translation(-1.7 * k, 0.4 * k), picture.view());
    const Square square{60, 45, 28};
    draw(picture.view(), square, texture);
    add_noise(picture.view(), 1, 3, random);
    const double slip = k % 2 ? 0.15 : -0.15;
    chain.feed(picture.view(), k ? Transform::translation(-1.7 + slip, 0.4 - slip) : Transform{}, false);
    if (k >= 25) score.add(chain.mask.view(), square);
  }
  ck_assert_double_gt(score.f(), 0.9);
}
END_TEST

START_TEST(an_object_that_is_there_from_the_first_frame_is_found_from_the_third) {
  const Size size{160, 120};
  const Scene scene(41), texture(42, kContrast);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  for (int k = 0; k < 3; ++k) {
    look(scene, {}, picture.view());
    draw(picture.view(), {40 + 6.0 * k, 40, 28}, texture);
    ck_assert(chain.feed(picture.view()).ready == (k == 2));
    if (k < 2) ck_assert_int_eq(chain.moving(), 0);
  }
  Score score;
  score.add(chain.mask.view(), {46, 40, 40});  // where the square was and is
  ck_assert_double_gt(score.hit, 28 * 28 * 0.5);
  ck_assert_double_lt(score.wrong, 300);
}
END_TEST

START_TEST(an_object_that_leaves_its_place_leaves_no_ghost) {
  const Size size{160, 120};
  const Scene scene(51, kContrast), texture(52, kContrast);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(7);
  for (int k = 0; k < 60; ++k) {  // stands for 30 frames, then walks out; the scene is empty afterwards
    look(scene, {}, picture.view());
    const double x = k < 30 ? 60 : 60 + 8.0 * (k - 30);
    draw(picture.view(), {x, 40, 28}, texture);
    add_noise(picture.view(), 1, 3, random);
    chain.feed(picture.view());
  }
  ck_assert_int_eq(chain.moving(), 0);
}
END_TEST

START_TEST(an_object_that_stops_stays_in_the_mask_of_a_standing_camera) {
  const Size size{160, 120};
  const Scene scene(61, kContrast), texture(62, kContrast);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(8);
  Score score;
  for (int k = 0; k < 150; ++k) {
    look(scene, {}, picture.view());
    const Square square{std::min(-20 + 3.0 * (k - 15), 70.0), 40, 28};
    if (k >= 15) draw(picture.view(), square, texture);
    add_noise(picture.view(), 1, 3, random);
    chain.feed(picture.view());
    if (k >= 100) score.add(chain.mask.view(), square);
  }
  ck_assert_double_gt(score.f(), 0.9);
}
END_TEST

// Whatever the frame rate: seconds after it has stopped, and no more after 15 s.
START_TEST(an_object_that_stopped_stays_for_ten_seconds_at_any_frame_rate) {
  const Size size{96, 64};
  const Scene scene(61, kContrast), texture(62, kContrast);
  for (const int rate : {5, 25, 100}) {
    AreaChain chain(size);
    Image<std::uint8_t> picture(size);
    std::mt19937 random(8);
    const auto watch = [&](double from, double to) {  // seconds; returns the pixels of the last mask
      for (int k = static_cast<int>(from * rate); k < static_cast<int>(to * rate); ++k) {
        look(scene, {}, picture.view());
        if (k >= 3 * rate)
          draw(picture.view(), {std::min(-20 + 60.0 * (static_cast<double>(k) / rate - 3), 40.0), 20, 24},
               texture);
        add_noise(picture.view(), 1, 3, random);
        chain.feed(picture.view(), {}, true, 1.0 / rate);
      }
      return chain.moving();
    };
    ck_assert_int_eq(watch(0, 3), 0);
    const long there = watch(3, 11);
    ck_assert_msg(there > 24 * 24 * 4 / 5, "%d a second: %ld", rate, there);
    ck_assert_int_eq(watch(11, 19), 0);
  }
}
END_TEST

START_TEST(a_reset_drops_the_old_scene) {
  const Size size{160, 120};
  const Scene first(71), second(72);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  std::mt19937 random(9);
  for (int k = 0; k < 40; ++k) {
    look(first, {}, picture.view());
    add_noise(picture.view(), 1, 3, random);
    chain.feed(picture.view());
  }
  chain.reset();
  for (int k = 0; k < 30; ++k) {
    look(second, {}, picture.view());
    add_noise(picture.view(), 1, 3, random);
    ck_assert(chain.feed(picture.view()).ready == (k >= 2));
    ck_assert_int_eq(chain.moving(), 0);
  }
}
END_TEST

START_TEST(the_model_recovers_from_an_unannounced_change_of_scene) {
  const Size size{160, 120};
  const Scene first(81), second(82);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  for (int k = 0; k < 60; ++k) {
    look(k < 40 ? first : second, {}, picture.view());
    chain.feed(picture.view());
    if (k > 45) ck_assert_int_eq(chain.moving(), 0);
  }
}
END_TEST

START_TEST(long_rotation_and_zoom_stay_registered) {
  const Size size{160, 120};
  const Scene scene(91);
  AreaChain chain(size);
  Image<std::uint8_t> picture(size);
  const Transform centre = Transform::translation(79.5, 59.5);
  const Transform step = centre * similarity(1.004, 0.006, 0.3, 0.1) * centre.inverse();
  Transform pose;
  long wrong = 0;
  for (int k = 0; k < 80; ++k) {
    look(scene, pose, picture.view());
    chain.feed(picture.view(), k ? step : Transform{}, false);
    wrong += chain.moving();
    pose = step * pose;
  }
  ck_assert_int_lt(wrong, 80 * 160 * 120 / 500);  // a fifth of a percent
}
END_TEST

START_TEST(impossible_motion_and_odd_sizes_do_no_harm) {
  for (const Size size : {Size{33, 35}, Size{65, 32}, Size{16, 16}, Size{320, 17}}) {
    AreaChain chain(size);
    Image<std::uint8_t> picture(size);
    std::mt19937 random(10);
    for (int k = 0; k < 12; ++k) {
      fill_random(picture.view(), random);
      const Transform wild = k % 3 == 0   ? Transform{{0, 0, 0, 0, 0, 0, 0, 0, 1}}
                             : k % 3 == 1 ? Transform::translation(1e6, -1e6)
                                          : similarity(1.5, 2, 3, 4);
      chain.feed(picture.view(), wild, false);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          ck_assert(chain.mask.view().at(x, y) == 0 || chain.mask.view().at(x, y) == 255);
    }
  }
}
END_TEST

START_TEST(steady_state_allocates_nothing_and_stays_small) {
  const Size size{320, 240};
  const Scene scene(101), texture(102, kContrast);
  AreaChain chain(size);
  std::vector<Image<std::uint8_t>> pictures;
  for (int k = 0; k < 24; ++k) {
    pictures.emplace_back(size);
    look(scene, Transform::translation(-1.3 * k, 0.2 * k), pictures.back().view());
    draw(pictures.back().view(), {40.0 + 4 * k, 80, 40}, texture);
  }
  std::size_t before = 0;
  for (int k = 0; k < 24; ++k) {
    if (k == 16) before = allocations();
    chain.feed(pictures[static_cast<std::size_t>(k)].view(),
               k ? Transform::translation(-1.3, 0.2) : Transform{}, false);
  }
  ck_assert_uint_eq(allocations(), before);
  const double bytes = static_cast<double>(chain.difference.bytes() + chain.area.bytes()) / size.area();
  ck_assert_double_lt(bytes, 15);
}
END_TEST

int main() {
  return run_suite(
      "moving_area",
      {the_paper_s_sets_are_formed_from_one_threshold,
       noise_that_grows_with_brightness_is_no_motion_in_1000_frames,
       flicker_of_the_mains_is_no_motion_in_1000_frames,
       bands_of_a_rolling_shutter_are_no_motion_in_1000_frames, exposure_steps_cost_three_frames_at_most,
       a_square_before_a_still_camera_is_found, a_square_before_a_panning_camera_is_found,
       an_object_that_is_there_from_the_first_frame_is_found_from_the_third,
       an_object_that_leaves_its_place_leaves_no_ghost,
       an_object_that_stops_stays_in_the_mask_of_a_standing_camera,
       an_object_that_stopped_stays_for_ten_seconds_at_any_frame_rate, a_reset_drops_the_old_scene,
       the_model_recovers_from_an_unannounced_change_of_scene, long_rotation_and_zoom_stay_registered,
       impossible_motion_and_odd_sizes_do_no_harm, steady_state_allocates_nothing_and_stays_small},
      100);
}
