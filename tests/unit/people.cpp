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

// Cells of several pixels, at whose edges the window need not begin: a body is placed to a cell, its feet to a cell
// and to the step by which other heights are tried. No pixel gains more than
// one of a trunk, by the definition of the score: ln(.85 / .13).
START_TEST(a_body_of_any_size_is_placed_to_a_cell) {
  for (int height = 60; height <= 200; height += 4) {
    Scene scene({640, 480}, 480.0 / height);
    PeopleFinder finder;
    const Box body = scene.draw(301, 460, std::round(460.0 * height / 480));
    const auto found = scene.find(finder);
    ck_assert_uint_eq(found.size(), 1);
    const double cell = std::ceil(body.height / 28);
    ck_assert_double_le(std::abs(found[0].box.x + found[0].box.width / 2 - 301), cell + 1);
    ck_assert_double_le(std::abs(found[0].box.bottom() - 460), cell + 0.08 * body.height + 1);
    ck_assert_double_gt(found[0].score, 0.7);
    ck_assert_double_lt(found[0].score, std::log(0.85 / 0.13));
  }
}
END_TEST

// At row 112 a person is 28 pixels tall, so that a cell is a pixel. The parts' proportions give, in rows and in columns
// on either side of the axis: head 4, core 2, reach 4; trunk 10, core 3, reach 5; legs 14, core 3, reach 5; and 2 rows of
// free space 2 columns to either side. Foreground: the head's and the trunk's core, all of the legs.
START_TEST(the_score_is_the_log_likelihood_ratio_a_pixel_of_the_body) {
  Scene scene;
  PeopleFinder finder;
  scene.fill(158, 84, 162, 88);
  scene.fill(157, 88, 163, 98);
  scene.fill(155, 98, 165, 112);
  const auto found = scene.find(finder);
  ck_assert_uint_eq(found.size(), 1);
  ck_assert_double_eq(found[0].box.x + found[0].box.width / 2, 160);
  ck_assert_double_eq(found[0].box.y, 84);
  ck_assert_double_eq(found[0].box.bottom(), 112);
  const double head = 16 * std::log(0.75 / 0.13) + 16 * std::log(0.95 / 0.87);
  const double trunk = 60 * std::log(0.75 / 0.13) + 40 * std::log(0.70 / 0.87);
  const double legs = 84 * std::log(0.65 / 0.13) + 56 * std::log(0.33 / 0.13);
  const double free_space = 8 * std::log(0.97 / 0.87);
  // Gains are rounded to 1/64.
  ck_assert_double_eq_tol(found[0].score, (head + trunk + legs + free_space) / (32 + 100 + 140), 0.01);
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

// The line is known from one row. Further down it expects more than the person has, and is uncertain by as much. The least
// gain is compared before the price of the height is taken off: otherwise nobody is found.
START_TEST(where_the_line_is_uncertain_a_height_may_differ_by_more) {
  for (const bool sure : {false, true}) {
    Scene scene;
    scene.prior.reset();
    for (int i = 0; i < 64; ++i) scene.prior.learn(sure ? 100 + 2 * (i % 50) : 150, sure ? 50 + i % 50 : 75);
    PeopleFinder finder;
    ck_assert_double_eq_tol(scene.prior.height(162), 81, 1);
    ck_assert((scene.prior.uncertainty(162) < 0.1) == sure);
    scene.draw(150, 162, 61);
    const auto found = scene.find(finder);
    ck_assert_uint_eq(found.size(), sure ? 0 : 1);
    if (!sure) ck_assert_double_lt(found[0].box.height, 70);  // .86 of what is expected
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
      {one_person_is_one_box_in_the_right_place, a_body_of_any_size_is_placed_to_a_cell,
       the_score_is_the_log_likelihood_ratio_a_pixel_of_the_body, two_persons_side_by_side_that_touch_are_two,
       where_the_line_is_uncertain_a_height_may_differ_by_more, four_in_a_row_are_four,
       a_partly_occluded_person_is_found_by_the_visible_part, specks_and_small_animals_are_no_persons,
       a_person_whose_feet_are_below_the_picture_is_placed_below_it,
       a_person_at_the_left_border_may_be_half_outside, a_larger_picture_gives_the_same_people_larger,
       a_second_call_gives_the_same_and_allocates_nothing});
}
