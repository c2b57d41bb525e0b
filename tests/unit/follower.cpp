// SPDX-License-Identifier: LGPL-2.1-or-later
// Which track the fuser follows, and for how long.
#include "fuser_stream.h"

using namespace stream;

START_TEST(a_track_is_followed_and_kept_half_a_second) {
  Stream stream;
  stream.tracks = {person(7)};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::track, 1, "camera");
  ck_assert(decision.camera_found && decision.target == 7);
  stream.tracks.clear();
  stream.frames(499ms);
  assert_says(decision, Action::hold, 1, "camera");
  ck_assert(decision.camera_found && decision.target == 0);
  stream.frames(1ms);
  ck_assert(!decision.camera_found);
  assert_says(decision, Action::hold, 0, "return");
}
END_TEST

START_TEST(the_one_followed_is_kept_though_others_are_nearer) {
  Stream stream;
  Track far = person(1), near = person(2);
  far.distance = 9;
  near.distance = 3;
  stream.tracks = {far};
  const Decision& decision = stream.frame();
  stream.tracks = {near, far};
  stream.frame();
  ck_assert_int_eq(decision.target, 1);
  stream.tracks = {near};
  stream.frame();
  ck_assert_int_eq(decision.target, 2);
}
END_TEST

START_TEST(a_person_is_followed_rather_than_what_only_moves) {
  Track near = person(1), far = person(2);
  near.distance = 3;
  far.distance = 9;
  far.person = true;
  Stream stream;
  stream.tracks = {near, far};
  const Decision& decision = stream.frame();
  ck_assert_int_eq(decision.target, 2);
  // Once known to be a person as well, the nearer one does not take the target over.
  stream.tracks[0].person = true;
  stream.frame();
  ck_assert_int_eq(decision.target, 2);
}
END_TEST

START_TEST(a_target_that_only_moves_gives_way_to_a_person) {
  Track curtain = person(1), visitor = person(2);
  curtain.distance = 3;
  visitor.distance = 9;
  Stream stream;
  stream.tracks = {curtain};
  const Decision& decision = stream.frame();
  stream.tracks = {curtain, visitor};
  stream.frame();
  ck_assert_int_eq(decision.target, 1);  // nobody knows yet that it is one
  stream.tracks[1].person = true;
  stream.frames(480ms);
  ck_assert_int_eq(decision.target, 1);  // it may be for a moment only
  stream.frames(120ms);
  ck_assert_int_eq(decision.target, 2);
  stream.tracks[1].state = TrackState::stopped;
  stream.frame();
  ck_assert_int_eq(decision.target, 2);
  stream.tracks = {curtain};
  stream.frame();
  ck_assert_int_eq(decision.target, 1);
}
END_TEST

START_TEST(a_target_that_moves_gives_way_to_no_person_who_coasts_or_stands) {
  for (const TrackState state : {TrackState::coasted, TrackState::stopped}) {
    Track curtain = person(1), visitor = person(2, state);
    visitor.person = true;
    Stream stream;
    stream.tracks = {curtain};
    const Decision& decision = stream.frame();
    stream.tracks = {curtain, visitor};
    stream.frames(2s);
    ck_assert_int_eq(decision.target, 1);
    stream.tracks[1].state = TrackState::seen;
    stream.frames(600ms);
    ck_assert_int_eq(decision.target, 2);
  }
}
END_TEST

START_TEST(a_person_found_for_moments_takes_no_target_over) {
  Track curtain = person(1), visitor = person(2);
  visitor.person = true;
  Stream stream;
  stream.tracks = {curtain};
  const Decision& decision = stream.frame();
  for (int k = 0; k < 50; ++k) {
    stream.tracks = {curtain};
    if (k % 5 > 0) stream.tracks.push_back(visitor);  // 160 ms of 200
    stream.frame();
    ck_assert_int_eq(decision.target, 1);
  }
  // Lost for a frame, but still there: found nearly all the time.
  for (int k = 0; k < 15; ++k) {
    visitor.state = k % 5 > 0 ? TrackState::seen : TrackState::coasted;
    stream.tracks = {curtain, visitor};
    stream.frame();
  }
  ck_assert_int_eq(decision.target, 2);
}
END_TEST

START_TEST(a_target_is_chosen_by_nearness_size_or_newness) {
  Track near = person(1), large = person(2), newest = person(3);
  near.distance = 2;
  large.distance = 5;
  large.width = 200;
  newest.distance = 4;
  newest.age = 100ms;
  const struct {
    TargetChoice choice;
    std::uint32_t expected;
  } cases[] = {{TargetChoice::nearest, 1}, {TargetChoice::largest, 2}, {TargetChoice::newest, 3}};
  for (const auto& one : cases) {
    std::vector<Track> tracks{near, large, newest};
    std::ranges::sort(tracks, {}, &Track::id);
    do {  // whatever the order they come in
      Stream stream(FuserOptions{.choice = one.choice});
      stream.tracks = tracks;
      ck_assert_int_eq(stream.frame().target, one.expected);
    } while (std::ranges::next_permutation(tracks, {}, &Track::id).found);
  }
}
END_TEST

START_TEST(without_distances_the_lowest_feet_are_the_nearest) {
  Stream stream;
  Track high = person(1), low = person(2);
  low.y = 90;
  stream.tracks = {high, low};
  ck_assert_int_eq(stream.frame().target, 2);
}
END_TEST

