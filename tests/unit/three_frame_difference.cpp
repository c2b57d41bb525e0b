// SPDX-License-Identifier: LGPL-2.1-or-later
// Differences of three registered frames (Eq. 1, 2) against hand-computed pictures, and the light that is taken out.
#include "vision/change/three_frame_difference.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "support/allocations.h"
#include "support/pictures.h"
#include "support/suite.h"
#include "vision/change/difference_kernels.h"
#include "vision/change/light.h"
#include "vision/image/blur.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

struct Run {
  explicit Run(Size size, DifferenceOptions options = {}) : current(size), previous(size), tolerant(size) {
    stage.set_options(options);
  }
  DifferenceResult feed(const Image<std::uint8_t>& picture, const Transform& motion = {}) {
    return stage.update(picture.view(), motion, current.view(), previous.view(), tolerant.view(), histogram);
  }
  ThreeFrameDifference stage;
  Image<std::uint8_t> current, previous, tolerant;
  Histogram histogram{};
};

Image<std::uint8_t> flat(Size size, int value) {
  Image<std::uint8_t> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.view().at(x, y) = static_cast<std::uint8_t>(value);
  return image;
}

Image<std::uint8_t> with_pixel(Size size, int x, int y, int value) {
  auto image = flat(size, 100);
  image.view().at(x, y) = static_cast<std::uint8_t>(value);
  return image;
}

DifferenceOptions plain() {
  DifferenceOptions o;
  o.blur = 1;
  o.compensate_light = false;
  return o;
}

Image<std::uint8_t> seen(const Scene& scene, Size size, double dx, double dy) {
  Image<std::uint8_t> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.view().at(x, y) =
          static_cast<std::uint8_t>(std::clamp(std::lround(scene.at(x - dx, y - dy)), 0L, 255L));
  return image;
}

}  // namespace

START_TEST(differences_of_a_still_camera_are_those_of_equation_2) {
  Run run({9, 7}, plain());
  ck_assert_int_eq(run.feed(with_pixel({9, 7}, 2, 3, 180)).frames, 1);
  ck_assert_uint_eq(std::accumulate(run.histogram.begin(), run.histogram.end(), 0u), 0);
  ck_assert_int_eq(run.feed(with_pixel({9, 7}, 3, 3, 190)).frames, 2);
  ck_assert_int_eq(run.current.view().at(2, 3), 80);  // |100 - 180|
  ck_assert_int_eq(run.current.view().at(3, 3), 90);
  ck_assert_int_eq(run.previous.view().at(2, 3), 0);  // no frame k-2 yet
  const auto result = run.feed(with_pixel({9, 7}, 4, 3, 60));
  ck_assert_int_eq(result.frames, 3);
  ck_assert_uint_eq(result.valid, 63);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x) {
      const int now = y == 3 && x == 3 ? 90 : y == 3 && x == 4 ? 40 : 0;     // |F(k) - F(k-1)|
      const int before = y == 3 && x == 2 ? 80 : y == 3 && x == 3 ? 90 : 0;  // |F(k-1) - F(k-2)|
      ck_assert_int_eq(run.current.view().at(x, y), now);
      ck_assert_int_eq(run.previous.view().at(x, y), before);
    }
  ck_assert_uint_eq(run.histogram[0], 61);
  ck_assert_uint_eq(run.histogram[40], 1);
  ck_assert_uint_eq(run.histogram[90], 1);
}
END_TEST

START_TEST(both_differences_are_in_the_coordinates_of_the_last_frame) {
  // The world moves 2 right and 1 down a frame; a pixel of the world that lights up in one frame only.
  const Size size{20, 16};
  const Transform motion = Transform::translation(2, 1);
  Run run(size, plain());
  run.feed(with_pixel(size, 5, 5, 200));          // world point A, seen in k-2 only
  run.feed(with_pixel(size, 9, 8, 150), motion);  // world point B, in k-1 only
  run.feed(flat(size, 100), motion);
  ck_assert_int_eq(run.previous.view().at(9, 7), 100);  // A is at 5 + 2 * 2, 5 + 2 * 1 in frame k
  ck_assert_int_eq(run.previous.view().at(11, 9), 50);  // B at 9 + 2, 8 + 1
  ck_assert_int_eq(run.current.view().at(11, 9), 50);
  ck_assert_int_eq(run.current.view().at(9, 7), 0);
}
END_TEST

