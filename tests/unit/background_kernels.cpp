// SPDX-License-Identifier: LGPL-2.1-or-later
// The background model's kernels against their scalar references, on every vector target of this processor, and the references
// against values computed by hand.
#include "vision/background/background_kernels.h"

#include <check.h>

#include <cstring>
#include <random>
#include <vector>

#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr int kMargin = 16;
const int kWidths[] = {1, 7, 16, 33, 63, 64, 65, 200, 320};

// A plane with readable margins, as the background model has it.
struct Margined {
  explicit Margined(Size size) : image({size.width + 2 * kMargin, size.height + 2}), size(size) {}
  MutableGrayView view() {
    const auto v = image.view();
    return {v.data + v.stride + kMargin, size.width, size.height, v.stride};
  }
  Image<std::uint8_t> image;
  Size size;
};

template <typename T>
void scatter(View<T> v, std::mt19937& random, unsigned below) {
  for (int y = 0; y < v.height; ++y)
    for (int x = 0; x < v.width; ++x) v.at(x, y) = static_cast<T>(random() % below);
}

std::vector<std::uint64_t> random_bits(int width, std::mt19937& random) {
  std::vector<std::uint64_t> bits(static_cast<std::size_t>(width + 63) / 64);
  for (auto& word : bits) word = static_cast<std::uint64_t>(random()) << 32 | random();
  return bits;
}

bool bit(const std::vector<std::uint64_t>& bits, int x) {
  return bits[static_cast<std::size_t>(x) / 64] >> (x % 64) & 1;
}

}  // namespace

START_TEST(block_sums_agree_with_the_reference) {
  std::mt19937 random(1);
  const Size size{48, 40};
  Image<std::uint8_t> frame(size), age(size), quiet(size);
  Margined memory(size);
  for (int round = 0; round < 40; ++round) {
    scatter(memory.image.view(), random, round % 2 ? 256 : 40);
    scatter(frame.view(), random, round % 2 ? 256 : 40);
    scatter(age.view(), random, 3);
    scatter(quiet.view(), random, 6);
    BlockRows rows{frame.view(), memory.view(), age.view(), quiet.view(), 1, 17, 1 + round % 2, 3};
    for (const int x : {0, 16, 32})
      ck_assert(block_sums(rows, x, 1 + round % 5, 47 - round % 11) ==
                block_sums_reference(rows, x, 1 + round % 5, 47 - round % 11));
  }
}
END_TEST

START_TEST(block_sums_of_a_ramp_are_those_of_its_slope) {
  // background = 3 x + 2 y, the frame is brighter by 5: doubled gradients 6 and 4, e = 5.
  const Size size{32, 20};
  Image<std::uint8_t> frame(size), age(size), quiet(size);
  Margined memory(size);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 32; ++x) {
      memory.view().at(x, y) = static_cast<std::uint8_t>(3 * x + 2 * y);
      frame.view().at(x, y) = static_cast<std::uint8_t>(3 * x + 2 * y + 5);
      age.view().at(x, y) = 1;
      quiet.view().at(x, y) = x < 4 ? 2 : 3;
    }
  const BlockSums s =
      block_sums({frame.view(), memory.view(), age.view(), quiet.view(), 1, 5, 2, 3}, 0, 1, 31);
  const int n = 15 * 2;  // columns 1 to 15, rows 1 and 3
  const BlockSums expected{n * 36, n * 24, n * 16, n * 30, n * 20, n * 25, n, 12 * 2 * 8 * 5, 12 * 2 * 64};
  ck_assert(s == expected);  // |gradient| = 6 + 4 / 2, where it has been quiet
}
END_TEST

