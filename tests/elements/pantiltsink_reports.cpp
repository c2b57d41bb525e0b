// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink with a VISCA camera whose reports of its position are wrong: the real program cerberus-head and an emulated
// camera. tests/unit/report_watch.cpp has the kinds of such reports.
#include <cmath>

#include "visca_rig.h"

#include <gst/check/gstcheck.h>  // last: it defines fail()

namespace {

using namespace visca_rig;

// Sent to the right, the camera is stopped by a fault before it has turned so far, degrees; on a busy machine twice as far.
void check_fault(std::function<double(double)> says, double most) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  camera.set_reported_pan(std::move(says));
  Pipeline p(camera.device(), "max-speed=30");
  fail_unless(until([&] { return p.move_to(160) && camera.speed() > 5; }));
  const auto faulty = [&] { return p.warnings().find("the head reports ") != std::string::npos; };
  fail_unless(until(faulty), "%s", p.warned.c_str());
  fail_unless(until([&] { return camera.speed() == 0; }));
  fail_unless(camera.pan() < (g_getenv("CERBERUS_KILLS") ? most : 2 * most), "%g", camera.pan());
  fail_unless(p.warned.find("It was stopped, and stands until the next order") != std::string::npos, "%s",
              p.warned.c_str());
  // The frames that follow do not move it; an order does.
  const int moves = camera.moves();
  std::this_thread::sleep_for(500ms);
  fail_unless_equals_int(camera.moves(), moves);
  fail_unless(until([&] { return p.move_to(-160) && camera.speed() < -5; }));
}

}  // namespace

// 30 degrees a second: they part by 10 + 30 (.06 + .5) = 27 degrees, and a second passes. Reversed, the camera is driven
// the faster, up to its 30 degrees a second.
GST_START_TEST(a_camera_with_reversed_reports_is_stopped) {
  check_fault([](double pan) { return -pan; }, 75);
}
GST_END_TEST

GST_START_TEST(a_camera_that_reports_the_same_for_ever_is_stopped) {
  check_fault([](double) { return 0; }, 105);
}
GST_END_TEST

GST_START_TEST(a_camera_whose_reports_jump_is_stopped) {
  check_fault([k = 0](double pan) mutable { return ++k % 2 ? pan : pan - 120; }, 160);
}
GST_END_TEST

GST_START_TEST(a_camera_that_moves_by_itself_is_a_fault_at_rest) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  camera.set_reported_pan([begin = Clock::now()](double pan) {
    return pan + 8 * std::chrono::duration<double>(Clock::now() - begin).count();
  });
  Pipeline p(camera.device());
  fail_unless(until([&] { return p.warnings().find("the head reports ") != std::string::npos; }));
  fail_unless_equals_int(camera.moves(), 0);
}
GST_END_TEST

// It looks to the left when the pipeline begins.
GST_START_TEST(the_published_pose_stays_when_the_reports_cease) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  camera.set_reported_pan([](double pan) { return pan - 47; });
  Pipeline p(camera.device(), "max-speed=30");
  fail_unless(until([&] { return p.pan() < -46.5 && p.pan() > -47.5; }), "%g", p.pan());
  fail_unless(
      until([&] { return p.move_to(-20) && std::abs(camera.pan() - 27) < 1 && camera.speed() == 0; }));
  fail_unless(until([&] { return std::abs(p.pan() + 20) < 1; }), "%g", p.pan());
  camera.set_reported_pan([](double) { return NAN; });
  for (int k = 0; k < 20; ++k) {
    std::this_thread::sleep_for(100ms);
    fail_unless(std::abs(p.pan() + 20) < 1.5, "%g", p.pan());
  }
}
GST_END_TEST

static Suite* pantiltsink_reports_suite() {
  Suite* suite = suite_create("pantiltsink whose camera reports wrong positions");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_test(tests, a_camera_with_reversed_reports_is_stopped);
  tcase_add_test(tests, a_camera_that_reports_the_same_for_ever_is_stopped);
  tcase_add_test(tests, a_camera_whose_reports_jump_is_stopped);
  tcase_add_test(tests, a_camera_that_moves_by_itself_is_a_fault_at_rest);
  tcase_add_test(tests, the_published_pose_stays_when_the_reports_cease);
  return suite;
}
GST_CHECK_MAIN(pantiltsink_reports)