START_TEST(what_not_all_three_frames_saw_is_no_motion) {
  const Size size{20, 16};
  Run run(size, plain());
  std::mt19937 random(3);
  DifferenceResult result;
  for (int k = 0; k < 3; ++k) {
    auto noise = flat(size, 0);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 20; ++x) noise.view().at(x, y) = static_cast<std::uint8_t>(random() % 2 ? 255 : 0);
    result = run.feed(noise, k ? Transform::translation(3, 0) : Transform{});
  }
  ck_assert_uint_eq(result.valid, 14 * 16);  // two moves of 3 columns
  ck_assert_uint_eq(std::accumulate(run.histogram.begin(), run.histogram.end(), 0u), 14 * 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 6; ++x) {
      ck_assert_int_eq(run.current.view().at(x, y), 0);
      ck_assert_int_eq(run.previous.view().at(x, y), 0);
    }
}
END_TEST

START_TEST(a_moving_camera_over_a_still_scene_shows_little) {
  const Size size{96, 72};
  const Scene scene(4);
  Run run(size);
  for (int k = 0; k < 4; ++k)
    run.feed(seen(scene, size, 1.3 * k, -0.6 * k), k ? Transform::translation(1.3, -0.6) : Transform{});
  std::uint32_t total = 0, small = 0;
  for (int v = 0; v < 256; ++v) {
    total += run.histogram[v];
    if (v <= 4) small += run.histogram[v];
  }
  ck_assert(total > 80u * 60u);
  ck_assert(small > total * 99 / 100);
}
END_TEST

START_TEST(exposure_is_taken_out_and_reported) {
  const Size size{96, 72};
  const Scene scene(8);
  const auto bright = seen(scene, size, 0, 0);
  auto dark = flat(size, 0);
  for (int y = 0; y < 72; ++y)
    for (int x = 0; x < 96; ++x)
      dark.view().at(x, y) = static_cast<std::uint8_t>(std::lround(0.8 * bright.view().at(x, y)));
  Run run(size);
  run.feed(bright);
  run.feed(bright);
  const auto result = run.feed(dark);
  const double at_128 = result.gain * 128 + result.offset;
  ck_assert_double_eq_tol(at_128, 0.8 * 128, 1.0);
  std::uint32_t large = 0;
  for (int v = 5; v < 256; ++v) large += run.histogram[v];
  ck_assert_uint_lt(large, 96 * 72 / 100);
  Run without(size, plain());
  without.feed(bright);
  without.feed(bright);
  without.feed(dark);
  large = 0;
  for (int v = 10; v < 256; ++v) large += without.histogram[v];
  ck_assert(large > 96u * 72u / 2);  // the test sees the step where nothing takes it out
}
END_TEST

START_TEST(bands_of_a_rolling_shutter_are_taken_out_and_an_object_is_not) {
  const Size size{160, 128};
  const Scene scene(9, 20);
  const auto before = seen(scene, size, 0, 0);
  auto after = seen(scene, size, 0, 0);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 160; ++x) {
      const double gain = 1 + 0.08 * std::sin(2 * M_PI * y / 80.0);
      double v = gain * after.view().at(x, y);
      if (x >= 40 && x < 70 && y >= 30 && y < 90) v = 230;
      after.view().at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(v), 0L, 255L));
    }
  Run run(size);
  run.feed(before);
  run.feed(before);
  run.feed(after);
  int missed = 0, wrong = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 160; ++x) {
      const int d = run.current.view().at(x, y);
      if (x > 40 && x < 69 && y > 30 && y < 89) missed += d < 30;
      if (x < 38 || x > 72 || y < 28 || y > 92) wrong += d > 6;
    }
  ck_assert_int_eq(missed, 0);
  ck_assert_int_lt(wrong, 20);
}
END_TEST

START_TEST(reset_and_a_new_size_begin_again) {
  Run run({32, 32});
  run.feed(flat({32, 32}, 50));
  run.feed(flat({32, 32}, 90));
  run.stage.reset();
  ck_assert_int_eq(run.feed(flat({32, 32}, 200)).frames, 1);
  ck_assert_int_eq(run.feed(flat({32, 32}, 200)).frames, 2);
  run.current.resize({33, 35});
  run.previous.resize({33, 35});
  ck_assert_int_eq(run.feed(flat({33, 35}, 10)).frames, 1);
}
END_TEST

START_TEST(a_motion_that_cannot_be_begins_again) {
  Run run({32, 32});
  run.feed(flat({32, 32}, 50));
  run.feed(flat({32, 32}, 90));
  ck_assert_int_eq(run.feed(flat({32, 32}, 90), Transform{{0, 0, 0, 0, 0, 0, 0, 0, 1}}).frames, 1);
}
END_TEST

