// SPDX-License-Identifier: LGPL-2.1-or-later
// Settings that do not fit what is there are named once.
#include "fusion/settings_check.h"

#include <check.h>

#include "../support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;

START_TEST(another_number_of_sensors_is_named_once_for_each_pair_of_numbers) {
  SettingsCheck check;
  SensorSnapshot two{.count = 2};
  ck_assert(check.sensors("rules=paper", 0, two).empty());  // rules for any number
  const std::string text = check.sensors("rules=paper", 3, two);
  ck_assert_str_eq(text.c_str(),
                   "rules=paper is for 3 PIR sensors, and there are 2: the others never detect anything.");
  ck_assert(check.sensors("rules=paper", 3, two).empty());
  SensorSnapshot four{.count = 4};
  ck_assert(!check.sensors("rules=paper", 3, four).empty());
  SensorSnapshot three{.count = 3}, none{}, assumed{.count = 2, .geometry_known = false};
  for (const SensorSnapshot* fits : {&three, &none, &assumed})
    ck_assert(check.sensors("a file", 3, *fits).empty());
}
END_TEST

START_TEST(a_head_of_another_name_is_named_after_two_seconds_without_a_pose) {
  SettingsCheck check;
  SensorSnapshot other_head{.other_head = "attic"};
  ck_assert(check.head("head", 10s, other_head).empty());
  ck_assert(check.head("head", 11999ms, other_head).empty());
  const SensorSnapshot known{.pan_degrees = 3, .other_head = "attic"};
  ck_assert(check.head("head", 12s, known).empty());  // and patience begins anew
  ck_assert(check.head("head", 13s, other_head).empty());
  const std::string text = check.head("head", 15s, other_head);
  ck_assert(text.starts_with("Poses come from the head \"attic\"") &&
            text.find("\"head\"") != std::string::npos);
  ck_assert(check.head("head", 20s, other_head).empty());
}
END_TEST

int main() {
  return cerberus::tests::run_suite("settings_check",
                                    {another_number_of_sensors_is_named_once_for_each_pair_of_numbers,
                                     a_head_of_another_name_is_named_after_two_seconds_without_a_pose});
}
