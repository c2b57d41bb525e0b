// SPDX-License-Identifier: LGPL-2.1-or-later
// What lies between two fronts of one thing. Pictures are 160 x 120, the scene is 100 everywhere.
#include "vision/background/component_fronts.h"

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
  // Pixels set between these parts.
  int join(const Rect& a, const Rect& b) {
    for (const Rect& r : {a, b})
      for (int y = r.y; y < r.y + r.height; ++y) set_bits(mask.view().row(y), r.x, r.x + r.width);
    Labeller labeller;
    labeller.preallocate(kSize);
    join_fronts(frame.view(), labeller.find(mask.view(), kSize.width), mask.view());
    int set = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) set += mask.view().row(y)[x / 64] >> (x % 64) & 1;
    return set - a.area() - b.area();
  }
};

}  // namespace

START_TEST(what_has_its_sides_from_front_to_front_is_one) {
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

START_TEST(where_the_scene_is_seen_between_them_they_are_two) {
  Scene scene;
  scene.paint({60, 16, 20, 8}, 40);
  scene.paint({60, 76, 20, 6}, 40);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 0);
}
END_TEST

START_TEST(one_side_is_the_scene_s) {
  Scene scene;
  scene.paint({0, 0, 60, 120}, 40);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 0);
}
END_TEST

// Seventy grey levels of noise, in grains of so many pixels, are full of edges.
START_TEST(gravel_has_no_sides_that_go_on) {
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

// Where the wall behind somebody ends and the floor begins his sides are the other way round from there on.
START_TEST(a_side_may_turn_where_another_scene_begins) {
  Scene scene;
  scene.paint({0, 48, 160, 72}, 40);
  scene.paint({60, 20, 20, 60}, 70);
  ck_assert_int_eq(scene.join({60, 16, 20, 8}, {60, 76, 20, 6}), 20 * 52);
}
END_TEST

START_TEST(who_is_beside_or_far_or_of_other_columns_is_another) {
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

START_TEST(a_side_out_of_the_picture_is_none) {
  for (const int x : {0, 140, 4, 136}) {
    Scene scene;
    scene.paint({x, 20, 20, 60}, 40);
    ck_assert_int_eq(scene.join({x, 16, 20, 8}, {x, 76, 20, 6}), x == 4 || x == 136 ? 20 * 52 : 0);
  }
}
END_TEST

int main() {
  return run_suite("scene_fronts",
                   {what_has_its_sides_from_front_to_front_is_one, the_sides_may_lean,
                    where_the_scene_is_seen_between_them_they_are_two, one_side_is_the_scene_s,
                    gravel_has_no_sides_that_go_on, a_side_may_turn_where_another_scene_begins,
                    who_is_beside_or_far_or_of_other_columns_is_another, a_side_out_of_the_picture_is_none});
}
