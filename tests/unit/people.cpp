// SPDX-License-Identifier: LGPL-2.1-or-later
// Drawn people, so that the right boxes are known.
#include "vision/detection/people.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/bodies.h"
#include "support/suite.h"

using namespace cerberus::vision;
namespace tests = cerberus::tests;

namespace {

struct Scene {
  Size size;
  Image<std::uint8_t> mask;
  BitMask bits;
  HeightPrior prior;

  // People are as tall as their foot row is low, divided by `divisor`.
  explicit Scene(Size picture = {320, 240}, double divisor = 4) : size(picture), mask(picture) {
    bits.resize(bit_mask_size(picture));
    for (int i = 0; i < 64; ++i) {
      const double foot = picture.height * (0.3 + 0.7 * i / 63);
      prior.learn(foot, foot / divisor);
    }
  }

  void fill(double left, double top, double right, double bottom, std::uint8_t value = 255) {
    tests::fill(mask.view(), left, top, right, bottom, value);
  }
  Box draw(double middle, double foot, double height) {
    return tests::draw_body(mask.view(), middle, foot, height);
  }
  // The window is the box of all that moves.
  std::span<const Person> find(PeopleFinder& finder) {
    Bounds window{size.width, size.height, 0, 0};
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        if (mask.view().at(x, y)) {
          window = {std::min(window.left, x), std::min(window.top, y), std::max(window.right, x + 1),
                    std::max(window.bottom, y + 1)};
        }
    if (window.width() <= 0) window = {0, 0, 10, 10};
    pack(mask.view(), bits.view());
    finder.preallocate(size);
    return finder.find(bits.view(), window, prior);
  }
};

// Each expected box has its own found one, and there are no others.
void same_people(std::span<const Person> found, const std::vector<Box>& expected,
                 double least_overlap = 0.6) {
  ck_assert_uint_eq(found.size(), expected.size());
  std::vector<char> used(found.size(), 0);
  for (const Box& e : expected) {
    std::size_t best = 0;
    double overlap = -1;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (!used[i] && intersection_over_union(found[i].box, e) > overlap) {
        overlap = intersection_over_union(found[i].box, e);
        best = i;
      }
    used[best] = 1;
    ck_assert_double_ge(overlap, least_overlap);
  }
}

}  // namespace

START_TEST(one_person_is_one_box_in_the_right_place) {
  Scene scene;
  PeopleFinder finder;
  const Box box = scene.draw(150, 180, 45);
  const auto found = scene.find(finder);
  same_people(found, {box}, 0.85);
  ck_assert_double_gt(found[0].score, 0.7);
}
END_TEST

// Cells of several pixels, at whose edges the window need not begin. A cell moves when half of it does: an edge is
// found to half a cell, and as much is won as lost. Of a solid person half of the columns bring 178 / 64 a pixel, by
// the definition of the score, and half 139 / 64.
START_TEST(all_foreground_in_the_window_counts_at_any_size) {
  double score = 0, sizes = 0;
  for (int height = 60; height <= 200; height += 4) {
    Scene scene({640, 480}, 480.0 / height);
    PeopleFinder finder;
    const double foot = 460, tall = std::round(foot * height / 480), wide = std::round(0.36 * tall);
    scene.fill(301, foot - tall, 301 + wide, foot);
    const auto found = scene.find(finder);
    ck_assert_uint_eq(found.size(), 1);
    const double cell = std::floor(tall / 24);
    ck_assert_double_le(std::abs(found[0].box.x - 301), (cell + 1) / 2);
    score += found[0].score;
    ++sizes;
  }
  ck_assert_double_gt(score / sizes, 0.99 * (178 + 139) / 128);
}
END_TEST

START_TEST(two_persons_side_by_side_that_touch_are_two) {
  for (const double distance : {14.0, 16.0, 19.0, 23.0}) {
    Scene scene;
    PeopleFinder finder;
    const Box a = scene.draw(150, 180, 45), b = scene.draw(150 + distance, 182, 45);
    same_people(scene.find(finder), {a, b});
  }
}
END_TEST

START_TEST(four_in_a_row_are_four) {
  Scene scene;
  PeopleFinder finder;
  std::vector<Box> boxes;
  for (int i = 0; i < 4; ++i) boxes.push_back(scene.draw(120 + 17 * i, 180 + i % 2, 45));
  same_people(scene.find(finder), boxes);
}
END_TEST

