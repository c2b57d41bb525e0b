// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/regions.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "support/allocations.h"
#include "support/bodies.h"
#include "support/suite.h"

using namespace cerberus::vision;
namespace tests = cerberus::tests;

namespace {

constexpr Size kSize{320, 240};

struct Picture {
  Image<std::uint8_t> mask{kSize};
  Image<std::uint16_t> labels{kSize};

  void clear() { mask.fill_bytes(0); }
  void fill(double left, double top, double right, double bottom) {
    tests::fill(mask.view(), left, top, right, bottom);
  }
  // A person is a quarter as tall as the row of its feet.
  Box person(double middle, double foot) { return tests::draw_body(mask.view(), middle, foot, foot / 4); }
  // As tall as people at its place, rounded, with windows that do not move and wheels.
  void car(double middle, double bottom) {
    const double h = bottom / 4, w = 3 * h;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double u = (x + 0.5 - middle) / (w / 2), v = (y + 0.5 - (bottom - h / 2)) / (h / 2);
        const bool window = std::abs(u) < 0.35 && std::abs(v + 0.5) < 0.15;
        if (std::pow(std::abs(u), 3) + std::pow(std::abs(v), 3) < 1 && !window) mask.view().at(x, y) = 255;
      }
  }
  std::span<const Region> find(RegionFinder& finder, const Transform& motion = {}) {
    return finder.update(mask.view(), labels.view(), motion);
  }
  // Where only this rectangle differs from the frame before.
  std::span<const Region> find_changing(RegionFinder& finder, double left, double top, double right,
                                        double bottom) {
    Image<std::uint8_t> difference(kSize);
    difference.fill_bytes(0);
    tests::fill(difference.view(), left, top, right, bottom, 40);
    return finder.update(mask.view(), {}, {}, {difference.view(), 30});
  }
  long count() const {
    long n = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) n += mask.view().at(x, y) != 0;
    return n;
  }
};

// Single people walk by at several distances, until the finder knows how tall they are.
void let_people_walk_by(RegionFinder& finder) {
  Picture picture;
  for (int k = 0; k < 60; ++k) {
    picture.clear();
    picture.person(30 + 4 * k, 110);
    picture.person(290 - 4 * k, 170);
    picture.person(60 + 3 * k, 230);
    picture.find(finder);
  }
}

// A finder past the first frames of a scene, in which nothing has been seen yet.
RegionFinder settled() {
  RegionFinder finder;
  Picture picture;
  for (int k = 0; k < 60; ++k) picture.find(finder);
  return finder;
}

int matched(std::span<const Region> regions, const std::vector<Box>& expected, double least) {
  int n = 0;
  for (const Box& e : expected)
    n += std::any_of(regions.begin(), regions.end(),
                     [&](const Region& r) { return intersection_over_union(r.box, e) >= least; });
  return n;
}

}  // namespace

START_TEST(overlap_of_boxes_as_computed_by_hand) {
  const Box a{0, 0, 4, 2};
  ck_assert_double_eq_tol(intersection_over_union(a, a), 1, 1e-12);
  ck_assert_double_eq_tol(intersection_over_union(a, {2, 1, 4, 2}), 2.0 / 14, 1e-12);
  ck_assert_double_eq(intersection_over_union(a, {4, 0, 1, 1}), 0);
  ck_assert_double_eq(intersection_over_union({}, {}), 0);
}
END_TEST

START_TEST(nothing_moving_gives_no_region_and_an_empty_label_picture) {
  RegionFinder finder;
  Picture picture;
  picture.labels.fill_bytes(0xff);
  ck_assert_uint_eq(picture.find(finder).size(), 0);
  ck_assert_int_eq(picture.labels.view().at(160, 120), 0);
}
END_TEST

START_TEST(before_anything_is_known_components_are_regions_with_box_area_and_label) {
  RegionFinder finder = settled();
  Picture picture;
  picture.fill(20, 30, 40, 60);
  picture.fill(200, 100, 260, 130);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 2);
  ck_assert_double_eq(regions[0].box.x, 20);
  ck_assert_double_eq(regions[0].box.y, 30);
  ck_assert_double_eq(regions[0].box.width, 20);
  ck_assert_double_eq(regions[0].box.height, 30);
  ck_assert_double_eq(regions[0].area, 600);
  ck_assert(!is_person_like(regions[0]));
  ck_assert_int_eq(regions[0].label, 1);
  ck_assert_int_eq(picture.labels.view().at(25, 35), 1);
  ck_assert_int_eq(picture.labels.view().at(230, 110), 2);
}
END_TEST

