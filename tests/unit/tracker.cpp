// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracks of objects whose true paths are known.
#include "vision/tracking/tracker.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "support/allocations.h"
#include "support/motions.h"
#include "support/suite.h"
#include "unit/walkers.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(a_walker_is_published_in_the_third_frame_and_keeps_its_identity_and_speed) {
  Tracker tracker;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 2);
  for (int k = 0; k < 40; ++k) {
    const double x = 100 + 8 * k;  // 80 pixels a second at 10 frames a second
    const Region seen = person(x + noise(random), 240 + noise(random));
    const auto tracks = tracker.update({&seen, 1}, {}, 0.1, kFrame);
    ck_assert_uint_eq(tracks.size(), k < 2 ? 0 : 1);
    if (k < 2) continue;
    ck_assert_uint_eq(tracks[0].id, 1);
    ck_assert(tracks[0].state == TrackState::seen);
    ck_assert_double_eq_tol(centre(tracks[0]).x, x, 8);
    ck_assert_double_eq_tol(tracks[0].age, 0.1 * k, 1e-9);
    if (k < 15) continue;
    ck_assert_double_eq_tol(tracks[0].vx, 80, 16);
    ck_assert_double_eq_tol(tracks[0].vy, 0, 16);
    ck_assert_double_eq_tol(tracks[0].box.height, 100, 5);
  }
}
END_TEST

START_TEST(the_time_to_publish_is_a_fifth_of_a_second_at_any_frame_rate) {
  for (const double rate : {1.0, 5.0, 10.0, 25.0, 60.0}) {
    Tracker tracker;
    int first = -1;
    for (int k = 0; k < 40 && first < 0; ++k) {
      const Region seen = person(100 + 80 * k / rate, 240);
      if (!tracker.update({&seen, 1}, {}, 1 / rate, kFrame).empty()) first = k;
    }
    // 0.2 s and three looks at least; two looks where three take very long.
    ck_assert_int_eq(first, rate == 60 ? 12 : rate == 25 ? 5 : rate == 1 ? 1 : 2);
  }
}
END_TEST

START_TEST(blobs_that_flash_up_here_and_there_are_never_published) {
  Tracker tracker;
  std::mt19937 random(2);
  int published = 0;
  for (int k = 0; k < 500; ++k) {
    std::vector<Region> noise;
    for (unsigned i = 0; i < random() % 4; ++i)
      noise.push_back(person(random() % 640, random() % 480, 0.3, 12, 12));
    published += static_cast<int>(tracker.update(noise, {}, 0.04, kFrame).size());
  }
  ck_assert_int_eq(published, 0);
}
END_TEST

START_TEST(a_region_that_never_moves_is_never_published) {
  Tracker tracker;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1.5);
  for (int k = 0; k < 300; ++k) {
    const Region hole = person(300 + noise(random), 240 + noise(random));
    ck_assert_uint_eq(tracker.update({&hole, 1}, {}, 0.1, kFrame).size(), 0);
  }
}
END_TEST

START_TEST(a_camera_that_pans_does_not_make_the_standing_move_or_the_walking_change) {
  Tracker tracker;
  for (int k = 0; k < 40; ++k) {
    const double shift = -6.0 * k;  // the picture moves left by 6 pixels a frame
    const double stands = 400 + 8 * std::min(k, 6);
    const std::vector<Region> seen = {person(stands + shift, 240), person(300 + 8 * k + shift, 300)};
    const auto tracks = tracker.update(seen, Transform::translation(-6, 0), 0.1, kFrame);
    if (k < 20) continue;
    ck_assert_uint_eq(tracks.size(), 2);
    ck_assert_double_eq_tol(with_id(tracks, 1)->vx, 0, 5);
    ck_assert_double_eq_tol(with_id(tracks, 2)->vx, 80, 5);
    ck_assert_double_eq_tol(centre(*with_id(tracks, 1)).x, stands + shift, 3);
  }
}
END_TEST