START_TEST(the_blur_is_the_rounded_mean_of_nine) {
  std::mt19937 random(6);
  for (const Size size :
       {Size{1, 1}, Size{2, 1}, Size{1, 5}, Size{33, 35}, Size{512, 3}, Size{513, 2}, Size{1100, 3}}) {
    Image<std::uint8_t> in(size), fast(size), slow(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        in.view().at(x, y) = static_cast<std::uint8_t>(random() % 4 ? random() : 255);
    blur3(in.view(), 3, fast.view());
    blur3_reference(in.view(), slow.view());
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) ck_assert_int_eq(fast.view().at(x, y), slow.view().at(x, y));
  }
}
END_TEST

START_TEST(what_a_displacement_of_a_pixel_explains_is_left_out_of_the_tolerant_difference) {
  // The camera is said to stand and moves by a pixel, to and fro: a scene of steep edges, a plain square that goes 6 pixels.
  const Size size{64, 48};
  Run run(size, plain());
  const auto picture = [&](int k) {
    Image<std::uint8_t> image(size);
    const int shift = k % 2, left = 8 + 6 * k;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool square = x >= left && x < left + 12 && y >= 16 && y < 28;
        image.view().at(x, y) = static_cast<std::uint8_t>(square ? 250 : (x + shift) / 8 % 2 ? 160 : 40);
      }
    return image;
  };
  run.feed(picture(0)), run.feed(picture(1)), run.feed(picture(2));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const bool edge = run.current.view().at(x, y) == 120;  // of the scene
      if (edge) ck_assert_int_eq(run.tolerant.view().at(x, y), 0);
    }
  // The square covers 20 to 31 now and covered 14 to 25 before.
  for (int y = 18; y < 26; ++y) {
    for (int x = 27; x < 32; ++x) ck_assert_int_ge(run.tolerant.view().at(x, y), 250 - 160);
    for (int x = 15; x < 19; ++x) ck_assert_int_ge(run.tolerant.view().at(x, y), 250 - 160);
  }
}
END_TEST

START_TEST(the_tolerant_difference_is_that_to_nine_pixels) {
  // Sizes beside those of vectors, with light, noise and motion: the two differences are each other's control. Nine equal
  // pixels of F(k-1) leave nothing to tolerate.
  const Scene scene(4);
  for (const int width : {33, 64, 97}) {
    const Size size{width, 41};
    Run run(size);
    std::mt19937 random(8);
    for (int k = 0; k < 6; ++k) {
      Image<std::uint8_t> frame = seen(scene, size, 1.3 * k, 0);
      add_noise(frame.view(), 2, 2, random);
      run.feed(frame, k ? Transform::translation(1.3, 0) : Transform{});
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          ck_assert_int_le(run.tolerant.view().at(x, y), run.current.view().at(x, y));
    }
  }
  const Size size{33, 21};
  Run run(size, plain());
  run.feed(flat(size, 100)), run.feed(flat(size, 100));
  run.feed(with_pixel(size, 0, 0, 130)), run.feed(with_pixel(size, 32, 20, 90));
  ck_assert_int_eq(run.tolerant.view().at(0, 0), 0);  // 100 is beside the 130 that was here
  ck_assert_int_eq(run.current.view().at(0, 0), 30);
  ck_assert_int_eq(run.tolerant.view().at(32, 20), 10);
  ck_assert_int_eq(run.current.view().at(32, 20), 10);
}
END_TEST

START_TEST(levels_are_counted_as_one_by_one) {
  std::mt19937 random(5);
  for (const int width : {1, 7, 15, 16, 63, 64, 65, 320, 1001}) {
    LevelCounter counter;
    Histogram expected{}, got{};
    std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
    for (int y = 0; y < 300; ++y) {  // more vectors than a byte counts
      for (auto& v : row)
        v = static_cast<std::uint8_t>(y % 3 ? random() % 10 : y % 2 ? 0 : random() % 256), ++expected[v];
      counter.add(row.data(), width);
    }
    counter.store(got);
    for (std::size_t v = 0; v < 256; ++v) ck_assert_uint_eq(got[v], expected[v]);
  }
}
END_TEST

