// SPDX-License-Identifier: LGPL-2.1-or-later
// What a head's camera sees, from the line of its helper to the pose: virtual time, no process.
#include "drivers/helper/helper_client.h"

#include <cmath>
#include <string>

#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

struct Pipeline {
  HeadSetup setup;
  HelperClient client{[](const std::string&) {}};

  Pipeline() {
    setup.limits.pan = {radians(-170), radians(170), radians(90), radians(600)};
    setup.limits.tilt = {radians(-45), radians(45), radians(90), radians(600)};
  }
  void begin() {
    ck_assert(client.open(setup).empty());
    client.begin(0s);
    client.handle("ready 1 velocity feedback", 0s);
  }
  double field_of_view(cerberus::motion::Time at) {
    cerberus::motion::Pose pose;
    ck_assert(client.state(at, pose).empty());
    return degrees(pose.field_of_view);
  }
};

START_TEST(a_reported_zoom_becomes_the_field_of_view_of_the_table) {
  Pipeline pipeline;
  ck_assert(pipeline.setup.zoom_table.parse("0 60; 0.5 20; 1 3.2").empty());
  pipeline.begin();
  ck_assert_double_eq(pipeline.field_of_view(1s), 0);  // nothing was reported yet
  pipeline.client.handle("zoom 0.5", 1s);
  ck_assert_double_eq_tol(pipeline.field_of_view(2s), 20, 1e-9);
  pipeline.client.handle("zoom 1", 2s);
  ck_assert_double_eq_tol(pipeline.field_of_view(3s), 3.2, 1e-9);
  pipeline.client.begin(4s);  // another helper: nothing is known again
  ck_assert_double_eq(pipeline.field_of_view(5s), 0);
}
END_TEST

START_TEST(a_head_that_reports_speeds_has_a_field_of_view_too) {
  Pipeline pipeline;
  ck_assert(pipeline.setup.zoom_table.parse("0 60; 1 6").empty());
  pipeline.begin();
  pipeline.client.handle("speeds 0 0 0", 0s);
  pipeline.client.handle("zoom 0", 0s);
  ck_assert_double_eq_tol(pipeline.field_of_view(1s), 60, 1e-9);
}
END_TEST

START_TEST(a_zoom_without_a_table_is_not_known_unless_it_is_locked) {
  Pipeline open;
  open.begin();
  open.client.handle("zoom 0.5", 0s);
  ck_assert(std::isnan(open.field_of_view(1s)));
  Pipeline locked;
  locked.setup.lock_zoom = .5;
  locked.begin();
  locked.client.handle("zoom 0.5", 0s);
  ck_assert_double_eq(locked.field_of_view(1s), 0);  // horizontal-fov is that of the locked zoom
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite("zoom_of_a_head",
                                    {a_reported_zoom_becomes_the_field_of_view_of_the_table,
                                     a_head_that_reports_speeds_has_a_field_of_view_too,
                                     a_zoom_without_a_table_is_not_known_unless_it_is_locked});
}