START_TEST(in_the_first_frames_of_a_scene_a_box_takes_in_both_sides_of_its_edge) {
  const auto assert_box = [](RegionFinder& finder, double rim) {
    Picture picture;
    picture.fill(20, 30, 40, 60);
    picture.fill(310, 0, 320, 30);  // in a corner: nothing beyond the picture
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 2);
    const Box &corner = regions[0].box, &box = regions[1].box;
    ck_assert_double_eq(box.x, 20 - rim);
    ck_assert_double_eq(box.y, 30 - rim);
    ck_assert_double_eq(box.right(), 40 + rim);
    ck_assert_double_eq(box.bottom(), 60 + rim);
    ck_assert_double_eq(corner.x, 310 - rim);
    ck_assert_double_eq(corner.y, 0);
    ck_assert_double_eq(corner.right(), 320);
    ck_assert_double_eq(corner.bottom(), 30 + rim);
    ck_assert_double_eq(regions[1].area, 600);
    ck_assert_int_eq(picture.count(), 900);  // the mask is what moves, no more
  };
  RegionFinder finder;
  for (int k = 0; k < 60; ++k) assert_box(finder, 2);
  assert_box(finder, 0);
  finder.reset();
  assert_box(finder, 2);
  RegionFinder plain;
  plain.set_options({.people = false});
  assert_box(plain, 0);
}
END_TEST

START_TEST(the_mask_comes_back_closed_and_without_specks) {
  RegionFinder finder;
  Picture picture;
  picture.fill(20, 30, 40, 60);
  picture.fill(44, 30, 64, 60);      // a gap of 4 columns closes
  picture.fill(200, 100, 203, 103);  // 9 pixels: a speck
  picture.find(finder);
  ck_assert_int_eq(picture.mask.view().at(42, 45), 255);
  ck_assert_int_eq(picture.mask.view().at(201, 101), 0);
  ck_assert_int_eq(picture.count(), 44 * 30);
}
END_TEST

START_TEST(a_low_shadow_on_the_floor_is_not_part_of_the_box) {
  RegionFinder finder = settled();
  Picture picture;
  picture.fill(100, 60, 115, 110);
  picture.fill(70, 105, 100, 110);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_eq_tol(regions[0].box.x, 100, 4);
  ck_assert_double_eq(regions[0].box.right(), 115);
}
END_TEST

// A trunk of 15 x 80 pixels. The arm is 6 rows thick, 36 columns long and at half height.
START_TEST(an_outstretched_arm_is_part_of_the_box_and_a_swaying_tape_is_not) {
  for (const bool tape : {false, true}) {
    RegionFinder finder = settled();
    Picture picture;
    picture.fill(100, 60, 115, 140);
    for (int x = 115; x < 151; x += tape ? 4 : 1) picture.fill(x, 90, x + 1, 96);
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert_double_eq(regions[0].box.x, 100);
    ck_assert_double_eq(regions[0].box.right(), tape ? 116 : 151);
  }
}
END_TEST

// A trunk of 15 x 80 pixels and a leg of 8 rows that falls by a row a column, or a shadow of as many rows on the floor. At
// half the size the leg is too thin to be told from a shadow.
START_TEST(a_leg_in_stride_is_part_of_the_box_on_either_side_and_a_flat_shadow_is_not) {
  for (const bool mirrored : {false, true})
    for (const bool leg : {true, false})
      for (const bool small : {false, true}) {
        RegionFinder finder = settled();
        Picture picture;
        const double scale = small ? 0.5 : 1;
        const auto fill = [&](double left, double top, double right, double bottom) {
          if (mirrored) left = -std::exchange(right, -left);
          picture.fill(160 + scale * left, 100 + scale * top, 160 + scale * right, 100 + scale * bottom);
        };
        fill(0, -80, 15, 0);
        for (int k = 0; k < 28; ++k) fill(15 + k, leg ? k - 32 : -8, 16 + k, leg ? k - 24 : 0);
        const auto regions = picture.find(finder);
        ck_assert_uint_eq(regions.size(), 1);
        const Box& box = regions[0].box;
        const double reach = mirrored ? 160 - box.x : box.right() - 160;
        if (leg && !small)
          ck_assert_double_ge(reach, 38);
        else
          ck_assert_double_le(reach, scale * 20);
      }
}
END_TEST