START_TEST(steady_state_allocates_nothing) {
  const Size size{96, 72};
  const Scene scene(4);
  Run run(size);
  std::vector<Image<std::uint8_t>> frames;
  for (int k = 0; k < 8; ++k) frames.push_back(seen(scene, size, 1.3 * k, 0.2 * k));
  for (int k = 0; k < 4; ++k) run.feed(frames[k], Transform::translation(1.3, 0.2));
  const auto before = allocations();
  for (int k = 4; k < 8; ++k) run.feed(frames[k], Transform::translation(1.3, 0.2));
  ck_assert_uint_eq(allocations(), before);
}
END_TEST

// Whether D(k-1) is made or not, D(k) and all results for it are the same.
START_TEST(without_the_difference_before_a_picture_less_is_held_and_all_else_is_the_same) {
  const Size size{96, 72};
  const Scene scene(4);
  for (const bool compensate : {true, false})
    for (const double pan : {0.0, 1.3, 2.0}) {
      DifferenceOptions options;
      options.compensate_light = compensate;
      Run both(size, options), one(size, options);
      std::mt19937 random(8);
      for (int k = 0; k < 12; ++k) {
        Image<std::uint8_t> frame = seen(scene, size, pan * k, 0);
        for (int y = 0; y < size.height; ++y)
          for (int x = 0; x < size.width; ++x)
            frame.view().at(x, y) = static_cast<std::uint8_t>(frame.view().at(x, y) * (k < 6 ? 4 : 3) / 4);
        add_noise(frame.view(), 2, 2, random);
        const Transform motion = k ? Transform::translation(pan, 0) : Transform{};
        const auto expected = both.feed(frame, motion);
        const auto result = one.stage.update(frame.view(), motion, one.current.view(), {}, {}, one.histogram);
        ck_assert_int_eq(result.frames, expected.frames);
        ck_assert_uint_eq(result.valid, expected.valid);
        ck_assert_double_eq(result.gain, expected.gain);
        ck_assert_double_eq(result.offset, expected.offset);
        ck_assert(one.histogram == both.histogram);
        ck_assert(expected.previous == (k >= 2));
        ck_assert(!result.previous);
        for (int y = 0; y < size.height; ++y)
          for (int x = 0; x < size.width; ++x)
            ck_assert_int_eq(one.current.view().at(x, y), both.current.view().at(x, y));
      }
      ck_assert_uint_le(one.stage.bytes() + static_cast<std::size_t>(size.area()), both.stage.bytes());
    }
}
END_TEST

START_TEST(the_difference_before_is_known_from_the_second_frame_on_in_which_it_is_wanted) {
  const Size size{96, 72};
  const Scene scene(4);
  for (const double pan : {0.0, 1.3}) {
    Run always(size), late(size);
    std::mt19937 random(8);
    for (int k = 0; k < 16; ++k) {
      Image<std::uint8_t> frame = seen(scene, size, pan * k, 0);
      add_noise(frame.view(), 2, 2, random);
      const Transform motion = k ? Transform::translation(pan, 0) : Transform{};
      const bool wanted = (k >= 5 && k < 9) || k >= 12;
      always.feed(frame, motion);
      const auto result =
          late.stage.update(frame.view(), motion, late.current.view(),
                            wanted ? late.previous.view() : MutableGrayView{}, {}, late.histogram);
      ck_assert_int_eq(result.frames, std::min(k + 1, 3));
      ck_assert(result.previous == (wanted && k != 5 && k != 12));
      for (int y = 0; y < size.height && wanted; ++y)
        for (int x = 0; x < size.width; ++x)
          ck_assert_int_eq(late.previous.view().at(x, y),
                           result.previous ? always.previous.view().at(x, y) : 0);
    }
  }
}
END_TEST

int main() {
  return run_suite(
      "three_frame_difference",
      {differences_of_a_still_camera_are_those_of_equation_2,
       both_differences_are_in_the_coordinates_of_the_last_frame, what_not_all_three_frames_saw_is_no_motion,
       a_moving_camera_over_a_still_scene_shows_little, exposure_is_taken_out_and_reported,
       bands_of_a_rolling_shutter_are_taken_out_and_an_object_is_not, reset_and_a_new_size_begin_again,
       a_motion_that_cannot_be_begins_again, the_blur_is_the_rounded_mean_of_nine,
       what_a_displacement_of_a_pixel_explains_is_left_out_of_the_tolerant_difference,
       the_tolerant_difference_is_that_to_nine_pixels, levels_are_counted_as_one_by_one,
       without_the_difference_before_a_picture_less_is_held_and_all_else_is_the_same,
       the_difference_before_is_known_from_the_second_frame_on_in_which_it_is_wanted,
       steady_state_allocates_nothing});
}
