// SPDX-License-Identifier: LGPL-2.1-or-later
// Boxes around drawn people, whose pixels are known.
#include "vision/detection/person_box.h"

#include <cmath>
#include <utility>
#include <vector>

#include "support/bodies.h"
#include "support/suite.h"
#include "vision/geometry/box_edge.h"

using namespace cerberus::vision;
namespace tests = cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
constexpr Bounds kAll{0, 0, 320, 240};

// A person of 100 pixels at (160, 200), whose expected box is 143..177 by the measured proportion.
const Box kExpected{143, 100, 34, 100};

struct Picture {
  Image<std::uint8_t> mask{kSize},
      difference;  // difference: of no size, so not known, until something changes
  BitMask bits;

  Picture() { bits.resize(bit_mask_size(kSize)); }
  void fill(double left, double top, double right, double bottom) {
    tests::fill(mask.view(), left, top, right, bottom);
  }
  // Differs from the frame before there, and nowhere else.
  void change(double left, double top, double right, double bottom) {
    if (difference.view().empty()) difference = Image<std::uint8_t>(kSize);
    tests::fill(difference.view(), left, top, right, bottom);
  }
  Box fit(const std::vector<Person>& people, std::size_t self = 0) {
    pack(mask.view(), bits.view());
    return fit_box(bits.view(), {difference.view(), 0}, kAll, self, people,
                   {.aspect = 0.34, .measured = 1, .rests = 0.3});
  }
};

void assert_box(const Box& box, double left, double top, double right, double bottom) {
  ck_assert_double_eq(box.x, left);
  ck_assert_double_eq(box.y, top);
  ck_assert_double_eq(box.right(), right);
  ck_assert_double_eq(box.bottom(), bottom);
}

}  // namespace

START_TEST(the_edges_are_those_of_the_pixels) {
  Picture picture;
  picture.fill(150, 104, 170, 197);
  assert_box(picture.fit({{kExpected, 1}}), 150, 104, 170, 197);
}
END_TEST

START_TEST(the_pixels_weigh_more_than_half_against_what_is_expected) {
  Picture picture;
  picture.fill(150, 104, 170, 197);
  pack(picture.mask.view(), picture.bits.view());
  const std::vector<Person> people{{kExpected, 1}};
  const Box box = fit_box(picture.bits.view(), {}, kAll, 0, people, {.aspect = 0.34, .measured = 0.6});
  ck_assert_double_eq_tol(box.x, 0.4 * 143 + 0.6 * 150, 1e-9);
  ck_assert_double_eq_tol(box.y, 0.4 * 100 + 0.6 * 104, 1e-9);
  ck_assert_double_eq_tol(box.right(), 0.4 * 177 + 0.6 * 170, 1e-9);
  ck_assert_double_eq_tol(box.bottom(), 0.4 * 200 + 0.6 * 197, 1e-9);
}
END_TEST

START_TEST(an_outstretched_hand_and_a_shadow_beside_the_feet_do_not_widen_the_box) {
  Picture picture;
  picture.fill(150, 100, 170, 200);
  picture.fill(170, 130, 190, 140);  // a hand, 10 rows
  picture.fill(110, 190, 150, 200);  // a shadow
  const Box box = picture.fit({{kExpected, 1}});
  ck_assert_double_eq(box.x, 150);
  ck_assert_double_eq(box.right(), 170);
}
END_TEST

START_TEST(a_stride_widens_the_box) {
  Picture picture;
  picture.fill(150, 100, 170, 160);
  picture.fill(135, 160, 150, 200);  // 25 rows of the leg count, at least 18 are asked
  const Box box = picture.fit({{kExpected, 1}});
  ck_assert_double_eq(box.x, 135);
  ck_assert_double_eq(box.right(), 170);
}
END_TEST

// The place that a walker has left is foreground beside him where he stood when the scene began: it rests.
START_TEST(the_place_that_a_walker_has_left_does_not_widen_the_box) {
  for (const bool right : {false, true}) {
    Picture picture;
    picture.fill(145, 100, 175, 200);
    picture.change(145, 100, 175, 200);
    right ? picture.fill(175, 100, 190, 200) : picture.fill(130, 100, 145, 200);
    assert_box(picture.fit({{kExpected, 1}}), 145, 100, 175, 200);
  }
}
END_TEST

