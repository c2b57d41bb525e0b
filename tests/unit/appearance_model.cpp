// SPDX-License-Identifier: LGPL-2.1-or-later
// Appearance models of flat pictures, where they can be computed by hand.
#include "vision/tracking/appearance_model.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{160, 120};
constexpr Box kPerson{60, 20, 20, 50};

// A street of even brightness with noise; the foreground is one person with a coat and legs.
struct Street {
  Image<std::uint8_t> luma{kSize}, mask{kSize};

  explicit Street(int coat, int legs, double gain = 1, double shift = 0, const Box& person = kPerson) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const int u = x + static_cast<int>(shift) + 1000;  // a point of the street
        const double ground = 90 + 40 * ((u / 20 + y / 20) % 2) + (u * 7 + y * 3) % 5;
        luma.view().at(x, y) = static_cast<std::uint8_t>(std::min(255.0, ground * gain));
      }
    const int middle = static_cast<int>(person.y + person.height / 2);
    for (int y = static_cast<int>(person.y); y < person.bottom(); ++y)
      for (int x = static_cast<int>(person.x); x < person.right(); ++x) {
        luma.view().at(x, y) = static_cast<std::uint8_t>((y < middle ? coat : legs) * gain);
        mask.view().at(x, y) = 255;
      }
  }
  Sight sight() const { return {luma.view(), mask.view()}; }
};

AppearanceModel look_of(const Street& street, const BrightnessLevel& level = {}, const Box& box = kPerson) {
  return appearance_of(street.sight(), level, box, 500);
}

// Where a grey level belongs, in bins.
double place(const BrightnessLevel& level, double grey) {
  const BrightnessLevel::Bin bin = level.bin(static_cast<std::uint8_t>(std::lround(grey)));
  return bin.first + bin.share / 16.0;
}

void assert_untouched(const BrightnessLevel& level) {
  const BrightnessLevel untouched;
  for (int grey = 0; grey < 256; ++grey) ck_assert_double_eq(place(level, grey), place(untouched, grey));
}

}  // namespace

// log2(128 + 8) = 7.0875 is (7.0875 - 3) / 5.05 x 8 - 0.5 = 5.975 bins of the way: the middle of bin 6, as near as
// 1/16.
START_TEST(a_band_of_one_brightness_is_in_the_bin_of_its_logarithm) {
  const AppearanceModel look = look_of(Street(128, 128));
  for (const auto& band : look.share)
    for (int i = 0; i < AppearanceModel::kBins; ++i)
      ck_assert_int_eq(band[i], i == 6 ? AppearanceModel::kAll : 0);
}
END_TEST

START_TEST(appearances_differ_by_the_share_of_pixels_of_another_brightness) {
  const AppearanceModel dark = look_of(Street(10, 10)), light = look_of(Street(200, 200)),
                        both = look_of(Street(10, 200));
  ck_assert_double_eq(appearance_distance(dark, dark), 0);
  ck_assert_double_eq(appearance_distance(dark, light), 1);
  ck_assert_double_eq(appearance_distance(dark, both), 0.5);
  ck_assert_double_eq(appearance_distance(both, light), 0.5);
  ck_assert_double_lt(appearance_distance(dark, AppearanceModel{}), 0);
  ck_assert(dark.known() && !AppearanceModel{}.known());
}
END_TEST

START_TEST(background_pixels_do_not_count) {
  Street street(60, 20);
  const AppearanceModel alone = look_of(street);
  Box wide = kPerson;  // as much ground as person, and the person in the middle
  wide.x -= 10;
  wide.width += 20;
  ck_assert_double_lt(appearance_distance(alone, look_of(street, {}, wide)), 0.01);
  ck_assert(!look_of(street, {}, {100, 20, 20, 50}).known());
  // Half a person gives as much evidence as is visible.
  Street cut(60, 20, 1, 0, {0, 20, 10, 50});
  ck_assert_double_lt(appearance_distance(alone, look_of(cut, {}, {-10, 20, 20, 50})), 0.01);
  ck_assert(!look_of(cut, {}, {-40, 20, 20, 50}).known());
}
END_TEST

START_TEST(a_step_of_exposure_does_not_change_the_appearance) {
  for (const double gain : {0.5, 0.7, 1.4}) {
    BrightnessLevel level;
    const Street before(100, 40), after(100, 40, gain);
    level.update(before.luma.view(), {});
    const AppearanceModel look = look_of(before, level);
    ck_assert_double_gt(appearance_distance(look, look_of(after, level)), 0.3);  // it would be one
    level.update(after.luma.view(), {});
    ck_assert_double_eq_tol(place(level, 100 * gain), place({}, 100), 0.13);  // 0.08 of twice as bright
    ck_assert_double_lt(appearance_distance(look, look_of(after, level)), 0.15);
    level.reset();
    assert_untouched(level);
  }
}
END_TEST

// The ground is dark and light, and a coat that fills a third of the picture comes and goes.
START_TEST(neither_a_turning_camera_nor_people_change_the_level) {
  BrightnessLevel level;
  for (int k = 0; k < 60; ++k) {
    const Box person{k % 3 == 0 ? 0.0 : 100.0, 0, 50, 120};
    const Street street(15, 15, 1, 3.0 * k, person);
    level.update(street.luma.view(), Transform::translation(-3, 0));
  }
  ck_assert_double_eq_tol(place(level, 100), place({}, 100), 0.19);
}
END_TEST

START_TEST(a_known_band_is_learnt_slowly_and_an_unknown_one_at_once) {
  const AppearanceModel dark = look_of(Street(10, 10)), light = look_of(Street(200, 200));
  AppearanceModel look = dark;
  look.learn(light, 0.25);
  ck_assert_double_eq_tol(appearance_distance(look, dark), 0.25, 1e-3);
  AppearanceModel legs = light;
  legs.share[0] = {};
  look = {};
  look.learn(legs, 0.25);
  ck_assert_double_eq(appearance_distance(look, light), 0);
  look.learn(light, 0.25);  // now the coat is seen, too
  ck_assert_double_eq(appearance_distance(look, light), 0);
  look.learn(AppearanceModel{}, 1);
  ck_assert_double_eq(appearance_distance(look, light), 0);
}
END_TEST

START_TEST(boxes_anywhere_and_of_any_size_do_no_harm_and_nothing_is_allocated) {
  const Street street(60, 20);
  BrightnessLevel level;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-300, 300);
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 2000; ++k) {
    const AppearanceModel look =
        appearance_of(street.sight(), level, {any(random), any(random), any(random), any(random)}, 200);
    for (const auto& band : look.share) {
      int sum = 0;
      for (const int share : band) sum += share;
      ck_assert(sum == 0 ||
                (sum <= AppearanceModel::kAll && sum > AppearanceModel::kAll - AppearanceModel::kBins));
    }
  }
  level.update(street.luma.view(), {});
  level.update(street.luma.view(), Transform::translation(1e9, -1e9));
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
  assert_untouched(level);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "look", {a_band_of_one_brightness_is_in_the_bin_of_its_logarithm,
               appearances_differ_by_the_share_of_pixels_of_another_brightness,
               background_pixels_do_not_count, a_step_of_exposure_does_not_change_the_appearance,
               neither_a_turning_camera_nor_people_change_the_level,
               a_known_band_is_learnt_slowly_and_an_unknown_one_at_once,
               boxes_anywhere_and_of_any_size_do_no_harm_and_nothing_is_allocated});
}
