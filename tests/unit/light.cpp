// SPDX-License-Identifier: LGPL-2.1-or-later
// A change of light between two pictures, against changes that were made by hand.
#include "vision/change/light.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/suite.h"
#include "vision/image/image.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

void fill_ramp(MutableGrayView v, double gain, double offset) {
  for (int y = 0; y < v.height; ++y)
    for (int x = 0; x < v.width; ++x)
      v.at(x, y) = static_cast<std::uint8_t>(gain * (40 + 120 * x / v.width) + offset + 0.5);
}

constexpr Size kSize{320, 240};

// Mains light under a rolling shutter: 140 rows a period.
double band(int y) {
  return 1 + 0.06 * std::sin(2 * std::numbers::pi * y / 140 + 1);
}

LightChange change(GrayView reference, GrayView present) {
  LightSamples samples;
  samples.take(reference, present, {});
  LightChange light;
  light.estimate(samples, true);
  return light;
}

// The present is the reference in bands of light, but for white. How far any row is off then, grey levels at `level`.
double worst_error(GrayView reference, double level) {
  Image<std::uint8_t> present(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      present.view().at(x, y) =
          static_cast<std::uint8_t>(std::min(reference.at(x, y) * band(y) + 0.5, 255.0));
  const LightChange light = change(reference, present.view());
  double worst = 0;
  for (int y = 0; y < kSize.height; ++y)
    worst =
        std::max(worst, std::abs((light.row(y).gain * level + light.row(y).offset) / 256 - band(y) * level));
  return worst;
}

}  // namespace

START_TEST(equal_pictures_have_no_change_of_light_whatever_their_size) {
  // All samples of the large ones are alike: more than 65535 fall into one class.
  for (const Size size : {Size{64, 48}, Size{2048, 1040}, Size{3840, 2160}}) {
    Image<std::uint8_t> picture(size);
    picture.fill_bytes(32);
    const LightChange light = change(picture.view(), picture.view());
    ck_assert(light.none());
    ck_assert_double_eq(light.agreement(), 1);
  }
}
END_TEST

START_TEST(gain_and_offset_are_found_at_every_size) {
  for (const Size size : {Size{320, 240}, Size{1920, 1080}}) {
    Image<std::uint8_t> before(size), after(size);
    fill_ramp(before.view(), 1, 0);
    fill_ramp(after.view(), 1.2, -5);
    const LightChange light = change(before.view(), after.view());
    ck_assert(!light.none());
    ck_assert_double_eq_tol(light.gain() * 100 + light.offset(), 115, 1);
    ck_assert_double_ge(light.agreement(), 0.95);
  }
}
END_TEST

START_TEST(clipped_samples_do_not_determine_the_gain) {
  // Most of the picture is a wall that is white in the light to come, and does not determine the gain.
  Image<std::uint8_t> before(kSize), after(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const int level = x % 4 ? 180 + 50 * x / kSize.width : 40 + 100 * x / kSize.width;
      before.view().at(x, y) = static_cast<std::uint8_t>(level);
      after.view().at(x, y) = static_cast<std::uint8_t>(std::min(1.5 * level + 0.5, 255.0));
    }
  const LightChange light = change(before.view(), after.view());
  ck_assert_double_eq_tol(light.gain() * 60 + light.offset(), 90, 2);
  ck_assert_double_eq_tol(light.gain() * 130 + light.offset(), 195, 2);
}
END_TEST