START_TEST(a_person_cut_in_two_by_a_lamp_post_or_a_belt_is_one) {
  Scene scene;
  PeopleFinder finder;
  const Box box = scene.draw(150, 180, 45);
  scene.fill(0, 152, 320, 160, 0);  // a belt of 8 of 45 rows
  same_people(scene.find(finder), {box}, 0.75);
  scene.fill(148, 0, 152, 240, 0);  // and a post of 4 of 16 columns
  same_people(scene.find(finder), {box}, 0.75);
}
END_TEST

START_TEST(a_partly_occluded_person_is_found_by_the_visible_part) {
  Scene scene;
  PeopleFinder finder;
  const Box front = scene.draw(150, 200, 50), back = scene.draw(158, 172, 43);
  same_people(scene.find(finder), {front, back}, 0.5);
}
END_TEST

START_TEST(specks_and_small_animals_are_no_persons) {
  Scene scene;
  PeopleFinder finder;
  scene.fill(150, 170, 158, 180);  // 8 x 10 where people are 16 x 45
  ck_assert_uint_eq(scene.find(finder).size(), 0);
  Scene empty;
  ck_assert_uint_eq(empty.find(finder).size(), 0);
}
END_TEST

START_TEST(a_person_whose_feet_are_below_the_picture_is_placed_below_it) {
  Scene scene;
  PeopleFinder finder;
  scene.draw(150, 260, 65);
  const auto found = scene.find(finder);
  ck_assert_uint_eq(found.size(), 1);
  ck_assert_double_gt(found[0].box.bottom(), 248);
  ck_assert_double_eq_tol(found[0].box.y, 195, 8);
  ck_assert_double_eq_tol(found[0].box.x + found[0].box.width / 2, 150, 5);
}
END_TEST

START_TEST(a_person_at_the_left_border_may_be_half_outside) {
  Scene scene;
  PeopleFinder finder;
  const Box box = scene.draw(2, 180, 45);
  const auto found = scene.find(finder);
  ck_assert_uint_eq(found.size(), 1);
  ck_assert_double_eq_tol(found[0].box.x, box.x, 5);
}
END_TEST

START_TEST(a_larger_picture_gives_the_same_people_larger) {
  Scene scene({1280, 960});
  PeopleFinder finder;
  const Box a = scene.draw(600, 720, 180), b = scene.draw(668, 728, 180);
  same_people(scene.find(finder), {a, b});
}
END_TEST

START_TEST(without_a_known_height_no_person_is_found) {
  Scene scene;
  PeopleFinder finder;
  scene.draw(150, 180, 45);
  scene.prior.reset();
  ck_assert_uint_eq(scene.find(finder).size(), 0);
}
END_TEST

START_TEST(a_second_call_gives_the_same_and_allocates_nothing) {
  Scene scene;
  PeopleFinder finder;
  for (int i = 0; i < 4; ++i) scene.draw(120 + 17 * i, 180 + i % 2, 45);
  const auto first = scene.find(finder);
  const std::vector<Person> kept(first.begin(), first.end());
  const std::size_t bytes = finder.bytes();
  const auto second = scene.find(finder);
  ck_assert_uint_eq(second.size(), kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ck_assert_double_eq(second[i].box.x, kept[i].box.x);
    ck_assert_double_eq(second[i].score, kept[i].score);
  }
  ck_assert_uint_eq(finder.bytes(), bytes);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "people",
      {one_person_is_one_box_in_the_right_place, all_foreground_in_the_window_counts_at_any_size,
       two_persons_side_by_side_that_touch_are_two, four_in_a_row_are_four,
       a_person_cut_in_two_by_a_lamp_post_or_a_belt_is_one,
       a_partly_occluded_person_is_found_by_the_visible_part, specks_and_small_animals_are_no_persons,
       a_person_whose_feet_are_below_the_picture_is_placed_below_it,
       a_person_at_the_left_border_may_be_half_outside, a_larger_picture_gives_the_same_people_larger,
       without_a_known_height_no_person_is_found, a_second_call_gives_the_same_and_allocates_nothing});
}
