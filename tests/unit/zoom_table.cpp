// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/zoom_table.h"

#include <numbers>
#include <string>

#include "support/says.h"
#include "support/suite.h"

namespace {

using cerberus::motion::ZoomTable;

ZoomTable table(const std::string& text) {
  ZoomTable table;
  const std::string wrong = table.parse(text);
  ck_assert_msg(wrong.empty(), "%s", wrong.c_str());
  return table;
}

double degrees(const ZoomTable& table, double position) {
  return table.field_of_view(position) * 180 / std::numbers::pi;
}

START_TEST(at_its_points_the_table_is_what_was_written) {
  const ZoomTable zoom = table("0 60; 0.5 20;1 3.2");
  ck_assert_double_eq_tol(degrees(zoom, 0), 60, 1e-9);
  ck_assert_double_eq_tol(degrees(zoom, .5), 20, 1e-9);
  ck_assert_double_eq_tol(degrees(zoom, 1), 3.2, 1e-9);
}
END_TEST

START_TEST(between_two_points_the_focal_length_grows_by_equal_factors) {
  // tan 45 = 1 and tan 11.25 = .198912: the middle has tan^-1 sqrt(.198912) = 24.03668 degrees to each side.
  ck_assert_double_eq_tol(degrees(table("0 90; 1 22.5"), .5), 48.07335, 1e-5);
  // A quarter of the way: .198912^.25 = .667829, 33.73616 degrees to each side.
  ck_assert_double_eq_tol(degrees(table("0 90; 1 22.5"), .25), 67.47232, 1e-5);
}
END_TEST

START_TEST(beyond_the_table_its_ends_hold) {
  const ZoomTable zoom = table("0.1 60; 0.9 20");
  ck_assert_double_eq_tol(degrees(zoom, 0), 60, 1e-9);
  ck_assert_double_eq_tol(degrees(zoom, 1.9), 20, 1e-9);
  ck_assert_double_eq(degrees(ZoomTable(), .5), 0);
}
END_TEST

START_TEST(a_field_of_view_has_the_position_at_which_the_camera_sees_it) {
  const ZoomTable zoom = table("0 90; 0.5 22.5; 1 3.2");
  const double degree = std::numbers::pi / 180;
  // By the numbers of the test above: half of the way to .5, and a quarter.
  ck_assert_double_eq_tol(zoom.position_for(48.07335 * degree), .25, 1e-6);
  ck_assert_double_eq_tol(zoom.position_for(67.47232 * degree), .125, 1e-6);
  ck_assert_double_eq_tol(zoom.position_for(22.5 * degree), .5, 1e-9);
  ck_assert_double_eq(zoom.position_for(120 * degree), 0);
  ck_assert_double_eq(zoom.position_for(1 * degree), 1);
  for (double position = 0; position <= 1; position += .01)
    ck_assert_double_eq_tol(zoom.position_for(zoom.field_of_view(position)), position, 1e-9);
  ck_assert_double_eq(ZoomTable().position_for(1), 0);
}
END_TEST

START_TEST(what_is_no_table_is_refused_and_changes_nothing) {
  ZoomTable zoom = table("0 60; 1 6");
  for (const char* wrong :
       {"0 60", "60", "0 60; 1", "0 60; 1 60", "0 60; 0 6", "1 60; 0 6", "0 60; 3 6", "0 60, 1 6",
        "0 180; 1 6", "0 60; 1 0", "0 60; 1 nan", "0 60; 1 6 7", "wide tele"}) {
    ck_assert(says(zoom.parse(wrong), std::string("\"") + wrong + "\" is no zoom table"));
    ck_assert_double_eq_tol(degrees(zoom, 1), 6, 1e-9);
  }
  ck_assert(zoom.parse("").empty() && zoom.empty());
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "zoom_table",
      {at_its_points_the_table_is_what_was_written,
       between_two_points_the_focal_length_grows_by_equal_factors, beyond_the_table_its_ends_hold,
       a_field_of_view_has_the_position_at_which_the_camera_sees_it,
       what_is_no_table_is_refused_and_changes_nothing});
}