START_TEST(comparison_agrees_with_the_reference) {
  std::mt19937 random(2);
  for (const int width : kWidths)
    for (int round = 0; round < 12; ++round) {
      const Size size{width, 1};
      Image<std::uint8_t> frame(size), spread(size), age(size), tolerance(size), fast_quiet(size),
          slow_quiet(size);
      Margined memory({width, 3});
      scatter(memory.image.view(), random, round % 2 ? 256 : 30);
      scatter(frame.view(), random, round % 2 ? 256 : 30);
      scatter(spread.view(), random, round % 3 ? 20 : 256);
      scatter(age.view(), random, 5);
      scatter(tolerance.view(), random, 49);
      scatter(fast_quiet.view(), random, 256);
      std::memcpy(slow_quiet.view().data, fast_quiet.view().data, static_cast<std::size_t>(width));
      const auto moved = random_bits(width, random);
      CompareLimits limits;
      limits.registered = round % 4 < 2;
      for (auto& n : limits.noise) n = static_cast<std::uint8_t>(random() % (round % 2 ? 256 : 40));
      CompareRow row{frame.view().data,
                     memory.view().row(0),
                     memory.view().row(1),
                     memory.view().row(2),
                     spread.view().data,
                     age.view().data,
                     tolerance.view().data,
                     moved.data(),
                     fast_quiet.view().data,
                     width,
                     round % 3};
      std::vector<std::uint64_t> weak(moved.size()), strong(moved.size()), weak2(moved.size()),
          strong2(moved.size());
      compare_row(row, limits, weak.data(), strong.data());
      row.quiet = slow_quiet.view().data;
      compare_row_reference(row, limits, weak2.data(), strong2.data());
      for (int x = 0; x < width; ++x) {
        ck_assert_int_eq(bit(weak, x), bit(weak2, x));
        ck_assert_int_eq(bit(strong, x), bit(strong2, x));
        ck_assert_int_eq(fast_quiet.view().at(x, 0), slow_quiet.view().at(x, 0));
      }
    }
}
END_TEST

START_TEST(comparison_follows_its_definition_on_single_pixels) {
  struct Case {
    int difference, noise, spread, slope, tolerance, age;
    bool moved, weak, strong;
    bool registered = false;
  };
  // Limits: weak max(6, 3 s), strong max(9, 5 s) levels, s = max(noise, 5/4 spread); edges add |gradient| x tolerance.
  const Case cases[] = {
      {6, 16, 0, 0, 16, 9, false, false, false},  // at the least difference, not above
      {7, 16, 0, 0, 16, 9, false, true, false},
      {10, 16, 0, 0, 16, 9, false, true, true},
      {10, 64, 0, 0, 16, 9, false, false, false},  // noise of 4 levels: 12 and 20
      {13, 64, 0, 0, 16, 9, false, true, false},
      {21, 64, 0, 0, 16, 9, false, true, true},
      {13, 16, 64, 0, 16, 9, false, false, false},  // spread of 4 levels: s = 5
      {16, 16, 64, 0, 16, 9, false, true, false},
      {20, 16, 0, 20, 16, 9, false, false, false},  // on an edge of 20 levels a pixel, one pixel of error
      {20, 16, 0, 20, 16, 9, true, true, false},    // unless it has moved as well
      {30, 16, 0, 20, 16, 9, false, true, true},
      {30, 16, 0, 20, 32, 9, false, false, false},
      {40, 16, 0, 0, 16, 1, false, false, false},  // too young: D(k) decides
      {0, 16, 0, 0, 16, 1, true, true, true},
      {20, 16, 0, 20, 16, 1, true, true, false, true},  // which may be a registration error
      {21, 16, 0, 20, 16, 1, true, true, true, true},
      {20, 16, 0, 20, 16, 1, true, true, true, false}};
  for (const Case& c : cases) {
    const Size size{1, 1};
    Margined memory({1, 3});
    Image<std::uint8_t> one(size);
    for (int y = -1; y < 4 - 1; ++y)
      for (int x = -1; x <= 1; ++x) memory.view().at(x, y) = static_cast<std::uint8_t>(100 + c.slope * x);
    const std::uint8_t frame = static_cast<std::uint8_t>(100 + c.difference),
                       spread = static_cast<std::uint8_t>(c.spread), age = static_cast<std::uint8_t>(c.age),
                       tolerance = static_cast<std::uint8_t>(c.tolerance);
    std::uint8_t quiet = 7;
    const std::uint64_t moved = c.moved;
    CompareLimits limits;
    limits.noise.fill(static_cast<std::uint8_t>(c.noise));
    limits.registered = c.registered;
    std::uint64_t weak = 0, strong = 0;
    compare_row_reference({&frame, memory.view().row(0), memory.view().row(1), memory.view().row(2), &spread,
                           &age, &tolerance, &moved, &quiet, 1, 2},
                          limits, &weak, &strong);
    ck_assert_msg((weak & 1) == c.weak && (strong & 1) == c.strong, "difference %d noise %d slope %d",
                  c.difference, c.noise, c.slope);
    ck_assert_int_eq(quiet, c.moved ? 0 : 9);
  }
}
END_TEST