START_TEST(a_zoom_scales_box_and_speed_of_a_coasted_track) {
  Tracker tracker;
  for (int k = 0; k < 20; ++k) {
    const Region seen = person(100 + 8 * k, 240);
    tracker.update({&seen, 1}, {}, 0.1, kFrame);
  }
  const Track before = tracker.update({}, {}, 1e-9, kFrame)[0];
  const auto after = tracker.update({}, similarity(1.5, 0, 0, 0), 1e-9, kFrame);
  ck_assert_double_eq_tol(after[0].box.height, 1.5 * before.box.height, 0.1);
  ck_assert_double_eq_tol(after[0].vx, 1.5 * before.vx, 0.1);
  ck_assert_double_eq_tol(after[0].box.x, 1.5 * before.box.x, 1);
}
END_TEST

START_TEST(a_flickering_object_is_coasted_over_its_gaps) {
  Tracker tracker;
  for (int k = 0; k < 60; ++k) {
    const Region seen = person(60 + 8 * k, 240);
    const bool gap = k > 10 && k % 4 == 3;
    const auto tracks = tracker.update({&seen, gap ? 0u : 1u}, {}, 0.1, kFrame);
    if (k < 2) continue;
    ck_assert_uint_eq(tracks.size(), 1);
    ck_assert_uint_eq(tracks[0].id, 1);
    ck_assert(tracks[0].state == (gap ? TrackState::coasted : TrackState::seen));
    ck_assert_double_eq_tol(centre(tracks[0]).x, 60 + 8 * k, 6);
  }
}
END_TEST

START_TEST(a_stopped_track_is_held_for_thirty_seconds) {
  Tracker tracker;
  double x = 100;
  for (int k = 0; k < 30; ++k) {
    x += k < 20 ? 8 : std::max(0.0, 8.0 - 2 * (k - 19));
    const Region seen = person(x, 240);
    tracker.update({&seen, 1}, {}, 0.1, kFrame);
  }
  double held = 0;
  for (int k = 0; k < 400; ++k) {
    const auto tracks = tracker.update({}, {}, 0.1, kFrame);
    if (tracks.empty()) break;
    ck_assert(tracks[0].state == TrackState::stopped);
    ck_assert_double_eq_tol(centre(tracks[0]).x, x, 6);
    ck_assert_double_eq(tracks[0].vx, 0);
    held += 0.1;
  }
  ck_assert_double_eq_tol(held, 30, 0.2);
}
END_TEST

// The object is 100 pixels tall, the picture comes 10 times a second: it must have come 45 pixels and have been seen for
// 1.5 s to be held where it ceases to move.
START_TEST(a_track_that_came_from_nearby_or_was_seen_for_a_moment_is_not_held) {
  struct {
    double step;  // pixels a frame, in the first six
    int frames;   // with a region; the age at the last one is 0.1 s less
    bool held;
  } const cases[] = {{12, 30, true}, {5, 30, false}, {12, 18, true}, {12, 13, false}};
  for (const auto& c : cases) {
    Tracker tracker;
    for (int k = 0; k < c.frames; ++k) {
      const Region seen = person(300 + c.step * std::min(k, 6), 240);
      const auto tracks = tracker.update({&seen, 1}, {}, 0.1, kFrame);
      if (k >= 4) ck_assert_uint_eq(tracks.size(), 1);
    }
    for (int k = 0; k < 50; ++k) {
      const auto tracks = tracker.update({}, {}, 0.1, kFrame);
      for (const Track& t : tracks) ck_assert((t.state == TrackState::stopped) == c.held);
      if (c.held || k == 49) ck_assert_uint_eq(tracks.size(), c.held);
    }
  }
}
END_TEST

START_TEST(a_stopped_person_who_walks_on_keeps_the_identity) {
  Tracker tracker;
  for (int k = 0; k < 100; ++k) {
    const double x = k < 20 ? 100 + 8 * k : k < 70 ? 252 : 252 + 8 * (k - 70);
    const Region seen = person(x, 240);
    const bool moves = k < 28 || k >= 70;  // the mask keeps a standing person for a moment
    const auto tracks = tracker.update({&seen, moves ? 1u : 0u}, {}, 0.1, kFrame);
    if (k < 3) continue;
    ck_assert_uint_eq(tracks.size(), 1);
    ck_assert_uint_eq(tracks[0].id, 1);
    ck_assert(tracks[0].state == (moves ? TrackState::seen : TrackState::stopped));
  }
}
END_TEST

