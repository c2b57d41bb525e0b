// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/trigger_zones.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using vision::Size;

namespace {
constexpr Size kFrame{200, 100};
}

START_TEST(without_polygons_everything_is_inside) {
  TriggerZones zones;
  ck_assert(zones.contains({0, 0, 10, 10}, kFrame));
  ck_assert((zones.parse("")).empty());
  ck_assert(zones.contains({190, 90, 10, 10}, kFrame));
}
END_TEST

START_TEST(the_middle_of_the_lower_edge_decides) {
  TriggerZones zones;
  ck_assert((zones.parse("include 0,0.5 0.5,0.5 0.5,1 0,1")).empty());  // the lower left quarter
  ck_assert(zones.contains({40, 20, 20, 40}, kFrame));                  // feet at 50, 60
  ck_assert(!zones.contains({40, 0, 20, 40}, kFrame));                  // at 50, 40
  ck_assert(!zones.contains({95, 20, 20, 40}, kFrame));                 // at 105, 60
  ck_assert(zones.contains({85, 20, 20, 40}, kFrame));                  // at 95, 60
}
END_TEST

START_TEST(a_box_that_reaches_beyond_the_frame_stands_at_its_edge) {
  TriggerZones zones;
  ck_assert((zones.parse("exclude 0,0.9 1,0.9 1,1 0,1")).empty());
  ck_assert(!zones.contains({0, 50, 20, 500}, kFrame));
  ck_assert(zones.contains({-500, 50, 20, 20}, kFrame));
}
END_TEST

START_TEST(a_wrong_text_is_named_and_changes_nothing) {
  TriggerZones zones;
  ck_assert((zones.parse("include 0,0 1,0 1,0.1 0,0.1")).empty());
  ck_assert(!(zones.parse("incloud 0,0 1,0 1,1")).empty());
  ck_assert(!zones.contains({0, 40, 10, 10}, kFrame));
}
END_TEST

START_TEST(a_frame_of_unknown_size_is_inside) {
  TriggerZones zones;
  ck_assert((zones.parse("include 0,0 1,0 1,0.1 0,0.1")).empty());
  ck_assert(zones.contains({0, 40, 10, 10}, {}));
}
END_TEST

// A lens of 90 degrees over 200 pixels: focal length 100. Feet at column 150 are 26.6 degrees to the right.
START_TEST(zones_of_the_world_follow_the_camera) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const auto camera = [&](double pan) {
    return vision::CameraOrientation{vision::Lens(90 * kDegree, kFrame), pan * kDegree, 0};
  };
  TriggerZones zones;
  ck_assert((zones.parse("include world 20,80 40,80 40,-80 20,-80")).empty());
  const vision::Box right{140, 20, 20, 40};
  ck_assert(zones.contains(right, kFrame, camera(0)));
  ck_assert(!zones.contains(right, kFrame, camera(20)));
  ck_assert(zones.contains(right, kFrame, {}));
  ck_assert((zones.parse("exclude world 20,80 40,80 40,-80 20,-80")).empty());
  ck_assert(!zones.contains(right, kFrame, camera(0)));
  ck_assert(zones.contains(right, kFrame, camera(20)));
  ck_assert(zones.contains(right, kFrame, {}));
}
END_TEST

int main() {
  Suite* suite = suite_create("trigger zones");
  TCase* cases = tcase_create("trigger zones");
  for (const TTest* test :
       {without_polygons_everything_is_inside, the_middle_of_the_lower_edge_decides,
        a_box_that_reaches_beyond_the_frame_stands_at_its_edge, a_wrong_text_is_named_and_changes_nothing,
        a_frame_of_unknown_size_is_inside, zones_of_the_world_follow_the_camera})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
