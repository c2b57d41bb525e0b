// SPDX-License-Identifier: LGPL-2.1-or-later
// Gaps between fragments of one object. Pictures are 160 x 120, the background is 100 everywhere.
#include "vision/components/fragment_joining.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{160, 120};

struct Rect {
  int x, y, width, height;
  int area() const { return width * height; }
};

struct Scene {
  Image<std::uint8_t> frame{kSize};
  BitMask mask;

  Scene() {
    frame.fill_bytes(100);
    mask.resize(bit_mask_size(kSize));
  }
  void paint(const Rect& r, int value) {
    for (int y = r.y; y < r.y + r.height; ++y)
      std::fill_n(frame.view().row(y) + r.x, r.width, static_cast<std::uint8_t>(value));
  }
  // Pixels set between these components.
  int join(const Rect& a, const Rect& b) {
    for (const Rect& r : {a, b})
      for (int y = r.y; y < r.y + r.height; ++y) set_bits(mask.view().row(y), r.x, r.x + r.width);
    Labeller labeller;
    labeller.preallocate(kSize);
    join_fragments(frame.view(), labeller.find(mask.view(), kSize.width), mask.view());
    int set = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) set += mask.view().row(y)[x / 64] >> (x % 64) & 1;
    return set - a.area() - b.area();
  }
};

}  // namespace

START_TEST(fragments_with_continuous_sides_are_joined) {
  for (const int value : {40, 108, 200}) {
    Scene scene;
    scene.paint({60, 20, 20, 60}, value);
    ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 20 * 52);
  }
}
END_TEST

START_TEST(the_sides_may_lean) {
  Scene scene;
  for (int y = 20; y < 80; ++y) scene.paint({60 - (y - 20) / 10, y, 20 + (y - 20) / 5, 1}, 40);
  const int set = scene.join({60, 16, 20, 8}, {54, 76, 32, 6});
  ck_assert_int_gt(set, 24 * 52);
  ck_assert_int_lt(set, 28 * 52);
}
END_TEST

START_TEST(fragments_with_background_between_them_are_not_joined) {
  Scene scene;
  scene.paint({60, 16, 20, 8}, 40);
  scene.paint({60, 76, 20, 6}, 40);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 0);
}
END_TEST

START_TEST(one_continuous_side_is_not_enough) {
  Scene scene;
  scene.paint({0, 0, 60, 120}, 40);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 0);
}
END_TEST

// Seventy grey levels of noise, in grains of so many pixels, are full of edges.
START_TEST(gravel_has_no_continuous_sides) {
  for (const int grain : {1, 2, 3, 4}) {
    Scene scene;
    std::mt19937 random(5);
    std::vector<std::uint8_t> grains(static_cast<std::size_t>(kSize.area()));
    for (std::uint8_t& g : grains) g = static_cast<std::uint8_t>(65 + random() % 71);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        scene.frame.view().at(x, y) =
            grains[static_cast<std::size_t>(y / grain) * kSize.width + static_cast<std::size_t>(x / grain)];
    ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 0);
  }
}
END_TEST

// Where the wall behind a person ends and the floor begins, the contrast of his sides changes its sign.
START_TEST(a_side_may_change_its_sign_where_the_background_changes) {
  Scene scene;
  scene.paint({0, 48, 160, 72}, 40);
  scene.paint({60, 20, 20, 60}, 70);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 20 * 52);
}
END_TEST

START_TEST(components_beside_or_far_apart_or_of_other_columns_are_not_joined) {
  Scene scene;
  scene.paint({60, 10, 20, 100}, 40);
  ck_assert_int_eq(scene.join({60, 20, 20, 40}, {90, 20, 20, 40}), 0);  // beside
  scene = {};
  scene.paint({60, 10, 20, 100}, 40);
  ck_assert_int_eq(scene.join({60, 10, 20, 8}, {60, 104, 20, 6}), 0);  // five times as tall as wide
  scene = {};
  scene.paint({60, 10, 20, 100}, 40);
  ck_assert_int_eq(scene.join({60, 20, 20, 8}, {75, 60, 20, 6}), 0);  // a quarter of the columns
}
END_TEST

START_TEST(a_side_beyond_the_picture_does_not_count) {
  for (const int x : {0, 140, 4, 136}) {
    Scene scene;
    scene.paint({x, 20, 20, 60}, 40);
    ck_assert_int_eq(scene.join({x, 16, 20, 8}, {x, 76, 20, 6}), x == 4 || x == 136 ? 20 * 52 : 0);
  }
}
END_TEST

int main() {
  return run_suite("fragment_joining",
                   {fragments_with_continuous_sides_are_joined, the_sides_may_lean,
                    fragments_with_background_between_them_are_not_joined, one_continuous_side_is_not_enough,
                    gravel_has_no_continuous_sides, a_side_may_change_its_sign_where_the_background_changes,
                    components_beside_or_far_apart_or_of_other_columns_are_not_joined,
                    a_side_beyond_the_picture_does_not_count});
}
