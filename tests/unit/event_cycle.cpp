// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/event_cycle.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::seconds;

namespace {

EventCycle cycle(int post_roll, int join) {
  EventCycle cycle;
  cycle.configure({seconds(post_roll), seconds(join)});
  return cycle;
}

}  // namespace

START_TEST(an_event_lasts_until_post_roll_after_its_last_trigger) {
  EventCycle event = cycle(5, 2);
  ck_assert(!event.active());
  ck_assert(event.trigger(seconds(10)));
  ck_assert(event.end() == seconds(15));
  ck_assert(!event.trigger(seconds(12)));
  ck_assert(event.end() == seconds(17));
  ck_assert(event.begin() == seconds(10));
}
END_TEST

START_TEST(a_trigger_that_arrives_late_does_not_shorten_an_event) {
  EventCycle event = cycle(5, 2);
  event.trigger(seconds(10));
  event.trigger(seconds(8));
  ck_assert(event.end() == seconds(15));
}
END_TEST

START_TEST(an_event_is_over_when_no_trigger_can_join_it) {
  EventCycle event = cycle(5, 2);
  event.trigger(seconds(10));
  ck_assert(!event.over(seconds(15)));
  ck_assert(!event.over(seconds(17)));
  ck_assert(event.over(seconds(17) + Time(1)));
}
END_TEST

START_TEST(a_held_event_has_no_end_until_it_is_released) {
  EventCycle event = cycle(5, 2);
  ck_assert(event.hold(seconds(10)));
  ck_assert(!event.over(seconds(1000)));
  ck_assert(event.end() == Time::max());
  event.release(seconds(30));
  ck_assert(event.end() == seconds(35));
  ck_assert(event.over(seconds(38)));
}
END_TEST

START_TEST(an_event_that_two_hold_lasts_until_both_release_it) {
  EventCycle event = cycle(5, 2);
  event.hold(seconds(10), Holder::application);
  event.hold(seconds(12), Holder::motion);
  event.release(seconds(20), Holder::motion);
  ck_assert(event.held() && event.end() == Time::max());
  event.release(seconds(22), Holder::motion);  // holds it no more
  event.release(seconds(30), Holder::application);
  ck_assert(!event.held() && event.end() == seconds(35));
}
END_TEST

START_TEST(releasing_what_is_not_held_changes_nothing) {
  EventCycle event = cycle(5, 2);
  event.release(seconds(3));
  ck_assert(!event.active());
  event.trigger(seconds(10));
  event.release(seconds(14));
  ck_assert(event.end() == seconds(15));
}
END_TEST

START_TEST(after_closing_the_next_trigger_begins_another_event) {
  EventCycle event = cycle(5, 2);
  event.hold(seconds(10));
  event.close();
  ck_assert(!event.active());
  ck_assert(event.trigger(seconds(50)));
  ck_assert(event.begin() == seconds(50));
  ck_assert(event.end() == seconds(55));
}
END_TEST

int main() {
  return tests::run_suite(
      "event cycle",
      {an_event_lasts_until_post_roll_after_its_last_trigger,
       a_trigger_that_arrives_late_does_not_shorten_an_event, an_event_is_over_when_no_trigger_can_join_it,
       a_held_event_has_no_end_until_it_is_released, an_event_that_two_hold_lasts_until_both_release_it,
       releasing_what_is_not_held_changes_nothing, after_closing_the_next_trigger_begins_another_event});
}
