// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracks in blobs of several objects, and of objects in fragments.
#include "unit/walkers.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(two_persons_who_meet_in_one_blob_keep_their_identities) {
  Tracker tracker;
  std::uint32_t left_id = 0, right_id = 0;
  for (int k = 0; k < 60; ++k) {
    const double a = 150 + 6 * k, b = 486 - 6 * k;  // they pass at 318, frame 28
    std::vector<Region> seen;
    if (std::abs(a - b) > 44) {
      seen = {person(a, 240, 0.4), person(b, 250, 0.4, 44, 110)};
    } else {
      const double from = std::min(a - 20, b - 22), to = std::max(a + 20, b + 22);
      seen = {{{from, 190, to - from, 115}, 4000, 0.4, 1, RegionKind::part}};
    }
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k == 10) {
      ck_assert_uint_eq(tracks.size(), 2);
      left_id = centre(tracks[0]).x < centre(tracks[1]).x ? tracks[0].id : tracks[1].id;
      right_id = 3 - left_id;
    }
    if (k < 10) continue;
    ck_assert_uint_eq(tracks.size(), 2);
    ck_assert_ptr_nonnull(with_id(tracks, left_id));
    ck_assert_ptr_nonnull(with_id(tracks, right_id));
    // Each has a box of its own inside the blob.
    for (const Track& t : tracks) ck_assert_double_lt(t.box.width, 65);
    if (k < 45) continue;
    ck_assert_double_eq_tol(centre(*with_id(tracks, left_id)).x, a, 15);
    ck_assert_double_eq_tol(centre(*with_id(tracks, right_id)).x, b, 15);
  }
}
END_TEST

START_TEST(three_persons_who_meet_in_a_mostly_empty_blob_stay_three) {
  Tracker tracker;
  std::vector<std::uint32_t> ids(3);
  for (int k = 0; k < 44; ++k) {
    // One from the left, one from the right, one from below, all through the same place.
    const double far = (25 - k) * 8.0, out = std::abs(far);
    const Point at[] = {{320 - far, 200}, {320 + far, 200}, {320, 200 + far}};
    std::vector<Region> seen;
    if (out > 110)
      for (const Point& p : at) seen.push_back(person(p.x, p.y));
    else
      seen = {
          {{300 - out, std::min(150.0, 150 + far), 40 + 2 * out, 100 + out}, 8000, 0.2, 1, RegionKind::part}};
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k < 5) continue;
    ck_assert_uint_eq(tracks.size(), 3);
    for (const Track& t : tracks)
      for (std::size_t i = 0; i < 3; ++i)
        if (k == 5 && std::hypot(centre(t).x - at[i].x, centre(t).y - at[i].y) < 10) ids[i] = t.id;
    if (k < 41) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      ck_assert_double_eq_tol(centre(*with_id(tracks, ids[i])).x, at[i].x, 15);
      ck_assert_double_eq_tol(centre(*with_id(tracks, ids[i])).y, at[i].y, 15);
    }
  }
}
END_TEST

START_TEST(a_new_region_does_not_shift_the_assignment_along_a_row_of_people) {
  Tracker tracker;
  std::uint32_t in_front = 0;
  for (int k = 0; k < 30; ++k) {
    const double x = 100 + 8 * k;
    // One is lost from sight behind the other; a third appears ahead.
    std::vector<Region> seen = {person(x + 45, 240)};
    if (k < 20) seen.push_back(person(x, 240));
    if (k >= 20) seen.push_back(person(x + 90, 240));
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k < 10) continue;
    for (const Track& t : tracks)
      if (k == 19 && std::abs(centre(t).x - x - 45) < 10) in_front = t.id;
    if (k < 20) continue;
    ck_assert_ptr_nonnull(with_id(tracks, in_front));
    ck_assert_double_eq_tol(centre(*with_id(tracks, in_front)).x, x + 45, 10);
  }
}
END_TEST

