// SPDX-License-Identifier: LGPL-2.1-or-later
// When a helper process counts as hung, in the test's own time.
#include "drivers/helper/helper_watch.h"

#include <string>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::tests::assert_text;

namespace {

struct Rig {
  HelperWatch watch;
  Time now = 1000s;
  bool turning = true;
  std::string hung;

  explicit Rig(const char* ready) {
    watch.begin(now);
    if (*ready) take(ready);
  }
  void take(const char* line) { watch.take(*parse_helper_line(line)); }
  // Looks every `period` for so long, or until it counts as hung; it says then how long that took.
  Time look(Time length, Time period = 50ms) {
    const Time begin = now;
    while (hung.empty() && now < begin + length) {
      now += period;
      hung = watch.judge(now, turning);
    }
    return now - begin;
  }
};

}  // namespace

START_TEST(a_helper_with_alive_has_half_a_second_for_its_answer) {
  Rig rig("ready 1 velocity alive");
  rig.watch.ask();
  const Time took = rig.look(10s);
  assert_text(rig.hung, "it has not answered `alive` for 0.5 s");
  ck_assert(took > 500ms && took <= 600ms);
}
END_TEST

START_TEST(a_helper_that_answers_late_but_in_time_is_not_hung) {
  Rig rig("ready 1 velocity alive");
  for (int k = 0; k < 20; ++k) {
    rig.watch.ask();
    rig.look(450ms);
    assert_text(rig.hung, "");
    rig.take("alive");
  }
  rig.look(10s);  // it was not asked again
  assert_text(rig.hung, "");
}
END_TEST

// Each look comes a second late, because the whole machine is busy: it counts as 100 ms.
START_TEST(a_judge_that_is_late_itself_counts_little_of_the_time) {
  Rig rig("ready 1 velocity alive");
  rig.watch.ask();
  rig.look(4s, 1s);
  assert_text(rig.hung, "");
  rig.look(60s, 1s);
  ck_assert(!rig.hung.empty());  // but the helper does not hang for ever
}
END_TEST

START_TEST(other_lines_are_no_answer_of_a_helper_with_alive) {
  Rig rig("ready 1 velocity feedback alive");
  rig.watch.ask();
  for (int k = 0; k < 20 && rig.hung.empty(); ++k) {
    rig.take("pose 1 2 0 0 0");
    rig.look(50ms);
  }
  assert_text(rig.hung, "it has not answered `alive` for 0.5 s");
}
END_TEST

START_TEST(a_helper_with_feedback_alone_is_judged_by_its_poses_while_its_head_is_to_turn) {
  Rig rig("ready 1 velocity feedback");
  rig.turning = false;
  rig.watch.ask();
  rig.look(60s);
  assert_text(rig.hung, "");
  rig.turning = true;
  for (int k = 0; k < 20; ++k) {
    rig.look(900ms);
    rig.take("pose 1 2 0 0 0");
  }
  assert_text(rig.hung, "");
  const Time took = rig.look(10s);
  assert_text(rig.hung, "it has sent no `pose` for 1 s while its head was to turn");
  ck_assert(took > 1s && took <= 1100ms);
}
END_TEST

// It may hang just before the head is to stop, and leave it turning.
START_TEST(a_helper_with_feedback_alone_owes_one_pose_after_its_head_was_to_turn) {
  Rig rig("ready 1 velocity feedback");
  rig.look(500ms);
  rig.turning = false;
  ck_assert(rig.watch.waits());
  const Time took = rig.look(10s);
  assert_text(rig.hung, "it has sent no `pose` for 1 s after its head was to turn");
  ck_assert(took > 500ms && took <= 600ms);
  Rig stopped("ready 1 velocity feedback");
  stopped.look(500ms);
  stopped.turning = false;
  stopped.look(50ms);
  stopped.take("pose 1 2 0 0 0");
  stopped.look(60s);
  assert_text(stopped.hung, "");
  ck_assert(!stopped.watch.waits());
}
END_TEST

START_TEST(nothing_is_known_of_a_helper_that_promises_nothing) {
  Rig rig("ready 1 velocity");
  rig.watch.ask();
  rig.look(60s);
  assert_text(rig.hung, "");
  ck_assert(!rig.watch.waits());
}
END_TEST

START_TEST(a_helper_that_does_not_become_ready_hangs) {
  Rig rig("");
  rig.look(4900ms);
  assert_text(rig.hung, "");
  rig.look(1s);
  assert_text(rig.hung, "it has not become ready for 5 s");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "helper_watch",
      {a_helper_with_alive_has_half_a_second_for_its_answer,
       a_helper_that_answers_late_but_in_time_is_not_hung,
       a_judge_that_is_late_itself_counts_little_of_the_time,
       other_lines_are_no_answer_of_a_helper_with_alive,
       a_helper_with_feedback_alone_is_judged_by_its_poses_while_its_head_is_to_turn,
       a_helper_with_feedback_alone_owes_one_pose_after_its_head_was_to_turn,
       nothing_is_known_of_a_helper_that_promises_nothing, a_helper_that_does_not_become_ready_hangs});
}