// As high as a knee at the trunk, and a quarter of a row lower with every column.
START_TEST(a_shadow_that_tapers_is_no_leg) {
  RegionFinder finder = settled();
  Picture picture;
  picture.fill(160, 20, 175, 100);
  for (int k = 0; k < 28; ++k) picture.fill(175 + k, 80 + k / 4, 176 + k, 100);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_le(regions[0].box.right(), 180);
}
END_TEST

START_TEST(two_people_arm_in_arm_are_one_region_before_and_two_after_people_were_seen) {
  RegionFinder finder;
  Picture picture;
  std::vector<Box> pair = {picture.person(150, 170), picture.person(163, 171)};
  ck_assert_uint_eq(picture.find(finder).size(), 1);
  let_people_walk_by(finder);
  picture.clear();
  pair = {picture.person(150, 170), picture.person(163, 171)};
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 2);
  ck_assert_int_eq(matched(regions, pair, 0.6), 2);
  for (const Region& r : regions) ck_assert(is_person_like(r));
}
END_TEST

// The first blob of a scene. At row 200 a person is 50 pixels tall.
START_TEST(two_people_whose_heads_are_seen_are_two_once_they_have_walked) {
  RegionFinder finder = settled();
  for (int k = 0; k < 5; ++k) {
    Picture picture;
    const std::vector<Box> pair = {picture.person(150 + 4 * k, 200), picture.person(167 + 4 * k, 201)};
    const auto regions = picture.find(finder);
    if (k < 2) {
      ck_assert_uint_eq(regions.size(), 1);
      ck_assert(regions[0].kind == RegionKind::group);
      continue;
    }
    ck_assert_uint_eq(regions.size(), 2);
    ck_assert_int_eq(matched(regions, pair, 0.6), 2);
    for (const Region& r : regions) ck_assert(is_person_like(r));
  }
}
END_TEST

// Their shadows lie on the floor between them, 3 pixels high, and closing bridges the gap of 8 columns above these.
START_TEST(two_people_whom_only_their_shadow_joins_are_two_from_the_first_frame) {
  RegionFinder finder = settled();
  Picture picture;
  const std::vector<Box> pair = {picture.person(150, 200), picture.person(176, 200)};
  picture.fill(150, 197, 176, 200);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 2);
  ck_assert_int_eq(matched(regions, pair, 0.9), 2);
}
END_TEST

// He walks, at row 200 and 50 pixels tall. In an even coat only the two columns that he comes into differ from the frame before. Where nothing does, it is the place
// that somebody has left, in which bodies are found here and there.
START_TEST(who_has_walked_a_seventh_of_his_height_is_a_person_unless_all_of_him_rests) {
  for (const int columns : {0, 2}) {
    RegionFinder finder = settled();
    for (int k = 0; k < 8; ++k) {
      Picture picture;
      const Box walker = picture.person(100 + 2 * k, 200);
      const auto regions =
          picture.find_changing(finder, walker.right() - columns, walker.y, walker.right(), walker.bottom());
      ck_assert_uint_eq(regions.size(), 1);
      ck_assert_int_eq(is_person_like(regions[0]), columns == 2 && 2 * k > 0.15 * walker.height);
    }
  }
}
END_TEST

START_TEST(two_people_who_stand_are_a_group_before_any_height_is_known) {
  RegionFinder finder = settled();
  for (int k = 0; k < 5; ++k) {
    Picture picture;
    picture.person(150, 200);
    picture.person(167, 201);
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert(regions[0].kind == RegionKind::group);
  }
}
END_TEST

