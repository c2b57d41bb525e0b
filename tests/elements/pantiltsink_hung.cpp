// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink whose helper process hangs while its head turns: the real program cerberus-head and an emulated VISCA camera.
#include <signal.h>

#include <cmath>
#include <string>

#include "support/children.h"
#include "support/time_bounds.h"
#include "visca_rig.h"

#include <gst/check/gstcheck.h>  // last: it defines fail()

namespace {

using namespace visca_rig;
using cerberus::tests::children;

constexpr char kHelper[] = "cerberus-head";
// 500 ms for the answer, 250 ms until it is asked for, and the start of a process; in a second on a machine at rest. A busy
// one has five times as long.
constexpr auto kStop = 2s;

void check_stop(Clock::time_point hung, ViscaCamera& camera) {
  fail_unless(until([&] { return camera.speed() == 0; }));
  const auto took = camera.stopped() - hung;
  fail_unless(took < 5 * kStop && cerberus::tests::in_time(took, kStop), "%g s",
              std::chrono::duration<double>(took).count());
}

// Stops the helper's process while the camera turns. Returns when.
Clock::time_point hang() {
  const auto helpers = children(kHelper);
  fail_unless_equals_uint64(helpers.size(), 1);
  fail_unless(kill(helpers.front(), SIGSTOP) == 0);
  return Clock::now();
}

ViscaFaults without_positions() {
  ViscaFaults faults;
  faults.reports = false;
  return faults;
}

}  // namespace

GST_START_TEST(a_camera_whose_helper_hangs_is_stopped_by_another_one_and_the_fault_names_the_program) {
  for (const ViscaFaults& faults : {ViscaFaults{}, without_positions()})
    for (const auto line : {ViscaCamera::Line::udp, ViscaCamera::Line::serial}) {
      ViscaCamera camera(line, faults);
      Pipeline p(camera.device());
      fail_unless(until([&] { return p.move_to(160) && camera.speed() > 5; }));
      const auto hung = hang();
      check_stop(hung, camera);
      fail_unless(until([&] { return p.warnings().find("hangs") != std::string::npos; }));
      fail_unless(p.warned.find("`cerberus-head visca of " + camera.device() + "`") != std::string::npos,
                  "%s", p.warned.c_str());
      // It stands until the next order, which the new one obeys.
      fail_unless(until([&] { return p.move_to(-160) && camera.speed() < -5; }));
    }
}
GST_END_TEST

GST_START_TEST(a_camera_whose_helper_hangs_as_the_pipeline_ends_is_stopped) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  Pipeline p(camera.device());
  fail_unless(until([&] { return p.move_to(160) && camera.speed() > 5; }));
  const auto hung = hang();
  p.stop();
  check_stop(hung, camera);
  fail_unless(until([] { return children(kHelper).empty(); }));
}
GST_END_TEST

GST_START_TEST(a_helper_that_rests_and_hangs_is_replaced_too) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  Pipeline p(camera.device());
  fail_unless(until([&] { return p.move_to(5) && std::abs(camera.pan() - 5) < 1 && camera.speed() == 0; }));
  hang();
  fail_unless(until([&] { return p.warnings().find("hangs") != std::string::npos; }));
  fail_unless(until([&] { return p.move_to(-160) && camera.speed() < -5; }));
}
GST_END_TEST

// It does not answer for less than the promise allows, as on a machine that is busy.
GST_START_TEST(a_helper_that_is_late_is_left_alone) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  Pipeline p(camera.device());
  fail_unless(until([&] { return p.move_to(160) && camera.speed() > 5; }));
  const auto helpers = children(kHelper);
  fail_unless_equals_uint64(helpers.size(), 1);
  for (int k = 0; k < 5; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    kill(helpers.front(), SIGSTOP);
    std::this_thread::sleep_for(200ms);
    kill(helpers.front(), SIGCONT);
    // A machine that is so busy has stopped it for longer than the promise allows.
    if (std::chrono::steady_clock::now() - begin >= 400ms) return;
    std::this_thread::sleep_for(100ms);
  }
  fail_unless(p.warnings().find("hangs") == std::string::npos, "%s", p.warned.c_str());
  fail_unless(children(kHelper) == helpers);
}
GST_END_TEST

static Suite* pantiltsink_hung_suite() {
  Suite* suite = suite_create("pantiltsink whose helper hangs");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_test(tests,
                 a_camera_whose_helper_hangs_is_stopped_by_another_one_and_the_fault_names_the_program);
  tcase_add_test(tests, a_camera_whose_helper_hangs_as_the_pipeline_ends_is_stopped);
  tcase_add_test(tests, a_helper_that_rests_and_hangs_is_replaced_too);
  tcase_add_test(tests, a_helper_that_is_late_is_left_alone);
  return suite;
}
GST_CHECK_MAIN(pantiltsink_hung)
