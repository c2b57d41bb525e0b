// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/deferred_notifications.h"

#include <check.h>

#include <string>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::control;

using Entry = NotificationQueue::Of<Notice>;

START_TEST(a_status_replaces_an_older_one_of_the_same_head_whatever_its_content) {
  ck_assert(NotificationQueue::replaces(Entry{"a", Status{HeadState::turning, "left", {}, {}}},
                                        Entry{"a", Status{HeadState::stopped, "", {}, {}}}));
}
END_TEST

START_TEST(another_notice_is_replaced_by_an_equal_one_only) {
  const auto replaces = [](const Notice& newer, const Notice& older) {
    return NotificationQueue::replaces(Entry{"a", newer}, Entry{"a", older});
  };
  ck_assert(replaces(Refusal{"busy"}, Refusal{"busy"}));
  ck_assert(!replaces(Refusal{"busy"}, Refusal{"gone"}));
  ck_assert(replaces(Fault{"no power"}, Fault{"no power"}));
  ck_assert(!replaces(Fault{"no power"}, Fault{"too hot"}));
  ck_assert(replaces(Lost{7}, Lost{7}));
  ck_assert(!replaces(Lost{7}, Lost{8}));
}
END_TEST

START_TEST(notices_of_different_kinds_do_not_replace_each_other) {
  const Notice all[] = {Status{}, Refusal{"x"}, Fault{"x"}, Lost{7}};
  for (const Notice& newer : all)
    for (const Notice& older : all)
      ck_assert(NotificationQueue::replaces(Entry{"a", newer}, Entry{"a", older}) == (&newer == &older));
}
END_TEST

START_TEST(notices_of_two_heads_do_not_replace_each_other) {
  for (const Notice& notice : {Notice(Status{}), Notice(Refusal{"x"}), Notice(Fault{"x"}), Notice(Lost{7})}) {
    ck_assert(!NotificationQueue::replaces(Entry{"a", notice}, Entry{"b", notice}));
    ck_assert(!NotificationQueue::replaces(Entry{"a", notice}, Entry{nullptr, notice}));
  }
}
END_TEST

// The queue holds 256: of 300 statuses the last ones stay, and of each head the warnings.
START_TEST(a_full_queue_loses_statuses_and_neither_a_warning_nor_another_heads_status) {
  NotificationQueue queue;
  std::atomic<const char*> head = "a";
  DeferredNotifications out(queue, head);
  out.add(Fault{"no power"});
  out.add(Fault{"too hot"});
  out.add(Notice(Status{HeadState::fault, "of a", {}, {}}));
  head = "b";
  for (int k = 0; k < 300; ++k) out.add(Notice(Status{HeadState::turning, std::to_string(k), {}, {}}));
  std::string sent;
  int statuses = 0;
  out.send([](const char*, const motion::Pose&) {},
           [&](const char* whose, const Notice& notice) {
             if (const auto* fault = std::get_if<Fault>(&notice))
               sent += std::string(whose) + " " + fault->what + ". ";
             if (const auto* status = std::get_if<Status>(&notice)) {
               if (*whose == 'a') sent += "a " + status->reason + ". ";
               statuses += *whose == 'b';
               if (status->reason == "299") sent += "b 299. ";
             }
           });
  ck_assert_str_eq(sent.c_str(), "a no power. a too hot. a of a. b 299. ");
  ck_assert_int_eq(statuses, 253);
}
END_TEST

int main() {
  return tests::run_suite(
      "deferred_notifications",
      {a_status_replaces_an_older_one_of_the_same_head_whatever_its_content,
       another_notice_is_replaced_by_an_equal_one_only, notices_of_different_kinds_do_not_replace_each_other,
       notices_of_two_heads_do_not_replace_each_other,
       a_full_queue_loses_statuses_and_neither_a_warning_nor_another_heads_status});
}