// A wall of .4 of a person's height is pushed along, on either side: a person explains less than half of the blob.
START_TEST(one_person_with_something_much_larger_is_a_group) {
  for (const double left : {156., 44.}) {
    RegionFinder finder = settled();
    let_people_walk_by(finder);
    Picture picture;
    picture.person(150, 200);
    picture.fill(left, 180, left + 100, 200);
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert(regions[0].kind == RegionKind::group);
  }
}
END_TEST

// Bodies up to a beam that hides all heads: several people or one thing, but no person, although they walk.
START_TEST(bodies_without_heads_are_a_group_and_a_car_is_a_thing_before_any_height_is_known) {
  RegionFinder finder = settled();
  for (int k = 0; k < 5; ++k) {
    Picture picture;
    for (const int middle : {120, 140, 160}) picture.person(middle + 4 * k, 220);
    picture.fill(110 + 4 * k, 165, 170 + 4 * k, 181);
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert(regions[0].kind == RegionKind::group);
  }
  finder = settled();
  for (int k = 0; k < 5; ++k) {
    Picture picture;
    picture.car(160 + 4 * k, 200);
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert(regions[0].kind == RegionKind::thing);
  }
}
END_TEST

START_TEST(a_region_s_area_is_the_foreground_in_its_box) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.person(150, 170);  // two persons that touch,
  picture.person(163, 171);
  picture.person(60, 230);           // one alone,
  picture.fill(240, 188, 258, 200);  // a dog
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 4);
  for (const Region& r : regions) {
    long moving = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double cx = x + 0.5, cy = y + 0.5;
        moving += picture.mask.view().at(x, y) && cx >= r.box.x && cx < r.box.right() && cy >= r.box.y &&
                  cy < r.box.bottom();
      }
    ck_assert_int_gt(moving, 100);
    ck_assert_double_eq(r.area, static_cast<double>(moving));
  }
}
END_TEST

START_TEST(head_and_legs_without_a_trunk_are_one_person_once_people_are_known) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  const Box box = picture.person(150, 200);
  for (int y = 160; y < 178; ++y)
    for (int x = 0; x < 320; ++x) picture.mask.view().at(x, y) = 0;
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_int_eq(matched(regions, {box}, 0.5), 1);  // its sides are those of the legs
}
END_TEST

START_TEST(a_person_cut_in_pieces_by_a_lamp_post_and_a_belt_is_one) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  const Box box = picture.person(150, 200);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x)
      if ((y >= 170 && y < 178) || (x >= 148 && x < 152)) picture.mask.view().at(x, y) = 0;
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_int_eq(matched(regions, {box}, 0.6), 1);
  ck_assert(is_person_like(regions[0]));
}
END_TEST

// At row 200 a person is 50 pixels tall. The leg is 18 rows high: more than the skirt of a shadow.
START_TEST(a_person_who_lunges_is_boxed_with_the_leg_that_he_stretches_out) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.fill(140, 150, 158, 200);
  picture.fill(158, 182, 186, 200);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert(is_person_like(regions[0]));
  ck_assert_double_eq(regions[0].box.x, 140);
  ck_assert_double_eq(regions[0].box.y, 150);
  ck_assert_double_eq(regions[0].box.right(), 186);
  ck_assert_double_eq(regions[0].box.bottom(), 200);
}
END_TEST

// A body of 47 rows that ends at the calves, and below it two legs that are too far apart for one's feet.
START_TEST(a_walker_whose_body_fits_without_the_feet_is_boxed_with_them) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.person(150, 188);
  picture.fill(143, 186, 146, 199);
  picture.fill(154, 186, 157, 199);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert(is_person_like(regions[0]));
  ck_assert_double_eq(regions[0].box.bottom(), 199);
}
END_TEST

// The blob is 25 pixels taller than a person.
START_TEST(a_person_below_a_branch_that_sways_is_boxed_without_it) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  const Box box = picture.person(150, 200);
  picture.fill(156, 125, 160, 165);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert(is_person_like(regions[0]));
  ck_assert_double_ge(intersection_over_union(regions[0].box, box), 0.6);
}
END_TEST

START_TEST(a_car_among_people_is_not_cut_into_people_nor_lost) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.fill(60, 120, 220, 220);  // taller than two people are
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_eq(regions[0].box.width, 160);
  ck_assert(!is_person_like(regions[0]));
}
END_TEST