START_TEST(a_standing_person_s_moving_arm_does_not_make_the_person_small) {
  for (const double pan : {0.0, -9.0, 6.0}) {  // pixels a frame by which the picture moves, once he stands
    Tracker tracker;
    for (int k = 0; k < 60; ++k) {
      const double turned = pan * std::max(0, k - 27);
      const double x = (k < 20 ? 200 + 8 * k : 352) + turned;
      const Region seen = k < 28 ? person(x, 240) : person(x + 12, 230 + 3 * (k % 3), 0.2, 14, 20);
      const auto tracks =
          tracker.update({&seen, 1}, k < 28 ? Transform{} : Transform::translation(pan, 0), 0.1, kFrame);
      if (k < 3) continue;
      ck_assert_uint_eq(tracks.size(), 1);
      ck_assert_uint_eq(tracks[0].id, 1);
      ck_assert_double_eq_tol(tracks[0].box.height, 100, 10);
      ck_assert_double_eq_tol(tracks[0].box.width, 40, 8);
      ck_assert_double_eq_tol(centre(tracks[0]).x, x, 10);
    }
  }
}
END_TEST

START_TEST(a_track_that_leaves_the_picture_ends_within_half_a_second) {
  for (const double speed : {30.0, 80.0, 200.0}) {  // pixels a second
    Tracker tracker;
    double left = -1;
    for (int k = 0; k < 400; ++k) {
      const double x = 300 + speed * k / 10;
      Region seen = person(x, 240);
      seen.box.width = std::min(seen.box.right(), 640.0) - seen.box.x;
      const bool visible = seen.box.width >= 2;
      const auto tracks = tracker.update({&seen, visible ? 1u : 0u}, {}, 0.1, kFrame);
      if (!visible && left < 0) left = 0.1 * k;
      if (!visible && 0.1 * k > left + 0.5) ck_assert_uint_eq(tracks.size(), 0);
    }
    ck_assert_double_gt(left, 0);
  }
}
END_TEST

// At the edge the person may have left; in the middle of the picture the person is occluded.
START_TEST(a_track_unseen_at_the_edge_is_unpublished_and_keeps_its_identity) {
  for (const bool edge : {true, false}) {
    Tracker tracker;
    std::uint32_t id = 0;
    for (int k = 0; k < 24; ++k) {
      const double x = (edge ? 520 : 240) + 5 * k;
      Region seen = person(x, 240);
      seen.box.width = std::min(seen.box.right(), 640.0) - seen.box.x;
      const bool visible = k < 20 || k > 21;
      const auto tracks = tracker.update({&seen, visible ? 1u : 0u}, {}, 0.1, kFrame);
      if (k == 19) id = tracks.front().id;
      if (k >= 10) ck_assert_uint_eq(tracks.size(), edge && !visible ? 0 : 1);
      if (k >= 22) ck_assert_uint_eq(tracks.front().id, id);
    }
  }
}
END_TEST

START_TEST(a_sliver_beside_an_unseen_person_is_another_object) {
  Tracker tracker;
  double x = 100;
  for (int k = 0; k < 24; ++k) {
    x += 8;
    const Region seen = k < 20 ? person(x, 240) : person(x + 55, 240, 0.4, 34, 4);
    const auto tracks = tracker.update({&seen, 1}, {}, 0.1, kFrame);
    if (k < 3) continue;
    ck_assert_uint_ge(tracks.size(), 1);
    ck_assert_double_eq_tol(centre(tracks[0]).x, x, 15);
  }
}
END_TEST

START_TEST(a_fragment_corrects_the_position_less_than_a_whole_person) {
  for (const bool whole : {false, true}) {
    Tracker tracker;
    for (int k = 0; k < 20; ++k) {
      const Region seen = person(100 + 8 * k, 240);
      tracker.update({&seen, 1}, {}, 0.1, kFrame);
    }
    const Region aside = whole ? person(280, 240) : person(280, 275, 0.4, 40, 30);  // expected at 260
    const auto tracks = tracker.update({&aside, 1}, {}, 0.1, kFrame);
    ck_assert_uint_eq(tracks.size(), 1);
    if (whole)
      ck_assert_double_gt(centre(tracks[0]).x, 270);
    else
      ck_assert_double_lt(centre(tracks[0]).x, 268);
  }
}
END_TEST

