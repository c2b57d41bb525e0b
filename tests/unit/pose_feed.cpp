// SPDX-License-Identifier: LGPL-2.1-or-later
// When a head's pose is known for a frame: poses and waits by hand.
#include "motion/pose_feed.h"

#include <thread>

#include "support/suite.h"

using namespace cerberus::motion;
using namespace std::chrono_literals;
using Answer = PoseFeed::Answer;

namespace {

Pose piece(Time from, Time until, double pan, double speed = 0) {
  return {.from = from, .until = until, .pan = {pan, speed, 0}, .tilt = {}};
}

}  // namespace

START_TEST(the_first_frame_shows_where_the_head_was) {
  PoseFeed feed;
  feed.begin(piece({}, kNever, .3));
  ck_assert(feed.wait(10s, 1ns) == Answer::known);
  ck_assert_double_eq(feed.at(10s).pan.position, .3);
  feed.play(true);
  ck_assert(feed.wait(11s, 1ns) == Answer::silent);  // the second frame needs a pose
}
END_TEST

START_TEST(a_frame_waits_until_its_time_is_covered) {
  PoseFeed feed;
  feed.begin({});
  feed.at(0s);
  feed.play(true);
  feed.add(piece(0s, 1s, .1, .5));
  ck_assert(feed.wait(1s, 1ns) == Answer::known);
  ck_assert_double_eq_tol(feed.at(1s).pan.position, .6, 1e-12);
  ck_assert(feed.wait(1s + 1ns, 1ns) == Answer::silent);
  std::thread head([&] { feed.add(piece(1s, 2s, .6)); });
  ck_assert(feed.wait(2s, 0s) == Answer::known);
  head.join();
}
END_TEST

// The later of two pieces may still be on its way: the earlier one decides at the time where they meet.
START_TEST(where_two_pieces_meet_the_earlier_one_counts) {
  PoseFeed feed;
  feed.begin({});
  feed.at(0s);
  feed.add(piece(0s, 1s, .1));
  feed.add(piece(1s, 2s, .9));
  ck_assert_double_eq(feed.at(1s).pan.position, .1);
  ck_assert_double_eq(feed.at(1s + 1ns).pan.position, .9);
}
END_TEST

START_TEST(after_a_flush_the_head_stands_where_it_was) {
  PoseFeed feed;
  feed.begin({});
  feed.at(0s);
  feed.add(piece(0s, 2s, .1, .5));
  ck_assert_double_eq_tol(feed.at(1s).pan.position, .6, 1e-12);
  feed.forget();
  ck_assert(feed.wait(9s, 1ns) == Answer::known);
  ck_assert_double_eq_tol(feed.at(9s).pan.position, .6, 1e-12);
  ck_assert(!feed.at(9s).moving());
}
END_TEST

START_TEST(an_interrupted_wait_ends) {
  PoseFeed feed;
  feed.begin({});
  feed.at(0s);
  std::thread flush([&] { feed.interrupt(true); });
  ck_assert(feed.wait(9s, 0s) == Answer::interrupted);
  flush.join();
  feed.interrupt(false);
  feed.add(piece(0s, 9s, 0));
  ck_assert(feed.wait(9s, 0s) == Answer::known);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pose_feed", {the_first_frame_shows_where_the_head_was, a_frame_waits_until_its_time_is_covered,
                    where_two_pieces_meet_the_earlier_one_counts, after_a_flush_the_head_stands_where_it_was,
                    an_interrupted_wait_ends});
}