// No rectangle, so that boxes of people cut from it hold what does not move; it is recognised by its one outline. What
// is left of it at the border is as wide as two people, one after another.
START_TEST(a_round_car_as_tall_as_people_is_one_region_until_it_has_left) {
  for (const int step : {-4, 4}) {
    RegionFinder finder;
    let_people_walk_by(finder);
    const Box all{0, 0, static_cast<double>(kSize.width), static_cast<double>(kSize.height)};
    for (double middle = 160; middle > -70 && middle < 390; middle += step) {
      Picture picture;
      picture.car(middle, 170);
      const auto regions = picture.find(finder);
      const Box car{middle - 64, 127.5, 127.5, 42.5};
      const double seen = overlap_area(car, all) / car.height;
      ck_assert_uint_le(regions.size(), 1);
      if (seen < 45) continue;
      ck_assert_uint_eq(regions.size(), 1);
      ck_assert(!is_person_like(regions[0]));
      ck_assert_double_eq_tol(regions[0].box.width, seen, 6);
    }
  }
}
END_TEST

START_TEST(a_solid_block_three_bodies_wide_is_no_people) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.fill(100, 128, 146, 170);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_eq(regions[0].box.width, 46);
}
END_TEST

START_TEST(two_people_are_two_where_a_car_left_a_frame_before_the_last) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  for (const double middle : {230, 255, 280, 305, 330, 350}) {
    picture.clear();
    picture.car(middle, 170);
    ck_assert_uint_eq(picture.find(finder).size(), 1);
  }
  picture.clear();
  ck_assert_uint_eq(picture.find(finder).size(), 0);
  const std::vector<Box> pair = {picture.person(296, 170), picture.person(311, 170)};
  picture.fill(290, 140, 318, 170);  // in coats: hardly a gap
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 2);
  ck_assert_int_eq(matched(regions, pair, 0.6), 2);
}
END_TEST

START_TEST(a_row_of_people_is_no_block_not_even_where_one_was) {
  RegionFinder finder;
  let_people_walk_by(finder);
  std::vector<Box> row;
  for (const bool car : {true, false}) {
    Picture picture;
    if (car) picture.car(160, 170);
    for (int i = 0; !car && i < 7; ++i) row.push_back(picture.person(112 + 16 * i, 170 + i % 2));
    const auto regions = picture.find(finder);
    ck_assert_uint_eq(regions.size(), car ? 1 : 7);
    ck_assert_int_eq(matched(regions, row, 0.6), car ? 0 : 7);
  }
}
END_TEST

START_TEST(a_dog_among_people_is_a_small_region) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.fill(100, 188, 118, 200);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_eq_tol(regions[0].box.width, 18, 1);
  ck_assert_double_eq_tol(regions[0].box.height, 12, 1);
}
END_TEST

START_TEST(blobs_that_never_walk_teach_no_height) {
  RegionFinder finder;
  Picture picture;
  for (int k = 0; k < 100; ++k) {
    picture.clear();
    picture.person(100, 170);
    picture.person(200, 120);
    picture.find(finder);
  }
  picture.clear();
  picture.person(150, 170);
  picture.person(163, 171);
  ck_assert_uint_eq(picture.find(finder).size(), 1);
}
END_TEST

// Two people arm in arm, of whom the picture shows 100 rows: all, or what is not cut off below.
START_TEST(people_whom_the_picture_cuts_off_below_teach_no_height) {
  for (const double height : {140.0, 100.0}) {
    RegionFinder finder = settled();
    Picture picture;
    for (int k = 0; k < 40; ++k) {
      picture.clear();
      for (const double beside : {0.0, .34 * height})
        tests::draw_body(picture.mask.view(), 50 + 4 * k + beside, height > 100 ? 280 : 228, height);
      picture.find(finder);
    }
    picture.clear();
    for (const double beside : {0.0, 34.0}) tests::draw_body(picture.mask.view(), 120 + beside, 228, 100);
    ck_assert_uint_eq(picture.find(finder).size(), height > 100 ? 1 : 2);
  }
}
END_TEST

