// SPDX-License-Identifier: LGPL-2.1-or-later
// What bench-patrol counts: of a picture of 320 x 240 whose half sees 30 degrees, 10 frames a second.
#include "bench/patrol_score.h"

#include <check.h>

#include <cmath>

#include "support/suite.h"

using namespace cerberus::bench;

namespace {

Subject person(int id, double x, double visible = 1, double bearing = 0) {
  return {{id, {x, 60, 40, 100}}, visible, bearing, true, true};
}
Found box(int id, double x) {
  return {{id, {x, 60, 40, 100}}};
}

}  // namespace

START_TEST(a_box_is_asked_for_once_half_of_a_person_is_visible) {
  PatrolScore score({320, 240}, 30);
  for (int n = 0; n < 40; ++n) {
    const double t = n * .1;
    std::vector<Found> found;
    if (n >= 25) found.push_back(box(7, 100));
    score.add({person(1, 100, n < 20 ? .4 : .6)}, found, t);
  }
  const PatrolFigures f = score.figures();
  ck_assert_double_eq_tol(f.found_after, .5, 1e-9);
  ck_assert_double_eq_tol(f.in_picture_after, 2, 1e-9);
  ck_assert_double_eq_tol(f.recall, .75, 1e-9);  // 15 of 20
  ck_assert_double_eq_tol(f.precision, 1, 1e-9);
  ck_assert_double_eq_tol(f.identities, 1, 1e-9);
}
END_TEST

START_TEST(a_box_on_somebody_who_does_not_count_is_neither_right_nor_wrong) {
  PatrolScore score({320, 240}, 30);
  for (int n = 0; n < 10; ++n)
    score.add({person(1, 100), person(2, 200, .3)}, {box(1, 100), box(2, 200)}, n * .1);
  const PatrolFigures f = score.figures();
  ck_assert_double_eq_tol(f.precision, 1, 1e-9);
  ck_assert_double_eq_tol(f.recall, 1, 1e-9);
  ck_assert_double_eq_tol(f.false_identities, 0, 1e-9);
}
END_TEST

START_TEST(a_box_beside_everybody_is_wrong_and_its_track_is_false) {
  PatrolScore score({320, 240}, 30);
  for (int n = 0; n < 10; ++n) {
    std::vector<Found> found{box(1, 100)};
    if (n % 2 == 0) found.push_back(box(10 + n, 260));  // five tracks
    score.add({person(1, 100)}, found, n * .1);
  }
  const PatrolFigures f = score.figures();
  ck_assert_double_eq_tol(f.precision, 10. / 15, 1e-9);
  ck_assert_double_eq_tol(f.false_identities, 5 * 60, 1e-6);  // in a second
}
END_TEST

// A person at the picture's left edge: 24 of 40 columns are outside, and the right box is of the rest.
START_TEST(boxes_end_where_the_picture_does) {
  PatrolScore score({320, 240}, 30);
  score.add({person(1, -24, .55)}, {{{5, {0, 60, 16, 100}}}}, 0);
  ck_assert_double_eq_tol(score.figures().recall, 1, 1e-9);
}
END_TEST

START_TEST(who_is_out_of_the_picture_counts_as_lost_unless_a_wall_is_between) {
  PatrolScore score({320, 240}, 30);
  const auto add = [&](int n, double bearing, bool in_sight) {
    Subject s = person(1, 100, std::abs(bearing) < 30 && in_sight ? 1 : 0, bearing);
    s.in_sight = in_sight;
    score.add({s}, {box(1, 100)}, n * .1);
  };
  for (int n = 0; n < 40; ++n) add(n, 3, true);
  for (int n = 40; n < 50; ++n) add(n, 40, true);
  for (int n = 50; n < 60; ++n) add(n, 80, false);
  const PatrolFigures f = score.figures();
  ck_assert_double_eq_tol(f.in_picture, .8, 1e-9);
  // From 2 s after the first box: 20 times 3 degrees, 10 times 40.
  ck_assert_double_eq_tol(f.off, std::sqrt((20 * 9. + 10 * 1600) / 30), 1e-6);
}
END_TEST

START_TEST(who_is_never_found_takes_for_ever) {
  PatrolScore score({320, 240}, 30);
  for (int n = 0; n < 10; ++n) score.add({person(1, 100)}, {}, n * .1);
  ck_assert(std::isinf(score.figures().found_after));
  ck_assert_double_eq_tol(score.figures().recall, 0, 1e-9);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "patrol_score",
      {a_box_is_asked_for_once_half_of_a_person_is_visible,
       a_box_on_somebody_who_does_not_count_is_neither_right_nor_wrong,
       a_box_beside_everybody_is_wrong_and_its_track_is_false, boxes_end_where_the_picture_does,
       who_is_out_of_the_picture_counts_as_lost_unless_a_wall_is_between, who_is_never_found_takes_for_ever});
}