START_TEST(learning_agrees_with_the_reference) {
  std::mt19937 random(3);
  for (const int width : kWidths)
    for (int round = 0; round < 12; ++round) {
      const Size size{width, 1};
      Image<std::uint8_t> frame(size), memory(size), taken(size), quiet(size), spread[2], age[2];
      Image<std::uint16_t> mean[2];
      for (int i = 0; i < 2; ++i) spread[i].resize(size), age[i].resize(size), mean[i].resize(size);
      scatter(frame.view(), random, 256);
      scatter(memory.view(), random, 256);
      scatter(taken.view(), random, 256);
      scatter(quiet.view(), random, 256);
      for (int x = 0; x < width; ++x)
        for (int i = 0; i < 2; ++i) {
          spread[i].view().at(x, 0) = i ? spread[0].view().at(x, 0) : static_cast<std::uint8_t>(random());
          age[i].view().at(x, 0) =
              i ? age[0].view().at(x, 0) : static_cast<std::uint8_t>(random() % (round % 2 ? 256 : 4));
          mean[i].view().at(x, 0) =
              i ? mean[0].view().at(x, 0) : static_cast<std::uint16_t>(random() % 65281);
        }
      const auto keep = random_bits(width, random), absorb = random_bits(width, random),
                 valid = random_bits(width, random);
      for (int i = 0; i < 2; ++i) {
        const LearnRow row{frame.view().data,
                           memory.view().data,
                           taken.view().data,
                           quiet.view().data,
                           keep.data(),
                           absorb.data(),
                           valid.data(),
                           mean[i].view().data,
                           spread[i].view().data,
                           age[i].view().data,
                           width,
                           round % 3 ? 15 : 0,
                           round % 4 + 1};
        if (i)
          learn_row_reference(row);
        else
          learn_row(row);
      }
      for (int x = 0; x < width; ++x) {
        ck_assert_int_eq(mean[0].view().at(x, 0), mean[1].view().at(x, 0));
        ck_assert_int_eq(spread[0].view().at(x, 0), spread[1].view().at(x, 0));
        ck_assert_int_eq(age[0].view().at(x, 0), age[1].view().at(x, 0));
      }
    }
}
END_TEST

START_TEST(a_steady_picture_is_averaged_over_its_first_frames) {
  // Frames 100, 110, 120, 130: each age's rate is 1 / (age + 1), so the mean is the plain mean.
  std::uint16_t mean = 0;
  std::uint8_t spread = 0, age = 0;
  const std::uint8_t quiet = 0;
  const std::uint64_t none = 0, all = 1;
  for (const int value : {100, 110, 120, 130}) {
    const std::uint8_t frame = static_cast<std::uint8_t>(value),
                       memory = static_cast<std::uint8_t>((mean + 128) >> 8);
    learn_row_reference({&frame, &memory, &frame, &quiet, &none, &none, &all, &mean, &spread, &age, 1, 0});
  }
  ck_assert_int_eq(age, 4);
  ck_assert_double_eq_tol(mean / 256.0, 115, 0.2);
  const std::uint8_t other = 10, in_its_light = 12, memory = 115;
  learn_row_reference({&other, &memory, &other, &quiet, &all, &none, &all, &mean, &spread, &age, 1,
                       0});  // foreground: kept out
  ck_assert_double_eq_tol(mean / 256.0, 115, 0.2);
  learn_row_reference({&other, &memory, &in_its_light, &quiet, &all, &all, &all, &mean, &spread, &age, 1,
                       0});  // absorbed: at once
  ck_assert_int_eq(mean, 12 << 8);
  ck_assert_int_eq(age, 2);
}
END_TEST

// At 100 frames a second: quiet counts one for four frames.
START_TEST(an_absorbed_pixel_is_half_as_old_as_it_has_rested) {
  struct Case {
    std::uint8_t age, quiet;
    int tick, then;
  };
  for (const Case& c : {Case{200, 25, 4, 50}, {200, 25, 1, 12}, {60, 25, 4, 30}, {200, 0, 4, 2}}) {
    std::uint16_t mean = 100 << 8;
    std::uint8_t spread = 16, age = c.age;
    const std::uint8_t frame = 10, memory = 100;
    const std::uint64_t none = 0, all = 1;
    learn_row_reference(
        {&frame, &memory, &frame, &c.quiet, &none, &all, &all, &mean, &spread, &age, 1, 0, c.tick});
    ck_assert_int_eq(age, c.then);
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "scene_kernels",
      {block_sums_agree_with_the_reference, block_sums_of_a_ramp_are_those_of_its_slope,
       comparison_agrees_with_the_reference, comparison_follows_its_definition_on_single_pixels,
       learning_agrees_with_the_reference, a_steady_picture_is_averaged_over_its_first_frames,
       an_absorbed_pixel_is_half_as_old_as_it_has_rested});
}