START_TEST(an_unknown_time_is_taken_as_the_last_known_one) {
  Tracker tracker;
  for (int k = 0; k < 30; ++k) {
    const Region seen = person(100 + 8 * k, 240);
    const double seconds = k % 2 ? 0.1 : k % 4 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
    const auto tracks = tracker.update({&seen, 1}, {}, k == 0 ? 0.1 : seconds, kFrame);
    if (k > 20) ck_assert_double_eq_tol(tracks[0].vx, 80, 5);
  }
}
END_TEST

START_TEST(impossible_regions_and_transforms_do_no_harm) {
  Tracker tracker;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 30; ++k) {
    const std::vector<Region> seen = {person(nan, 240), person(100 + 8 * k, 240),
                                      person(100, 100, 0.5, -5, 10), person(200, inf),
                                      person(300, 300, 0.5, 0, 0)};
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k >= 2) ck_assert_uint_eq(tracks.size(), 1);
    for (const Track& t : tracks)
      ck_assert(std::isfinite(t.box.area() + t.box.x + t.vx + t.vy + t.confidence));
  }
  Transform broken;
  broken.m.fill(nan);
  ck_assert_uint_eq(tracker.update({}, broken, 0.1, kFrame).size(), 0);
  broken.m.fill(0);
  const Region seen = person(100, 240);
  for (int k = 0; k < 5; ++k) tracker.update({&seen, 1}, broken, 0.1, kFrame);
}
END_TEST

START_TEST(boxes_are_clamped_to_the_frame_and_identities_never_come_again) {
  Tracker tracker;
  Region seen{{-10, -20, 60, 120}, 3000, 0.9, 1};
  const auto walk = [&] {
    for (int k = 0; k < 5; ++k) {
      seen.box.y += k % 2 ? -25 : 25;
      tracker.update({&seen, 1}, {}, 0.1, kFrame);
    }
  };
  walk();
  const Track first = tracker.update({&seen, 1}, {}, 0.1, kFrame)[0];
  ck_assert_double_ge(first.box.x, 0);
  ck_assert_double_ge(first.box.y, 0);
  tracker.reset();
  ck_assert_uint_eq(tracker.update({}, {}, 0.1, kFrame).size(), 0);
  walk();
  ck_assert_uint_gt(tracker.update({&seen, 1}, {}, 0.1, kFrame)[0].id, first.id);
}
END_TEST

// A jump of 80 pixels in a tenth of a second: without a limit a track that was seen once has gone there, with one the
// region is a new object.
START_TEST(a_limit_of_speed_keeps_the_too_fast_apart) {
  for (const double limit : {0.0, 200.0}) {
    Tracker tracker;
    tracker.set_options({.maximum_speed = limit});
    std::span<const Track> tracks;
    for (int k = 0; k < 6; ++k) {
      const Region seen = person(k == 0 ? 100 : 180 + 8 * (k - 1), 240);
      tracks = tracker.update({&seen, 1}, {}, 0.1, kFrame);
    }
    ck_assert_uint_eq(tracks.size(), 1);
    const double since_the_first_look = 0.5;
    if (limit > 0)
      ck_assert_double_lt(tracks[0].age, since_the_first_look - 0.05);
    else
      ck_assert_double_eq_tol(tracks[0].age, since_the_first_look, 1e-9);
  }
}
END_TEST

START_TEST(the_steady_state_allocates_nothing_and_thousands_of_regions_are_survived) {
  Tracker tracker;
  std::mt19937 random(7);
  std::vector<std::vector<Region>> frames(20);
  for (auto& frame : frames)
    for (int i = 0; i < 60; ++i) frame.push_back(person(random() % 640, random() % 480, 0.4, 20, 40));
  for (const auto& frame : frames) tracker.update(frame, {}, 0.04, kFrame);
  const std::size_t before = allocations();
  for (const auto& frame : frames) tracker.update(frame, Transform::translation(1, 0), 0.04, kFrame);
  ck_assert_uint_eq(allocations(), before);
  std::vector<Region> many;
  for (int i = 0; i < 3000; ++i) many.push_back(person(random() % 640, random() % 480, 0.4, 3, 3));
  for (int k = 0; k < 3; ++k) ck_assert_uint_le(tracker.update(many, {}, 0.04, kFrame).size(), 128);
}
END_TEST