// A walker is a sample of the height prior from its third frame on, and the prior answers from the tenth sample on: in
// the twelfth frame the walker is known to be as tall as a person. 37 pixels tall: too small for the shape of a head.
START_TEST(a_walker_teaches_its_height_from_the_third_frame_on) {
  RegionFinder finder;
  for (int k = 1; k <= 16; ++k) {
    Picture picture;
    picture.person(60 + 6 * k, 150);
    const auto regions = picture.find(finder);
    if (k < 3) continue;
    ck_assert_uint_eq(regions.size(), 1);
    ck_assert_msg(is_person_like(regions[0]) == (k >= 12), "frame %d", k);
  }
}
END_TEST

START_TEST(people_off_and_reset_give_plain_components_again) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.person(150, 170);
  picture.person(166, 171);  // a column of background between them
  finder.set_options({.people = false});
  ck_assert_uint_eq(picture.find(finder).size(), 1);
  finder.set_options({});
  finder.reset();
  picture.clear();
  picture.person(150, 170);
  picture.person(163, 171);
  ck_assert_uint_eq(picture.find(finder).size(), 1);
}
END_TEST

START_TEST(the_learnt_heights_follow_a_tilting_camera) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  // The camera tilts down by 40 rows: feet at 170 are now at 130, as tall as before.
  for (int k = 0; k < 8; ++k) {
    picture.clear();
    picture.find(finder, Transform::translation(0, -5));
  }
  Picture upright;
  const Box a = upright.person(150, 170), b = upright.person(166, 171);
  picture.clear();
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 320; ++x) picture.mask.view().at(x, y) = upright.mask.view().at(x, y + 40);
  const auto regions = picture.find(finder, {});
  ck_assert_uint_eq(regions.size(), 2);
  ck_assert_int_eq(
      matched(regions, {{a.x, a.y - 40, a.width, a.height}, {b.x, b.y - 40, b.width, b.height}}, 0.6), 2);
}
END_TEST

// A picture of 160 x 120 has room for 75 components (one for 256 pixels) and for twice as many regions. 40 pairs, each
// one component, are 80 people.
START_TEST(more_people_than_components_fit_are_found_in_pairs) {
  constexpr Size kSmall{160, 120};
  constexpr double kTall = 14;
  Image<std::uint8_t> mask(kSmall);
  Image<std::uint16_t> labels(kSmall);
  RegionFinder finder;
  for (int k = 0; k < 60; ++k) {
    mask.fill_bytes(0);
    for (const int foot : {30, 70, 110}) tests::draw_body(mask.view(), 10 + 2 * k, foot, kTall);
    finder.update(mask.view(), labels.view(), {});
  }
  std::span<const Region> regions;
  for (int k = 0; k < 2; ++k) {
    mask.fill_bytes(0);
    for (int row = 0; row < 5; ++row)
      for (int column = 0; column < 8; ++column)
        for (const int side : {-3, 3})
          tests::draw_body(mask.view(), 10 + 20 * column + side, 18 + 20 * row, kTall);
    regions = finder.update(mask.view(), labels.view(), {});
  }
  ck_assert_uint_eq(regions.size(), 80);
}
END_TEST

START_TEST(a_mask_full_of_clutter_or_wholly_set_is_survived) {
  RegionFinder finder;
  let_people_walk_by(finder);
  Picture picture;
  picture.mask.fill_bytes(255);
  ck_assert_uint_le(picture.find(finder).size(), 1);
  // Specks everywhere, more than can be distinguished, around something that can: it stays, and what is kept agrees.
  finder.set_options({.closing = 1, .minimum_area = 1});
  picture.clear();
  for (int y = 0; y < 240; y += 2)
    for (int x = 0; x < 320; x += 2) picture.mask.view().at(x, y) = 255;
  picture.fill(101, 51, 140, 80);
  const auto regions = picture.find(finder);
  ck_assert_uint_eq(regions.size(), 1);
  ck_assert_double_eq(regions[0].area, 39 * 29);
  ck_assert_int_eq(picture.count(), 39 * 29);
  ck_assert_int_eq(picture.labels.view().at(120, 60), 1);
}
END_TEST

