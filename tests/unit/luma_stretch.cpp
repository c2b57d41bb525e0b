// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures of words with values spread over a known part of their range: which part becomes black to white, and when it
// moves.
#include "vision/image/luma/luma_stretch.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr int kWidth = 160, kHeight = 120;

// Values spread evenly from `low` to `high`, in a fixed disorder.
struct Picture {
  std::vector<std::uint16_t> words = std::vector<std::uint16_t>(kWidth * kHeight);
  int word_shift = 8;
  bool swapped = false;

  Picture(int low, int high) {
    const auto count = static_cast<int>(words.size());
    for (int i = 0; i < count; ++i)
      words[static_cast<std::size_t>(i)] =
          static_cast<std::uint16_t>(low + std::int64_t{high - low} * i / (count - 1));
    std::mt19937 random(3);
    std::ranges::shuffle(words, random);
  }
  LumaSource source() const {
    LumaSource s{reinterpret_cast<const std::uint8_t*>(words.data()), kWidth, kHeight, 2 * kWidth, 2};
    s.word_shift = word_shift, s.swapped = swapped;
    return s;
  }
};

void expect_part(const LumaSource& found, double low, double span, double tolerance) {
  ck_assert_msg(std::abs(found.low - low) <= tolerance && std::abs(found.span - span) <= tolerance,
                "%d + %d, not %.0f + %.0f", found.low, found.span, low, span);
}

}  // namespace

START_TEST(values_in_a_few_percent_of_the_range_fill_two_thirds_of_it) {
  // 29000 to 31000: the part is half as wide again, with the same middle.
  expect_part(LumaStretch().stretched(Picture(29000, 31000).source()), 28500, 3000, 100);
  Picture ten(300, 360);  // of 1024
  ten.word_shift = 2;
  expect_part(LumaStretch().stretched(ten.source()), 285, 90, 3);
  Picture big(29000, 31000);
  for (std::uint16_t& word : big.words) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
  big.swapped = true;
  expect_part(LumaStretch().stretched(big.source()), 28500, 3000, 100);
  // At the ends of the range there is no room on one side.
  expect_part(LumaStretch().stretched(Picture(0, 2000).source()), 0, 3000, 100);
  expect_part(LumaStretch().stretched(Picture(63535, 65535).source()), 62536, 3000, 100);
}
END_TEST

START_TEST(noise_around_one_value_is_stretched_by_no_more_than_64) {
  const LumaSource found = LumaStretch().stretched(Picture(29990, 30010).source());
  expect_part(found, 30000 - 512, 1024, 10);
}
END_TEST

START_TEST(an_even_picture_stays_as_it_is_until_there_is_something_in_it) {
  LumaStretch stretch;
  ck_assert_int_eq(stretch.stretched(Picture(30000, 30000).source()).span, 0);
  expect_part(stretch.stretched(Picture(29000, 31000).source()), 28500, 3000, 160);
  expect_part(stretch.stretched(Picture(30000, 30000).source()), 28500, 3000, 160);  // the shutter
}
END_TEST

START_TEST(hot_and_dead_pixels_do_not_count) {
  Picture picture(29000, 31000);
  for (std::size_t i = 0; i < picture.words.size(); i += 199) picture.words[i] = i % 2 == 0 ? 0 : 65535;
  expect_part(LumaStretch().stretched(picture.source()), 28500, 3000, 150);
}
END_TEST

START_TEST(ordinary_video_and_bytes_stay_as_they_are) {
  // .26 of the range and more; limited range has .86 of it.
  for (const int low : {4096, 30000}) {
    const LumaSource found = LumaStretch().stretched(Picture(low, low + 18000).source());
    ck_assert_int_eq(found.span, 0);
  }
  ck_assert_int_eq(LumaStretch().stretched(Picture(4096, 60160).source()).span, 0);
  LumaSource bytes = Picture(29000, 31000).source();
  bytes.word_shift = 0;
  ck_assert_int_eq(LumaStretch().stretched(bytes).span, 0);
}
END_TEST

START_TEST(what_comes_into_the_picture_or_shifts_it_a_little_moves_nothing) {
  LumaStretch stretch;
  const LumaSource before = stretch.stretched(Picture(29000, 31000).source());
  Picture person(29000, 31000);  // 4 % of the picture
  for (std::size_t i = 0; i < person.words.size(); i += 25) person.words[i] = 33000;
  const Picture shifted(29300, 31300);
  for (int n = 0; n < 50; ++n) {
    for (const Picture* picture : std::initializer_list<const Picture*>{&person, &shifted}) {
      const LumaSource now = stretch.stretched(picture->source());
      ck_assert(now.low == before.low && now.span == before.span);
    }
  }
}
END_TEST