// Of a track of the detector alone no distance is known.
START_TEST(beside_an_unknown_distance_the_lowest_feet_are_the_nearest) {
  Track near = person(1), far = person(2), farther = person(3);
  near.y = 100;
  far.y = 30;
  far.distance = 12;
  farther.y = 20;
  farther.distance = 20;
  for (const TrackState state : {TrackState::seen, TrackState::coasted}) {
    near.person = far.person = farther.person = true;
    near.state = far.state = farther.state = state;
    std::vector<Track> tracks{near, far, farther};
    do {  // whatever the order they come in
      Stream stream;
      stream.tracks = tracks;
      ck_assert_int_eq(stream.frame().target, 1);
    } while (std::ranges::next_permutation(tracks, {}, &Track::id).found);
  }
  // One that only moves, or is stopped, changes nothing among the others.
  far.state = farther.state = TrackState::seen;
  far.y = 10;
  Track curtain = person(4), standing = person(5, TrackState::stopped);
  standing.person = true;
  Stream stream;
  stream.tracks = {farther, curtain, far, standing};
  ck_assert_int_eq(stream.frame().target, 2);
}
END_TEST

START_TEST(a_seen_track_precedes_a_stopped_one_and_a_coasted_one) {
  Stream stream;
  Track coasted = person(1, TrackState::coasted), stopped = person(2, TrackState::stopped), seen = person(3);
  coasted.distance = 1;
  stopped.distance = 2;
  seen.distance = 8;
  stream.tracks = {coasted, stopped};
  ck_assert_int_eq(stream.frame().target, 2);
  Stream other;
  other.tracks = {coasted, stopped, seen};
  ck_assert_int_eq(other.frame().target, 3);
  coasted.person = true;
  Stream third;
  third.tracks = {coasted, seen};
  ck_assert_int_eq(third.frame().target, 3);
}
END_TEST

START_TEST(a_stopped_track_is_followed_for_half_a_minute_and_then_left) {
  Stream stream;
  stream.tracks = {person(7)};
  const Decision& decision = stream.frame();
  stream.tracks = {person(7, TrackState::stopped)};
  stream.frame();
  stream.frames(30s - 1ms);
  assert_says(decision, Action::track, 1, "camera");
  stream.frames(1ms);
  ck_assert_int_eq(decision.target, 0);
  stream.frames(6s);
  assert_says(decision, Action::zero, 7, "zero");
  stream.tracks = {person(7)};  // moves again
  stream.frame();
  ck_assert_int_eq(decision.target, 7);
  stream.tracks = {person(7, TrackState::stopped)};  // and has another half minute
  stream.frame();
  stream.frames(29s);
  ck_assert_int_eq(decision.target, 7);
}
END_TEST

START_TEST(a_track_that_moves_in_between_has_another_half_minute) {
  Stream stream;
  stream.tracks = {person(7)};
  const Decision& decision = stream.frame();
  for (const TrackState state : {TrackState::stopped, TrackState::seen, TrackState::stopped}) {
    stream.tracks = {person(7, state)};
    stream.frames(20s);
    ck_assert_int_eq(decision.target, 7);
  }
}
END_TEST

START_TEST(the_paper_waits_for_nobody) {
  Stream stream(paper_options());
  stream.tracks = {person(7)};
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::track);
  stream.tracks.clear();
  stream.frame();
  ck_assert(decision.action == Action::zero && decision.rule == 7 && !decision.camera_found);
  stream.tracks = {person(8)};
  stream.frame();
  ck_assert(decision.action == Action::track);
  stream.tracks = {person(8, TrackState::stopped)};
  stream.frames(1s);
  ck_assert(decision.action == Action::zero && decision.rule == 7);
}
END_TEST

START_TEST(rule_7_waits_for_a_stopped_person_even_when_the_track_is_gone) {
  FuserOptions table = paper_options();
  table.hold_stopped = FuserOptions{}.hold_stopped;
  for (const FuserOptions& options : {FuserOptions{}, table}) {
    Stream stream(options);
    stream.tracks = {person(7)};
    const Decision& decision = stream.frame();
    stream.tracks = {person(7, TrackState::stopped)};
    stream.frame();
    stream.tracks.clear();
    stream.frames(10s);
    assert_says(decision, Action::hold, 0, "stopped");
    stream.sensors = {1, 0, 0};  // news from elsewhere go before
    stream.pan = 100;
    stream.frame();
    ck_assert(decision.action == Action::turn_left);
    stream.sensors = {0, 0, 0};
    stream.frames(30s - 10s - kFrame - 1ms);
    ck_assert(decision.action == Action::hold);
    stream.frames(10s);
    ck_assert(decision.action == Action::zero);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "follower",
      {a_track_is_followed_and_kept_half_a_second, the_one_followed_is_kept_though_others_are_nearer,
       a_person_is_followed_rather_than_what_only_moves, a_target_that_only_moves_gives_way_to_a_person,
       a_target_that_moves_gives_way_to_no_person_who_coasts_or_stands,
       a_person_found_for_moments_takes_no_target_over, a_target_is_chosen_by_nearness_size_or_newness,
       without_distances_the_lowest_feet_are_the_nearest,
       beside_an_unknown_distance_the_lowest_feet_are_the_nearest,
       a_seen_track_precedes_a_stopped_one_and_a_coasted_one,
       a_stopped_track_is_followed_for_half_a_minute_and_then_left,
       a_track_that_moves_in_between_has_another_half_minute, the_paper_waits_for_nobody,
       rule_7_waits_for_a_stopped_person_even_when_the_track_is_gone});
}