// The worst a picture can be: after the first one nothing is taken, whatever comes.
START_TEST(no_picture_takes_memory_after_the_first) {
  RegionFinder finder;
  Picture picture;
  std::size_t bytes = 0, before = 0;
  const auto look = [&](auto&& draw) {
    picture.clear();
    draw();
    picture.find(finder);
    ck_assert_uint_eq(cerberus::tests::allocations(), before);
    ck_assert_uint_eq(finder.bytes(), bytes);
  };
  picture.find(finder);
  bytes = finder.bytes();
  ck_assert_uint_le(bytes, 2 * kSize.area());
  before = cerberus::tests::allocations();
  // People whose bodies are 47 cells high, as many as there is room for: the largest grid, all candidates.
  for (int k = 0; k < 60; ++k)
    look([&] {
      picture.person(30 + 4 * k, 110);
      picture.person(290 - 4 * k, 170);
      picture.person(60 + 3 * k, 230);
    });
  look([&] {
    for (int i = 0; i < 22; ++i) picture.person(8 + 14 * i, 188 + i % 3);
  });
  // A crowd far away: many groups, several in each; then noise of every density, with and without clean-up.
  look([&] {
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 40; ++i) picture.person(4 + 8 * i, 80 + 20 * j);
  });
  std::uint32_t random = 1;
  for (const int closing : {1, 3, 9}) {
    finder.set_options({.closing = closing, .minimum_area = 1});
    for (unsigned percent = 1; percent <= 100; percent += 3)
      look([&] {
        for (int y = 0; y < kSize.height; ++y)
          for (int x = 0; x < kSize.width; ++x)
            picture.mask.view().at(x, y) =
                (random = random * 1664525u + 1013904223u) / 256 % 100 < percent ? 255 : 0;
      });
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "regions", {overlap_of_boxes_as_computed_by_hand,
                  nothing_moving_gives_no_region_and_an_empty_label_picture,
                  before_anything_is_known_components_are_regions_with_box_area_and_label,
                  in_the_first_frames_of_a_scene_a_box_takes_in_both_sides_of_its_edge,
                  the_mask_comes_back_closed_and_without_specks,
                  a_low_shadow_on_the_floor_is_not_part_of_the_box,
                  an_outstretched_arm_is_part_of_the_box_and_a_swaying_tape_is_not,
                  a_leg_in_stride_is_part_of_the_box_on_either_side_and_a_flat_shadow_is_not,
                  a_shadow_that_tapers_is_no_leg,
                  two_people_arm_in_arm_are_one_region_before_and_two_after_people_were_seen,
                  two_people_whose_heads_are_seen_are_two_once_they_have_walked,

                  who_has_walked_a_seventh_of_his_height_is_a_person_unless_all_of_him_rests,
                  two_people_whom_only_their_shadow_joins_are_two_from_the_first_frame,
                  two_people_who_stand_are_a_group_before_any_height_is_known,
                  one_person_with_something_much_larger_is_a_group,
                  bodies_without_heads_are_a_group_and_a_car_is_a_thing_before_any_height_is_known,
                  a_region_s_area_is_the_foreground_in_its_box,
                  head_and_legs_without_a_trunk_are_one_person_once_people_are_known,
                  a_person_cut_in_pieces_by_a_lamp_post_and_a_belt_is_one,
                  a_person_who_lunges_is_boxed_with_the_leg_that_he_stretches_out,
                  a_walker_whose_body_fits_without_the_feet_is_boxed_with_them,
                  a_person_below_a_branch_that_sways_is_boxed_without_it,
                  a_car_among_people_is_not_cut_into_people_nor_lost,
                  a_round_car_as_tall_as_people_is_one_region_until_it_has_left,
                  a_row_of_people_is_no_block_not_even_where_one_was,
                  a_solid_block_three_bodies_wide_is_no_people,
                  two_people_are_two_where_a_car_left_a_frame_before_the_last,
                  a_dog_among_people_is_a_small_region,
                  blobs_that_never_walk_teach_no_height,
                  people_whom_the_picture_cuts_off_below_teach_no_height,
                  a_walker_teaches_its_height_from_the_third_frame_on,
                  people_off_and_reset_give_plain_components_again,
                  the_learnt_heights_follow_a_tilting_camera,
                  more_people_than_components_fit_are_found_in_pairs,
                  a_mask_full_of_clutter_or_wholly_set_is_survived,
                  no_picture_takes_memory_after_the_first});
}
