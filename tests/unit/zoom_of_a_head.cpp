// SPDX-License-Identifier: LGPL-2.1-or-later
// What a head's camera sees, from the line of its helper to the pose: virtual time, no process.
#include "drivers/helper/helper_client.h"

#include <cmath>
#include <optional>
#include <string>

#include "support/suite.h"
#include "support/text.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;

struct Pipeline {
  HeadSetup setup;
  std::string sent;  // all lines
  HelperClient client{[this](const std::string& line) { sent += line; }};

  Pipeline() {
    setup.limits.pan = {radians(-170), radians(170), radians(90), radians(600)};
    setup.limits.tilt = {radians(-45), radians(45), radians(90), radians(600)};
  }
  void begin(const std::string& ready = "ready 1 velocity feedback") {
    ck_assert(client.open(setup).empty());
    client.begin(0s);
    client.handle(ready, 0s);
  }
  // What is sent for a command with this zoom.
  std::string order(std::optional<double> zoom, cerberus::motion::Time at, bool stop = false) {
    sent.clear();
    HeadCommand command{at, {}, {}, stop};
    command.zoom = zoom;
    ck_assert(client.accept(command).empty());
    client.execute(at);
    client.serve(at);
    return sent;
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

START_TEST(a_zoom_is_sent_once_to_a_head_that_takes_it_and_has_said_where_it_is) {
  Pipeline pipeline;
  pipeline.begin("ready 1 velocity feedback zoom");
  assert_text(pipeline.order(.5, 1s), "move hold hold\n");
  pipeline.client.handle("zoom 0.25", 1s);
  assert_text(pipeline.order(.5, 2s), "zoom 0.5\n");
  assert_text(pipeline.order({}, 3s), "");
  assert_text(pipeline.order(.75, 4s, true), "stop\n");  // a stop has none
  pipeline.client.handle("emergency pressed", 5s);
  ck_assert(pipeline.order(.75, 5s).find("zoom") == std::string::npos);
  pipeline.client.handle("emergency released", 6s);
  pipeline.client.handle("fault no lens", 6s);
  ck_assert(pipeline.order(.75, 7s).find("zoom") == std::string::npos);
  pipeline.client.handle("recovered", 8s);
  pipeline.sent.clear();
  pipeline.client.execute(8s);  // what was commanded before, once more
  ck_assert(pipeline.sent.find("zoom") == std::string::npos);
  ck_assert(pipeline.order({}, 8s).find("zoom") == std::string::npos);  // what was ordered before is over
}
END_TEST

START_TEST(a_head_that_lists_no_zoom_is_sent_none) {
  Pipeline pipeline;
  pipeline.begin();
  pipeline.client.handle("zoom 0.25", 0s);
  ck_assert(pipeline.order(.5, 1s).find("zoom") == std::string::npos);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite("zoom_of_a_head",
                                    {a_reported_zoom_becomes_the_field_of_view_of_the_table,
                                     a_head_that_reports_speeds_has_a_field_of_view_too,
                                     a_zoom_without_a_table_is_not_known_unless_it_is_locked,
                                     a_zoom_is_sent_once_to_a_head_that_takes_it_and_has_said_where_it_is,
                                     a_head_that_lists_no_zoom_is_sent_none});
}
