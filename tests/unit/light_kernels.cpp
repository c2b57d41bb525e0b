// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels of light against their scalar references, on every vector target of this processor, and the references
// against values computed by hand.
#include "vision/change/light_kernels.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/pictures.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

std::vector<std::uint8_t> levels(std::size_t count, unsigned from, std::mt19937& random) {
  std::vector<std::uint8_t> out(count);
  for (auto& level : out) level = static_cast<std::uint8_t>(from + random() % (256 - from));
  return out;
}

RowLight any_light(std::mt19937& random) {
  return {static_cast<std::int32_t>(64 + random() % 900),
          static_cast<std::int32_t>(random() % 20000) - 10000};
}

}  // namespace

START_TEST(sums_agree_with_the_reference) {
  std::mt19937 random(1);
  for (const int third : {16, 32, 48, 255 * 16})
    for (int rows = 1; rows <= 4; ++rows)
      for (const unsigned from : {0u, 220u}) {
        const std::size_t count = static_cast<std::size_t>(3 * third * rows);
        const auto reference = levels(count, from, random), present = levels(count, from, random);
        std::vector<RowLight> lights(static_cast<std::size_t>(rows));
        for (std::size_t i = 1; i < lights.size(); ++i) lights[i] = any_light(random);
        ck_assert(sum_samples(reference.data(), present.data(), lights.data(), rows, third) ==
                  sum_samples_reference(reference.data(), present.data(), lights.data(), rows, third));
      }
}
END_TEST

START_TEST(sums_leave_white_out_and_limit_what_remains) {
  // Half the light and 10 levels more: 100 becomes 60, 20 becomes 20; 244 is 132, 245 is white and not counted. In
  // four times the light 58 is 232 and 59 is near white.
  std::vector<std::uint8_t> reference(96, 255), present(96, 0);
  const auto put = [&](std::size_t at, int from, int to) {
    reference[at] = static_cast<std::uint8_t>(from), present[at] = static_cast<std::uint8_t>(to);
  };
  put(0, 100, 65), put(1, 100, 40), put(16, 20, 20), put(32, 244, 133), put(33, 245, 90);
  put(48, 58, 230), put(49, 59, 90);
  const RowLight lights[]{{128, 10 * 256}, {1024, 0}};
  LightSums expected;
  expected.number = {3, 1, 1}, expected.brighter = {1, 0, 1}, expected.darker = {2, 0, 0};
  expected.level = 60 + 60 + 20 + 132 + 232;
  expected.misfit = 5 + 16 + 0 + 1 + 2;
  ck_assert(sum_samples_reference(reference.data(), present.data(), lights, 2, 16) == expected);
  ck_assert(sum_samples(reference.data(), present.data(), lights, 2, 16) == expected);
}
END_TEST

START_TEST(rows_are_relit_as_the_reference_does_in_place_too) {
  std::mt19937 random(2);
  for (const int width : {1, 7, 16, 33, 320, 321})
    for (int round = 0; round < 40; ++round) {
      const auto reference = levels(static_cast<std::size_t>(width), round % 2 ? 230 : 0, random),
                 present = levels(static_cast<std::size_t>(width), 0, random);
      RowLight light = any_light(random);
      if (round == 0) light = {};
      if (round % 4 == 1) light.gain *= 16;
      auto fast = reference, slow = reference;
      relight_row_with_white(fast.data(), present.data(), light, width, fast.data());
      relight_row_with_white_reference(reference.data(), present.data(), light, width, slow.data());
      ck_assert(fast == slow);
      fast = reference;
      relight_row(fast.data(), light, width, fast.data());
      for (int x = 0; x < width; ++x)
        ck_assert_int_eq(
            fast[static_cast<std::size_t>(x)],
            std::clamp((reference[static_cast<std::size_t>(x)] * light.gain + light.offset + 128) >> 8, 0,
                       255));
    }
}
END_TEST

START_TEST(near_white_is_what_the_present_has_between_what_it_is_in_the_two_lights) {
  const std::uint8_t reference[]{234, 235, 235, 245, 245, 255}, present[]{200, 100, 240, 100, 250, 255};
  std::uint8_t out[6];
  relight_row_with_white_reference(reference, present, {128, 0}, 6, out);
  const std::uint8_t half[]{117, 118, 235,
                            123, 250, 255};  // 245 / 2, rounded up; white may be more than that
  ck_assert(std::equal(out, out + 6, half));
  relight_row_with_white_reference(reference, present, {256, 0}, 6, out);
  ck_assert(std::equal(out, out + 6, reference));
  const std::uint8_t dark[]{117, 118, 118, 150, 150, 117}, seen[]{130, 110, 130, 140, 200, 255};
  relight_row_with_white_reference(dark, seen, {512, 0}, 6, out);
  const std::uint8_t twice[]{234, 118, 130, 150, 200, 234};
  ck_assert(std::equal(out, out + 6, twice));
}
END_TEST

