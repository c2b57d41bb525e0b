// SPDX-License-Identifier: LGPL-2.1-or-later
// A change of light between two pictures, against changes that were made by hand.
#include "vision/light.h"

#include <check.h>

#include "support/suite.h"
#include "vision/image.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

void fill_ramp(MutableGrayView v, double gain, double offset) {
  for (int y = 0; y < v.height; ++y)
    for (int x = 0; x < v.width; ++x)
      v.at(x, y) = static_cast<std::uint8_t>(gain * (40 + 120 * x / v.width) + offset + 0.5);
}

}  // namespace

START_TEST(equal_pictures_have_no_change_of_light_whatever_their_size) {
  // All samples of the large ones are alike: more than 65535 fall into one class.
  for (const Size size : {Size{64, 48}, Size{2048, 1040}, Size{3840, 2160}}) {
    Image<std::uint8_t> picture(size);
    picture.fill_bytes(32);
    LightChange light;
    light.estimate(picture.view(), picture.view(), {});
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
    LightChange light;
    light.estimate(before.view(), after.view(), {});
    ck_assert(!light.none());
    ck_assert_double_eq_tol(light.gain() * 100 + light.offset(), 115, 1);
    ck_assert_double_ge(light.agreement(), 0.95);
  }
}
END_TEST

int main() {
  return run_suite("light", {equal_pictures_have_no_change_of_light_whatever_their_size,
                             gain_and_offset_are_found_at_every_size});
}
