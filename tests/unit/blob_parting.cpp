// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/blob_parting.h"

#include <utility>
#include <vector>

#include "support/allocations.h"
#include "support/bodies.h"
#include "support/masks.h"
#include "support/suite.h"

using namespace cerberus::vision;
namespace tests = cerberus::tests;

namespace {

constexpr Size kSize{320, 240};
constexpr int kFloor = 200;  // row of the feet

struct Columns {
  int from = 0, to = 0;
};

struct Scene {
  Image<std::uint8_t> moving{kSize}, closed{kSize};
  Columns resting;
  Labeller labeller;
  BlobParting parting;
  bool parted = false;

  Scene() {
    moving.fill_bytes(0);
    closed.fill_bytes(0);
    parting.preallocate(kSize.width);
  }
  // Foreground, and what closing adds to it.
  void fill(int left, int top, int right, int bottom) {
    tests::fill(moving.view(), left, top, right, bottom);
    bridge(left, top, right, bottom);
  }
  void bridge(int left, int top, int right, int bottom) {
    tests::fill(closed.view(), left, top, right, bottom);
  }
  void person(int middle, int height) {
    tests::draw_body(moving.view(), middle, kFloor, height);
    tests::draw_body(closed.view(), middle, kFloor, height);
    bridge(middle - height / 8, kFloor - height / 2, middle + height / 8, kFloor);  // between the legs
  }
  // The components after parting.
  std::vector<Component> part() {
    const BitMask foreground = tests::packed(moving.view());
    BitMask blobs = tests::packed(closed.view());
    Image<std::uint8_t> difference(kSize);
    difference.fill_bytes(40);
    tests::fill(difference.view(), resting.from, 0, resting.to, kSize.height, 20);
    labeller.find(blobs.view(), kSize.width);
    const auto found = labeller.components();
    for (std::size_t i = 0; i < found.size(); ++i)
      parted |= parting.part(found[i], i, labeller.runs(), foreground.view(), {difference.view(), 30},
                             blobs.view());
    const auto parts = labeller.find(blobs.view(), kSize.width);
    return {parts.begin(), parts.end()};
  }
};

void check_columns(const Component& c, int left, int right) {
  ck_assert_int_eq(c.left, left);
  ck_assert_int_eq(c.right, right);
}

}  // namespace

// 100 pixels tall and 36 wide. A shadow of 5 rows lies between them; closing bridges 20 more.
START_TEST(people_whom_a_shadow_joins_are_parted_where_there_is_only_the_shadow) {
  Scene s;
  for (int middle : {60, 110, 160}) s.person(middle, 100);
  s.fill(60, 195, 160, kFloor);
  s.bridge(60, 175, 160, kFloor);
  const auto people = s.part();
  ck_assert(s.parted);
  ck_assert_uint_eq(people.size(), 3);
  check_columns(people[0], 42, 78);
  check_columns(people[1], 92, 128);
  check_columns(people[2], 142, 178);
}
END_TEST

// The emptiest columns are cleared, not all of the valley: a foot of 7 rows that is stretched out stays its person's.
START_TEST(a_valley_is_cut_where_it_is_emptiest) {
  Scene s;
  s.person(60, 100);
  s.person(130, 100);
  s.fill(60, 193, 92, kFloor);
  s.fill(92, 198, 130, kFloor);
  const auto people = s.part();
  ck_assert_uint_eq(people.size(), 2);
  check_columns(people[0], 42, 92);
  check_columns(people[1], 112, 148);
}
END_TEST

// Somebody farther away is half as high; a third is a dog, whose columns are too low for a trunk.
START_TEST(somebody_of_half_the_height_is_parted_and_a_dog_is_not) {
  for (const auto& [height, count] : {std::pair{55, 2u}, {33, 1u}}) {
    Scene s;
    s.person(60, 100);
    s.person(120, height);
    s.fill(60, 195, 120, kFloor);
    ck_assert_uint_eq(s.part().size(), count);
    ck_assert_int_eq(s.parted, count == 2);
  }
}
END_TEST