START_TEST(bands_are_not_taken_for_brightness_where_bright_and_dark_lie_apart) {
  // Sky, a wall, a floor: every row has one brightness, and every brightness its own light.
  Image<std::uint8_t> reference(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      reference.view().at(x, y) = static_cast<std::uint8_t>((y < 80 ? 190 : y < 160 ? 60 : 120) + x % 16);
  ck_assert_double_le(worst_error(reference.view(), 120), 1.5);
}
END_TEST

START_TEST(bands_go_on_where_all_is_white) {
  Image<std::uint8_t> reference(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      reference.view().at(x, y) = static_cast<std::uint8_t>(y >= 96 && y < 120 ? 255 : 100 + x % 64);
  ck_assert_double_le(worst_error(reference.view(), 100), 2);
}
END_TEST

START_TEST(few_columns_that_are_not_white_tell_of_bands) {
  Image<std::uint8_t> reference(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      reference.view().at(x, y) = static_cast<std::uint8_t>(y > 60 && x % 160 >= 16 ? 255 : 100 + x % 64);
  ck_assert_double_le(worst_error(reference.view(), 100), 2);
}
END_TEST

// Below a wall all is white but for a few pixels: their light is unknown, but is one of those
// above.
START_TEST(a_row_of_unknown_light_may_have_the_light_of_any_other) {
  Image<std::uint8_t> reference(kSize), present(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      reference.view().at(x, y) = static_cast<std::uint8_t>(y < 160 ? 100 + x % 64 : 255);
      present.view().at(x, y) =
          static_cast<std::uint8_t>(std::min(reference.view().at(x, y) * band(y) + 0.5, 255.0));
    }
  const LightChange light = change(reference.view(), present.view());
  for (int y = 0; y < kSize.height; ++y) {
    const std::uint8_t then[]{150, 150, 150, 150};
    const auto here = static_cast<std::uint8_t>(150 * band(y) + 0.5);
    const std::uint8_t now[]{here, 142, 158, 60};
    std::uint8_t out[4];
    light.relight(then, now, y, 4, out);
    ck_assert_int_le(std::abs(out[0] - here), 2);
    if (y < 160) {
      for (int i = 1; i < 4; ++i) ck_assert_int_le(std::abs(out[i] - here), 2);
    } else {
      ck_assert_int_eq(out[1], 142);
      ck_assert_int_eq(out[2], 158);
      ck_assert_int_ge(out[3], 120);  // but no light makes that of it
    }
  }
}
END_TEST

START_TEST(a_picture_that_is_white_in_one_light_only_agrees_with_nothing) {
  Image<std::uint8_t> white(kSize), grey(kSize);
  white.fill_bytes(255);
  grey.fill_bytes(128);
  ck_assert_double_eq(change(white.view(), white.view()).agreement(), 1);
  ck_assert_double_eq(change(white.view(), grey.view()).agreement(), 0);
}
END_TEST

START_TEST(an_object_in_less_than_half_of_its_rows_is_no_band) {
  Image<std::uint8_t> reference(kSize), present(kSize);
  fill_ramp(reference.view(), 1, 0);
  fill_ramp(present.view(), 1, 0);
  for (int y = 60; y < 160; ++y)
    for (int x = 90; x < 230; ++x) present.view().at(x, y) = 250;
  const LightChange light = change(reference.view(), present.view());
  for (int y = 0; y < kSize.height; ++y)
    ck_assert_msg(std::abs(light.row(y).gain * 100 + light.row(y).offset - 25600) <= 256, "row %d", y);
}
END_TEST

START_TEST(white_in_less_light_may_be_anything_brighter_than_its_share) {
  // 250 may have been 250 or much more: in half the light what is brighter than about 125 is as it has to be, and what
  // is darker is not. 100 was 100, and in the same light so was 250.
  for (const double gain : {0.5, 1.0}) {
    Image<std::uint8_t> before(kSize), after(kSize);
    fill_ramp(before.view(), 1, 0);
    fill_ramp(after.view(), gain, 0);
    const LightChange light = change(before.view(), after.view());
    const auto lit = [&](int level) { return level * light.gain() + light.offset(); };
    const std::uint8_t reference[]{100, 100, 250, 250, 250}, present[]{10, 200, 10, 200, 255};
    const double brighter = gain < 1 ? 200 : 250, brightest = gain < 1 ? 255 : 250;
    const double expected[]{lit(100), lit(100), lit(250), brighter, brightest};
    std::uint8_t out[5];
    light.relight(reference, present, 7, 5, out);
    for (int i = 0; i < 5; ++i) ck_assert_double_eq_tol(out[i], expected[i], 1);
    ck_assert_double_eq_tol(lit(100), 100 * gain, 2);
  }
}
END_TEST

int main() {
  return run_suite(
      "light",
      {equal_pictures_have_no_change_of_light_whatever_their_size, gain_and_offset_are_found_at_every_size,
       clipped_samples_do_not_determine_the_gain,
       bands_are_not_taken_for_brightness_where_bright_and_dark_lie_apart, bands_go_on_where_all_is_white,
       few_columns_that_are_not_white_tell_of_bands, a_row_of_unknown_light_may_have_the_light_of_any_other,
       a_picture_that_is_white_in_one_light_only_agrees_with_nothing,
       an_object_in_less_than_half_of_its_rows_is_no_band,
       white_in_less_light_may_be_anything_brighter_than_its_share});
}