// Their area (foreground pixels) may be unknown.
START_TEST(of_more_regions_than_there_is_room_for_the_largest_boxes_count) {
  Tracker tracker;
  std::mt19937 random(8);
  for (int k = 0; k < 20; ++k) {
    std::vector<Region> seen;
    for (int i = 0; i < 300; ++i) seen.push_back(person(random() % 640, random() % 480, 0.4, 3, 3));
    const double x = 100 + 8 * k;
    seen.push_back(person(x, 240));
    seen.back().area = 0;
    const auto tracks = tracker.update(seen, {}, 0.1, kFrame);
    if (k < 4) continue;
    ck_assert(std::ranges::any_of(tracks, [&](const Track& t) {
      return intersection_over_union(t.box, seen.back().box) > 0.7 && t.state == TrackState::seen;
    }));
  }
}
END_TEST

START_TEST(the_same_regions_give_the_same_tracks) {
  Tracker a, b;
  std::mt19937 random(9);
  for (int k = 0; k < 100; ++k) {
    std::vector<Region> seen;
    for (int i = 0; i < 8; ++i)
      seen.push_back(person(80.0 * i + k % 20 + random() % 9, 200 + random() % 9, 0.5));
    const auto ta = a.update(seen, {}, 0.1, kFrame), tb = b.update(seen, {}, 0.1, kFrame);
    ck_assert_uint_eq(ta.size(), tb.size());
    for (std::size_t i = 0; i < ta.size(); ++i) {
      ck_assert_uint_eq(ta[i].id, tb[i].id);
      ck_assert_double_eq(ta[i].box.x, tb[i].box.x);
      ck_assert_double_eq(ta[i].vx, tb[i].vx);
      if (i) ck_assert_uint_lt(ta[i - 1].id, ta[i].id);
    }
  }
}
END_TEST

START_TEST(while_a_picture_is_repeated_tracks_last_as_long_as_they_would_unseen) {
  TrackOptions options;
  options.coast_time = 1, options.hold_stopped = 30;
  for (const TrackState moving : {TrackState::seen, TrackState::coasted}) {
    ck_assert(outlasts(moving, 1, options));
    ck_assert(!outlasts(moving, 1.01, options));
  }
  ck_assert(outlasts(TrackState::stopped, 30, options));
  ck_assert(!outlasts(TrackState::stopped, 30.01, options));
}
END_TEST

int main() {
  return run_suite("tracks", {a_walker_is_published_in_the_third_frame_and_keeps_its_identity_and_speed,
                              the_time_to_publish_is_a_fifth_of_a_second_at_any_frame_rate,
                              blobs_that_flash_up_here_and_there_are_never_published,
                              a_region_that_never_moves_is_never_published,
                              a_camera_that_pans_does_not_make_the_standing_move_or_the_walking_change,
                              a_zoom_scales_box_and_speed_of_a_coasted_track,
                              a_flickering_object_is_coasted_over_its_gaps,
                              a_stopped_track_is_held_for_thirty_seconds,
                              a_track_that_came_from_nearby_or_was_seen_for_a_moment_is_not_held,
                              a_stopped_person_who_walks_on_keeps_the_identity,
                              a_standing_person_s_moving_arm_does_not_make_the_person_small,
                              a_track_that_leaves_the_picture_ends_within_half_a_second,
                              a_track_unseen_at_the_edge_is_unpublished_and_keeps_its_identity,
                              a_sliver_beside_an_unseen_person_is_another_object,
                              a_fragment_corrects_the_position_less_than_a_whole_person,
                              an_unknown_time_is_taken_as_the_last_known_one,
                              impossible_regions_and_transforms_do_no_harm,
                              boxes_are_clamped_to_the_frame_and_identities_never_come_again,
                              a_limit_of_speed_keeps_the_too_fast_apart,
                              the_steady_state_allocates_nothing_and_thousands_of_regions_are_survived,
                              of_more_regions_than_there_is_room_for_the_largest_boxes_count,
                              while_a_picture_is_repeated_tracks_last_as_long_as_they_would_unseen,
                              the_same_regions_give_the_same_tracks});
}