START_TEST(what_is_joined_by_more_than_a_shadow_is_not_parted) {
  Scene arms, car, far;
  arms.person(60, 100);
  arms.person(110, 100);
  arms.fill(60, 140, 110, 148);
  car.fill(40, 150, 200, kFloor);
  far.person(60, 39);
  far.person(90, 39);
  far.fill(60, 199, 90, kFloor);
  for (Scene* s : {&arms, &car, &far}) {
    ck_assert_uint_eq(s->part().size(), 1);
    ck_assert(!s->parted);
  }
}
END_TEST

// Of three people one is the place that somebody left, which looks like a person and rests.
START_TEST(the_place_that_a_person_left_stays_with_a_neighbour) {
  for (const auto& [place, right] :
       {std::pair{Columns{0, 85}, 128}, {Columns{85, 135}, 128}, {Columns{135, 320}, 78}}) {
    Scene s;
    for (int middle : {60, 110, 160}) s.person(middle, 100);
    s.fill(60, 195, 160, kFloor);
    s.resting = place;
    const auto found = s.part();
    ck_assert_uint_eq(found.size(), 2);
    check_columns(found[0], 42, right);
  }
}
END_TEST

// Of one of them so many columns change: less or more than .35 of the foreground.
START_TEST(what_changes_in_a_third_of_its_pixels_is_parted) {
  for (const auto& [changing, count] : {std::pair{12, 1u}, {25, 2u}}) {
    Scene s;
    s.person(60, 100);
    s.person(130, 100);
    s.fill(60, 198, 130, kFloor);
    s.resting = {42 + changing, 90};
    ck_assert_uint_eq(s.part().size(), count);
  }
}
END_TEST

// The middle one of three rests. It joins the neighbour to whom more of a shadow leads: 5 rows against 2.
START_TEST(what_rests_joins_the_neighbour_across_the_fuller_valley) {
  for (const bool left : {true, false}) {
    Scene s;
    for (int middle : {60, 110, 160}) s.person(middle, 100);
    s.fill(60, left ? 195 : 198, 110, kFloor);
    s.fill(110, left ? 198 : 195, 160, kFloor);
    s.resting = {85, 135};
    const auto found = s.part();
    ck_assert_uint_eq(found.size(), 2);
    check_columns(found[0], 42, left ? 128 : 78);
  }
}
END_TEST

// A flag above the shadow between two people, as high as their trunks, is a blob of its own: neither cut nor counted.
START_TEST(only_the_blob_that_is_parted_is_counted_and_cut) {
  Scene s;
  s.person(60, 100);
  s.person(160, 100);
  s.fill(60, 196, 160, kFloor);
  s.fill(90, 110, 130, 170);
  const auto found = s.part();
  ck_assert(s.parted);
  ck_assert_uint_eq(found.size(), 3);
  ck_assert_int_eq(found[2].area, 40 * 60);
}
END_TEST

START_TEST(no_blob_takes_memory) {
  Scene s;
  for (int middle : {60, 110, 160}) s.person(middle, 100);
  s.fill(60, 195, 160, kFloor);
  const BitMask foreground = tests::packed(s.moving.view());
  BitMask blobs = tests::packed(s.closed.view());
  s.labeller.find(blobs.view(), kSize.width);
  const std::size_t bytes = s.parting.bytes();
  const std::size_t before = tests::allocations();
  ck_assert(
      s.parting.part(s.labeller.components()[0], 0, s.labeller.runs(), foreground.view(), {}, blobs.view()));
  ck_assert_uint_eq(tests::allocations(), before);
  ck_assert_uint_eq(s.parting.bytes(), bytes);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "blob_parting",
      {people_whom_a_shadow_joins_are_parted_where_there_is_only_the_shadow,
       a_valley_is_cut_where_it_is_emptiest, somebody_of_half_the_height_is_parted_and_a_dog_is_not,
       what_is_joined_by_more_than_a_shadow_is_not_parted,
       the_place_that_a_person_left_stays_with_a_neighbour, what_changes_in_a_third_of_its_pixels_is_parted,
       what_rests_joins_the_neighbour_across_the_fuller_valley,
       only_the_blob_that_is_parted_is_counted_and_cut, no_blob_takes_memory});
}