// Three pixels of each edge change, not what is between them: an even coat.
START_TEST(what_rests_between_the_edges_of_a_walker_is_his) {
  Picture picture;
  picture.fill(145, 100, 190, 200);
  picture.change(145, 100, 148, 200);
  picture.change(172, 100, 175, 200);
  assert_box(picture.fit({{kExpected, 1}}), 145, 100, 175, 200);
}
END_TEST

// Of the 80 rows that count at least .3 must change: 24.
START_TEST(a_column_of_which_a_third_changes_is_his) {
  for (const int changes : {24, 23}) {
    Picture picture;
    picture.fill(145, 100, 185, 200);
    picture.change(145, 100, 175, 200);
    picture.change(175, 110, 185, 110 + changes);
    ck_assert_double_eq(picture.fit({{kExpected, 1}}).right(), changes == 24 ? 185 : 175);
  }
}
END_TEST

START_TEST(a_person_who_stands_keeps_his_sides) {
  for (const bool stirs : {false, true}) {
    Picture picture;
    picture.fill(145, 100, 175, 200);
    picture.change(155, 110, 165, stirs ? 133 : 110);  // 230 of his 2400 pixels, less than a tenth
    assert_box(picture.fit({{kExpected, 1}}), 145, 100, 175, 200);
  }
}
END_TEST

START_TEST(where_only_the_middle_differs_the_trunk_is_left) {
  Picture picture;
  picture.fill(140, 100, 180, 200);
  picture.change(155, 100, 165, 200);
  const Box box = picture.fit({{kExpected, 1}});
  ck_assert_double_eq(box.x, 150);
  ck_assert_double_eq(box.right(), 170);
}
END_TEST

// A shadow of 16 rows around the feet, which are in its middle.
START_TEST(the_feet_are_in_the_middle_of_the_shadow_around_them) {
  Picture picture;
  picture.fill(150, 100, 170, 200);
  picture.fill(135, 192, 185, 208);
  ck_assert_double_eq(picture.fit({{kExpected, 1}}).bottom(), 200);
}
END_TEST

START_TEST(feet_without_a_shadow_are_where_the_pixels_end) {
  Picture picture;
  picture.fill(150, 100, 170, 160);
  picture.fill(150, 160, 156, 203);
  picture.fill(164, 160, 170, 203);
  ck_assert_double_eq(picture.fit({{kExpected, 1}}).bottom(), 203);
}
END_TEST

START_TEST(a_head_that_is_not_where_it_is_expected_is_found_near_by) {
  for (const double top : {90, 96, 100, 112}) {
    Picture picture;
    picture.fill(155, top, 165, 130);
    picture.fill(150, 120, 170, 200);
    ck_assert_double_eq(picture.fit({{kExpected, 1}}).y, top);
  }
}
END_TEST

// Two persons 20 pixels apart: the pixels between them belong to the nearer axis.
START_TEST(pixels_belong_to_the_nearer_of_two_persons) {
  Picture picture;
  picture.fill(150, 100, 190, 200);
  const std::vector<Person> people{{kExpected, 1}, {{163, 100, 34, 100}, 1}};
  const Box left = picture.fit(people, 0), right = picture.fit(people, 1);
  ck_assert_double_eq(left.x, 150);
  ck_assert_double_eq_tol(left.right(), 170, 1.5);
  ck_assert_double_eq_tol(right.x, 170, 1.5);
  ck_assert_double_eq(right.right(), 190);
}
END_TEST

START_TEST(a_person_without_pixels_or_outside_the_picture_keeps_a_finite_box) {
  Picture picture;
  const Box none = picture.fit({{kExpected, 1}});
  ck_assert_double_gt(none.width, 0);
  for (const Box& b :
       {Box{-60, 100, 34, 100}, Box{340, 100, 34, 100}, Box{143, 230, 34, 100}, Box{143, -90, 34, 100}}) {
    const Box box = picture.fit({{b, 1}});
    ck_assert(box.width > 0 && box.height > 0);
  }
}
END_TEST