START_TEST(a_track_in_a_group_does_not_follow_the_person_who_leaves_it) {
  Tracker tracker;
  for (int k = 0; k < 50; ++k) {
    // Two walk in and stand beside each other, first apart, then in one blob; from behind them a third walks away.
    const double a = 200 - 8.0 * std::max(0, 12 - k), b = 240 - 8.0 * std::max(0, 12 - k);
    std::vector<Region> seen = {person(a, 240), person(b, 240)};
    if (k >= 25) seen = {{{a - 20, 190, b - a + 40, 100}, 5000, 0.3, 1, RegionKind::part}};
    if (k >= 35) seen.push_back(person(295 + 8.0 * (k - 35), 240));
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k < 5) continue;
    ck_assert_uint_eq(tracks.size(), k < 37 ? 2 : 3);
    ck_assert_double_eq_tol(centre(*with_id(tracks, 1)).x, a, 12);
    ck_assert_double_eq_tol(centre(*with_id(tracks, 2)).x, b, 12);
  }
}
END_TEST

START_TEST(a_blob_that_turns_out_to_be_two_people_becomes_two_boxes_and_no_ghost) {
  Tracker tracker;
  for (int k = 0; k < 40; ++k) {
    const double x = 150 + 6 * k;
    std::vector<Region> seen;
    if (k < 15)
      seen = {person(x, 240, 0.4, 90, 110)};
    else
      seen = {person(x - 22, 240), person(x + 22, 242)};
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k < 20) continue;
    ck_assert_uint_eq(tracks.size(), 2);
    for (const Track& t : tracks) ck_assert_double_lt(t.box.width, 50);
  }
}
END_TEST

START_TEST(fragments_of_one_object_are_soon_one_track) {
  Tracker tracker;
  std::size_t last = 0;
  for (int k = 0; k < 60; ++k) {
    const double x = 60 + 8 * k;  // a car: three spots first, then all of it
    std::vector<Region> seen;
    if (k < 10)
      seen = {person(x, 240, 0.3, 20, 20), person(x + 70, 250, 0.3, 24, 20),
              person(x + 140, 240, 0.3, 20, 24)};
    else
      seen = {person(x + 70, 245, 0.4, 170, 60)};
    last = tracker.update(seen, {}, 0.1, kFrame).size();
  }
  ck_assert_uint_eq(last, 1);
}
END_TEST

// They were one blob at first, so their common box holds both later regions. The height prior is still empty.
START_TEST(two_persons_who_leave_a_blob_side_by_side_are_two) {
  for (const double gap : {15.0, 25.0, 45.0}) {
    Tracker tracker;
    for (int k = 0; k < 30; ++k) {
      const double x = 100 + 5 * k;
      std::vector<Region> seen{person(x, 240, 0.4), person(x + 40 + gap, 242, 0.4)};
      if (k < 6) seen = {person(x + 20 + gap / 2, 241, 0.4, 80 + gap)};
      const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
      if (k >= 7) ck_assert_double_eq_tol(tracks[0].box.width, 40, 10);  // the box shrinks at once
      if (k < 12) continue;
      ck_assert_uint_eq(tracks.size(), 2);
      const bool first = centre(tracks[0]).x < centre(tracks[1]).x;
      ck_assert_double_eq_tol(centre(tracks[first ? 0 : 1]).x, x, 8);
      ck_assert_double_eq_tol(centre(tracks[first ? 1 : 0]).x, x + 40 + gap, 8);
      for (const Track& t : tracks) ck_assert_double_eq_tol(t.box.width, 40, 10);
    }
  }
}
END_TEST

int main() {
  return run_suite("meeting", {two_persons_who_meet_in_one_blob_keep_their_identities,
                               three_persons_who_meet_in_a_mostly_empty_blob_stay_three,
                               a_new_region_does_not_shift_the_assignment_along_a_row_of_people,
                               a_track_in_a_group_does_not_follow_the_person_who_leaves_it,
                               a_blob_that_turns_out_to_be_two_people_becomes_two_boxes_and_no_ghost,
                               fragments_of_one_object_are_soon_one_track,
                               two_persons_who_leave_a_blob_side_by_side_are_two});
}
