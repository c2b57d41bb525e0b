// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/file_names.h"

#include <check.h>
#include <stdlib.h>
#include <time.h>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;

namespace {

// 2026-11-22 16:09:29 UTC.
constexpr std::chrono::seconds kMoment(1795363769);

std::string named(const char* pattern, const NameFacts& facts) {
  setenv("TZ", "UTC", 1);
  tzset();
  return expand_name(pattern, facts);
}

void check(const std::string& expected, const std::string& name) {
  ck_assert_msg(name == expected, "%s instead of %s", name.c_str(), expected.c_str());
}

}  // namespace

START_TEST(a_name_has_date_camera_and_event) {
  check("2026-11-22/16-09-29_yard_7", named("%Y-%m-%d/%H-%M-%S_{camera}_{event}", {kMoment, "yard", 7, 1}));
}
END_TEST

START_TEST(later_parts_are_numbered) {
  check("7-3", named("{event}", {kMoment, "", 7, 3}));
  check("7.3", named("{event}.{part}", {kMoment, "", 7, 3}));
  check("7.1", named("{event}.{part}", {kMoment, "", 7, 1}));
}
END_TEST

START_TEST(a_camera_is_a_part_of_a_name_and_never_a_path_or_a_conversion) {
  check("______etc_passwd", named("{camera}", {kMoment, "../../etc/passwd", 1, 1}));
  check("100___event_", named("{camera}", {kMoment, "100% {event}", 1, 1}));
  check("Küche", named("{camera}", {kMoment, "Küche", 1, 1}));
  check("camera", named("{camera}", {kMoment, "", 1, 1}));
}
END_TEST

START_TEST(slashes_of_conversions_and_odd_components_stay_within_the_folder) {
  check("11-22-26", named("%D", {kMoment, "", 1, 1}));
  check("a/_/b", named("a/./b", {kMoment, "", 1, 1}));
  check("a_b_c", named("a%nb%tc", {kMoment, "", 1, 1}));  // a line feed and a tabulator
  ck_assert_uint_le(named("{camera}", {kMoment, std::string(1000, 'x'), 1, 1}).size(), 200);
}
END_TEST

START_TEST(patterns_that_leave_the_folder_or_mean_nothing_are_refused) {
  for (const char* bad :
       {"", "/tmp/x", "../x", "a/../b", "a//b", "a/", "{kamera}", "{camera", "a\nb", "\x7f"})
    ck_assert_msg(!name_pattern_fault(bad).empty(), "%s was taken", bad);
  for (const char* good : {"%Y/%m/%d/%H%M%S", "{camera}/{event}-{part}", "a..b", "Küche"})
    ck_assert_msg(name_pattern_fault(good).empty(), "%s was refused", good);
}
END_TEST

int main() {
  return tests::run_suite("file names", {a_name_has_date_camera_and_event, later_parts_are_numbered,
                                         a_camera_is_a_part_of_a_name_and_never_a_path_or_a_conversion,
                                         slashes_of_conversions_and_odd_components_stay_within_the_folder,
                                         patterns_that_leave_the_folder_or_mean_nothing_are_refused});
}