// Of a person whose axis is outside the picture a tenth changes, and no column does enough.
START_TEST(a_person_whose_axis_is_outside_keeps_a_finite_box) {
  for (const double x : {-32.0, 318.0}) {
    Picture picture;
    picture.fill(0, 100, 320, 200);
    picture.change(0, 100, 320, 120);
    const Box box = picture.fit({{{x, 100, 34, 100}, 1}});
    ck_assert(std::isfinite(box.x) && box.width >= 0 && box.width < 100);
  }
}
END_TEST

// Of a person of 100 pixels the head is 13 rows high and 13 columns wide; beside it are 11 columns on both sides.
START_TEST(a_head_is_free_where_at_most_a_quarter_of_what_is_beside_it_is_foreground) {
  for (const int covered : {0, 5, 6, 11}) {
    Picture picture;
    picture.fill(153, 100, 167, 113);
    picture.fill(143, 113, 177, 200);
    picture.fill(168, 100, 168 + covered, 113);
    pack(picture.mask.view(), picture.bits.view());
    ck_assert_msg(has_free_head(picture.bits.view(), kSize, kExpected) == (covered <= 5), "%d", covered);
  }
}
END_TEST

START_TEST(a_body_without_foreground_where_its_head_should_be_has_none) {
  Picture picture;
  picture.fill(143, 108, 177, 200);
  pack(picture.mask.view(), picture.bits.view());
  ck_assert(!has_free_head(picture.bits.view(), kSize, kExpected));
  ck_assert(!has_free_head(picture.bits.view(), kSize, {143, -5, 34, 100}));  // cut by the picture's edge
}
END_TEST

// At an analysed pixel of 2 frame pixels. A box of few pixels keeps most of itself, and one that the frame cuts off its
// side there.
START_TEST(a_published_box_is_without_the_edge_that_the_blur_adds) {
  const BoxEdgeParameters edge{.blur = 0.4, .most = 0.1};
  const Box large = without_edge({10, 20, 30, 40}, 2, kSize, edge),
            little = without_edge({1, 1, 2, 4}, 2, kSize, edge),
            cut = without_edge({0, 200, 320, 40}, 2, kSize, edge);
  for (const auto& [is, should] : {std::pair{large, Box{10.8, 20.8, 28.4, 38.4}},
                                   {little, {1.2, 1.4, 1.6, 3.2}},
                                   {cut, {0, 200.8, 320, 39.2}}}) {
    ck_assert_double_eq_tol(is.x, should.x, 1e-9);
    ck_assert_double_eq_tol(is.y, should.y, 1e-9);
    ck_assert_double_eq_tol(is.width, should.width, 1e-9);
    ck_assert_double_eq_tol(is.height, should.height, 1e-9);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "person_box",
      {the_edges_are_those_of_the_pixels, the_pixels_weigh_more_than_half_against_what_is_expected,
       an_outstretched_hand_and_a_shadow_beside_the_feet_do_not_widen_the_box, a_stride_widens_the_box,
       the_place_that_a_walker_has_left_does_not_widen_the_box,
       what_rests_between_the_edges_of_a_walker_is_his, a_column_of_which_a_third_changes_is_his,
       a_person_who_stands_keeps_his_sides, where_only_the_middle_differs_the_trunk_is_left,
       the_feet_are_in_the_middle_of_the_shadow_around_them, feet_without_a_shadow_are_where_the_pixels_end,
       a_head_that_is_not_where_it_is_expected_is_found_near_by, pixels_belong_to_the_nearer_of_two_persons,
       a_person_without_pixels_or_outside_the_picture_keeps_a_finite_box,
       a_person_whose_axis_is_outside_keeps_a_finite_box,
       a_head_is_free_where_at_most_a_quarter_of_what_is_beside_it_is_foreground,
       a_body_without_foreground_where_its_head_should_be_has_none,
       a_published_box_is_without_the_edge_that_the_blur_adds});
}
