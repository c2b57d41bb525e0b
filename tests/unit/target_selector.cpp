// SPDX-License-Identifier: LGPL-2.1-or-later
// From frames and decisions to goals.
#include "control/target_selector.h"

#include <check.h>

#include <array>

#include "../support/suite.h"

using namespace cerberus;
using namespace std::chrono_literals;
using control::FusionDecision;
using control::Observation;
using control::TargetSelector;
using fusion::Action;

namespace {

const std::array<fusion::Track, 2> kTracks{{
    {.id = 4, .x = 100, .y = 50, .width = 20, .height = 60, .age = 2s},   // its middle is 110, 80
    {.id = 9, .x = 300, .y = 40, .width = 40, .height = 120, .age = 2s},  // 320, 100; the nearer one
}};

FusionDecision decision(Action action, std::optional<fusion::Time> decided, std::uint32_t target = 0) {
  FusionDecision decision;
  decision.made.action = action;
  decision.made.rule = 3;
  decision.made.rule_name = "left";
  decision.made.target = target;
  decision.decided = decided;
  return decision;
}

}  // namespace

START_TEST(a_decision_on_the_frame_is_the_goal_and_its_target_the_middle_of_the_track) {
  TargetSelector selector;
  const auto turn = selector.on_frame({kTracks, decision(Action::turn_left, {})}, 0s, 0);
  ck_assert(turn.goal.action == Action::turn_left && !turn.goal.target);
  ck_assert_str_eq(turn.reason.c_str(), "rule 3 (left): turn-left");
  const auto track = selector.on_frame({kTracks, decision(Action::track, {}, 4)}, 40ms, 0);
  ck_assert(track.goal.action == Action::track);
  ck_assert_double_eq(track.goal.target->x, 110);
  ck_assert_double_eq(track.goal.target->y, 80);
  ck_assert_str_eq(track.reason.c_str(), "rule 3 (left): track 4");
  ck_assert(!track.goal.immediate);
  FusionDecision hold = decision(Action::hold, {});
  hold.made.immediate = true;
  ck_assert(selector.on_frame({kTracks, hold}, 80ms, 0).goal.immediate);
}
END_TEST

START_TEST(without_a_decision_the_nearest_track_is_followed_and_then_zero) {
  TargetSelector selector;
  selector.set_options({.return_delay = 0s});
  const auto track = selector.on_frame({kTracks, {}}, 0s, 0);
  ck_assert(track.goal.action == Action::track && track.goal.target->x == 320);
  const auto zero = selector.on_frame({{}, {}}, 10s, 0);
  ck_assert(zero.goal.action == Action::zero);
}
END_TEST

START_TEST(the_chosen_track_goes_before_every_decision_while_it_is_there) {
  TargetSelector selector;
  selector.follow(9);
  const auto here = selector.on_frame({kTracks, decision(Action::track, {}, 4)}, 0s, 0);
  ck_assert(here.goal.target->x == 320);
  ck_assert_str_eq(here.reason.c_str(), "follows the chosen track 9");
  const auto only_four = std::span(kTracks).first(1);
  const auto away = selector.on_frame({only_four, decision(Action::track, {}, 4)}, 1s, 0);
  ck_assert(away.goal.action == Action::hold && away.lost == 0);
  const auto turning = selector.on_frame({only_four, decision(Action::turn_left, {})}, 2s, 0);
  ck_assert(turning.goal.action == Action::turn_left);  // a sensor may know where it went
  const auto lost = selector.on_frame({only_four, decision(Action::track, {}, 4)}, 5s, 0);
  ck_assert_uint_eq(lost.lost, 9);
  ck_assert(lost.goal.target->x == 110);
}
END_TEST

START_TEST(a_choice_that_the_decisions_make_begins_and_ends_with_them) {
  TargetSelector selector;
  selector.follow(9, true);
  const auto before = selector.on_frame({kTracks, decision(Action::track, {}, 4)}, 0s, 0);
  ck_assert(before.goal.target->x == 110);  // a frame that was decided before the choice
  const auto chosen = selector.on_frame({kTracks, decision(Action::track, {}, 9)}, 40ms, 0);
  ck_assert(chosen.goal.target->x == 320);
  ck_assert(selector.on_frame({kTracks, {}}, 80ms, 0).goal.target->x == 320);  // no decision: it is made here
  const auto only_four = std::span(kTracks).first(1);
  ck_assert_uint_eq(selector.on_frame({only_four, decision(Action::track, {}, 4)}, 6s, 0).lost, 9);
}
END_TEST

START_TEST(a_decision_between_frames_counts_until_a_frame_has_as_late_readings) {
  TargetSelector selector;
  ck_assert(!selector.on_decision(decision(Action::turn_left, 1s)));  // no frame carries decisions
  selector.on_frame({kTracks, decision(Action::hold, 1s)}, 1s, 0);
  ck_assert(!selector.on_decision(decision(Action::turn_left, 1s)));  // not newer
  ck_assert(!selector.on_decision(decision(Action::turn_left, {})));
  const auto between = selector.on_decision(decision(Action::turn_left, 1100ms));
  ck_assert(between && between->goal.action == Action::turn_left);
  // A frame that was decided earlier comes late, through a queue.
  ck_assert(selector.on_frame({kTracks, decision(Action::hold, 1050ms)}, 1040ms, 0).goal.action ==
            Action::turn_left);
  ck_assert(selector.on_frame({kTracks, decision(Action::hold, 1100ms)}, 1080ms, 0).goal.action ==
            Action::hold);
}
END_TEST

START_TEST(a_target_between_frames_waits_for_the_next_one) {
  TargetSelector selector;
  selector.on_frame({kTracks, decision(Action::hold, 1s)}, 1s, 0);
  ck_assert(!selector.on_decision(decision(Action::track, 1100ms, 4)));
  const auto next = selector.on_frame({kTracks, decision(Action::hold, 1050ms)}, 1040ms, 0);
  ck_assert(next.goal.action == Action::track && next.goal.target->x == 110);
}
END_TEST

START_TEST(another_stream_begins_without_the_decisions_before_but_with_the_chosen_track) {
  TargetSelector selector;
  selector.follow(9);
  selector.on_frame({kTracks, decision(Action::hold, 1s)}, 1s, 0);
  selector.on_decision(decision(Action::turn_left, 2s));
  selector.reset();
  ck_assert(!selector.on_decision(decision(Action::turn_left, 3s)));
  ck_assert(selector.on_frame({kTracks, decision(Action::hold, 100ms)}, 0s, 0).goal.target->x == 320);
}
END_TEST

int main() {
  return tests::run_suite("target_selector",
                          {a_decision_on_the_frame_is_the_goal_and_its_target_the_middle_of_the_track,
                           without_a_decision_the_nearest_track_is_followed_and_then_zero,
                           a_choice_that_the_decisions_make_begins_and_ends_with_them,
                           the_chosen_track_goes_before_every_decision_while_it_is_there,
                           a_decision_between_frames_counts_until_a_frame_has_as_late_readings,
                           a_target_between_frames_waits_for_the_next_one,
                           another_stream_begins_without_the_decisions_before_but_with_the_chosen_track});
}