START_TEST(samples_are_relit_as_rows_are) {
  std::mt19937 random(4);
  for (int round = 0; round < 100; ++round) {
    const auto samples = levels(kSampleLanes, 0, random);
    RowLight light = any_light(random);
    if (round % 4 == 1) light.gain *= 16;
    std::vector<std::uint8_t> fast(kSampleLanes), slow(kSampleLanes);
    relight_samples(samples.data(), light, fast.data());
    relight_row(samples.data(), light, kSampleLanes, slow.data());
    ck_assert(fast == slow);
  }
}
END_TEST

START_TEST(every_eighth_is_taken_and_nothing_behind_the_last_is_read) {
  std::mt19937 random(5);
  for (int number = 0; number <= 40; ++number) {
    const std::size_t bytes = number ? static_cast<std::size_t>(8 * (number - 1) + 1) : 0;
    GuardedBytes from(bytes);
    for (std::size_t i = 0; i < bytes; ++i) from.data()[i] = static_cast<std::uint8_t>(random());
    std::vector<std::uint8_t> to(static_cast<std::size_t>(number) + 1, 7);
    take_every_eighth(from.data(), number, to.data());
    for (int i = 0; i < number; ++i) ck_assert_uint_eq(to[static_cast<std::size_t>(i)], from.data()[8 * i]);
    ck_assert_uint_eq(to.back(), 7);
  }
}
END_TEST

START_TEST(gains_are_those_of_half_a_level_less_and_more) {
  // A level is 2/256 of 128 and 25.6/256 of 10. What is beyond a quarter counts as a quarter.
  std::vector<std::uint8_t> reference(kSampleLanes, 100), now(kSampleLanes, 128), present(kSampleLanes, 128);
  const auto put = [&](std::size_t i, int level, int to) {
    now[i] = static_cast<std::uint8_t>(level), present[i] = static_cast<std::uint8_t>(to);
  };
  put(1, 128, 130), put(2, 10, 10), put(3, 20, 200), put(4, 200, 20), put(5, 235, 236), put(6, 0, 0);
  reference[7] = 245;
  const struct {
    int lower, higher, weight;
  } expected[] = {{-1, 1, 64},    {3, 5, 64}, {-13, 12, 10}, {64, 64, 20},
                  {-64, -64, 64}, {0, 0, 0},  {0, 0, 0},     {0, 0, 0}};
  for (const auto find : {find_gains, find_gains_reference}) {
    SampleGains gains;
    find(reference.data(), now.data(), present.data(), gains);
    for (std::size_t i = 0; i < std::size(expected); ++i) {
      ck_assert_uint_eq(gains.weight[i], static_cast<unsigned>(expected[i].weight));
      if (!expected[i].weight) continue;
      ck_assert_int_eq(gains.lower[i] - SampleGains::kReach, expected[i].lower);
      ck_assert_int_eq(gains.higher[i] - SampleGains::kReach, expected[i].higher);
    }
  }
}
END_TEST

START_TEST(gains_agree_with_the_reference_for_all_levels) {
  for (unsigned level = 0; level < 256; ++level)
    for (unsigned to = 0; to < 256; to += kSampleLanes) {
      std::vector<std::uint8_t> now(kSampleLanes, static_cast<std::uint8_t>(level)), present(kSampleLanes);
      for (std::size_t i = 0; i < kSampleLanes; ++i) present[i] = static_cast<std::uint8_t>(to + i);
      SampleGains fast, slow;
      find_gains(present.data(), now.data(), present.data(), fast);
      find_gains_reference(present.data(), now.data(), present.data(), slow);
      ck_assert(fast.lower == slow.lower && fast.higher == slow.higher && fast.weight == slow.weight);
    }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "light_kernels",
      {sums_agree_with_the_reference, sums_leave_white_out_and_limit_what_remains,
       rows_are_relit_as_the_reference_does_in_place_too,
       near_white_is_what_the_present_has_between_what_it_is_in_the_two_lights, samples_are_relit_as_rows_are,
       every_eighth_is_taken_and_nothing_behind_the_last_is_read,
       gains_are_those_of_half_a_level_less_and_more, gains_agree_with_the_reference_for_all_levels});
}