// A kettle, an exhaust: what is small is white, and the rest of the picture stays comparable.
START_TEST(a_small_object_that_is_much_hotter_than_the_scene_moves_nothing) {
  LumaStretch stretch;
  const LumaSource before = stretch.stretched(Picture(29000, 31000).source());
  Picture hot(29000, 31000);  // 2 % of the picture, three spans above the part
  for (std::size_t i = 0; i < hot.words.size(); i += 47) hot.words[i] = 31500 + 3 * 3000;
  const LumaSource now = stretch.stretched(hot.source());
  ck_assert(now.low == before.low && now.span == before.span);
}
END_TEST

START_TEST(the_part_follows_a_drift_slowly_and_stops_where_it_fits) {
  LumaStretch stretch;
  LumaSource last = stretch.stretched(Picture(29000, 31000).source());
  // Beyond the part on one side. The values of a camera are never quite the same.
  int moved = 0;
  for (int n = 0; n < 200; ++n) {
    const LumaSource now = stretch.stretched(Picture(29900 + n % 2, 31900 + n % 2).source());
    const double step = last.span / 64.0 + 1;
    ck_assert(std::abs(now.low - last.low) <= step);
    ck_assert(std::abs(now.low + now.span - last.low - last.span) <= step);
    moved += now.low != last.low || now.span != last.span;
    last = now;
  }
  expect_part(last, 29400, 3000, 150);
  ck_assert_int_lt(moved, 40);
}
END_TEST

START_TEST(a_part_that_the_values_hardly_fill_is_narrowed_and_given_up_for_ordinary_video) {
  LumaStretch stretch;
  stretch.stretched(Picture(20000, 34000).source());
  LumaSource now;
  for (int n = 0; n < 400; ++n) now = stretch.stretched(Picture(26000 + n % 2, 27000 + n % 2).source());
  expect_part(now, 25750, 1500, 100);
  ck_assert_int_eq(stretch.stretched(Picture(4096, 60160).source()).span, 0);
}
END_TEST

START_TEST(another_scene_has_its_part_at_once) {
  LumaStretch stretch;
  stretch.stretched(Picture(29000, 31000).source());
  expect_part(stretch.stretched(Picture(40000, 42000).source()), 39500, 3000, 100);
  stretch.reset();
  expect_part(stretch.stretched(Picture(41000, 43000).source()), 40500, 3000, 100);
}
END_TEST

START_TEST(a_picture_that_is_shown_again_has_the_same_part) {
  LumaStretch stretch;
  stretch.stretched(Picture(29000, 31000).source());
  const LumaSource moving = stretch.stretched(Picture(29900, 31900).source());
  for (int n = 0; n < 5; ++n) {
    const LumaSource again = stretch.stretched(Picture(29900, 31900).source());
    ck_assert(again.low == moving.low && again.span == moving.span);
  }
  ck_assert(stretch.stretched(Picture(29901, 31901).source()).low != moving.low);
}
END_TEST

START_TEST(any_size_is_read_inside_its_memory_and_nothing_is_allocated) {
  LumaStretch stretch;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(3, 200), std::pair(200, 3), std::pair(65, 33)}) {
    std::vector<std::uint16_t> words(static_cast<std::size_t>(width * height), 500);
    words.back() = 501;
    LumaSource s{reinterpret_cast<const std::uint8_t*>(words.data()), width, height, 2 * width, 2};
    s.word_shift = 2;
    const std::size_t before = cerberus::tests::allocations();
    stretch.stretched(s);
    ck_assert_uint_eq(cerberus::tests::allocations(), before);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "luma_stretch", {values_in_a_few_percent_of_the_range_fill_two_thirds_of_it,
                       noise_around_one_value_is_stretched_by_no_more_than_64,
                       an_even_picture_stays_as_it_is_until_there_is_something_in_it,
                       hot_and_dead_pixels_do_not_count, ordinary_video_and_bytes_stay_as_they_are,
                       what_comes_into_the_picture_or_shifts_it_a_little_moves_nothing,
                       a_small_object_that_is_much_hotter_than_the_scene_moves_nothing,
                       the_part_follows_a_drift_slowly_and_stops_where_it_fits,
                       a_part_that_the_values_hardly_fill_is_narrowed_and_given_up_for_ordinary_video,
                       another_scene_has_its_part_at_once, a_picture_that_is_shown_again_has_the_same_part,
                       any_size_is_read_inside_its_memory_and_nothing_is_allocated});
}
