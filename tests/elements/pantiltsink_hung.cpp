// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink whose helper process hangs while its head turns: the real program cerberus-head and an emulated VISCA camera.
#include <signal.h>

#include <chrono>
#include <string>
#include <thread>

#include "support/children.h"
#include "support/visca_camera.h"

#include <gst/check/gstcheck.h>  // last: it defines fail()

namespace {

using namespace std::chrono_literals;
using cerberus::tests::children;
using cerberus::tests::ViscaCamera;
using cerberus::tests::ViscaFaults;
using Clock = std::chrono::steady_clock;

constexpr char kHelper[] = "cerberus-head";
// 500 ms for the answer, 250 ms until it is asked for, and the start of a process; in a second on a machine at rest.
constexpr auto kStop = 2s;

template <typename Condition>
bool until(Condition holds) {
  for (const auto end = Clock::now() + 30s; Clock::now() < end; std::this_thread::sleep_for(5ms))
    if (holds()) return true;
  return false;
}

struct Pipeline {
  GstElement *pipeline, *head;
  std::string warned;

  explicit Pipeline(const std::string& device, const char* properties = "") {
    g_autoptr(GError) error = nullptr;
    const std::string line =
        "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=25/1 ! pantiltsink name=head "
        "driver=visca watchdog-timeout=0 device=" +
        device + " " + properties;
    pipeline = gst_parse_launch(line.c_str(), &error);
    fail_unless(pipeline && !error, "%s", error ? error->message : "");
    head = gst_bin_get_by_name(GST_BIN(pipeline), "head");
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
  }
  ~Pipeline() {
    stop();
    gst_object_unref(head);
    gst_object_unref(pipeline);
  }
  Pipeline(const Pipeline&) = delete;
  void stop() const { gst_element_set_state(pipeline, GST_STATE_NULL); }
  bool move_to(double pan) const {
    gboolean done = FALSE;
    g_signal_emit_by_name(head, "move-to", pan, 0.0, &done);
    return done;
  }
  // The texts of all warnings so far.
  const std::string& warnings() {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      warned.append(error->message).append("\n");
      gst_message_unref(message);
    }
    return warned;
  }
  // Stops the helper's process while the camera turns. Returns when.
  static Clock::time_point hang() {
    const auto helpers = children(kHelper);
    fail_unless_equals_uint64(helpers.size(), 1);
    fail_unless(kill(helpers.front(), SIGSTOP) == 0);
    return Clock::now();
  }
};

double seconds_since(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
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
      const auto hung = Pipeline::hang();
      fail_unless(until([&] { return camera.speed() == 0; }));
      fail_unless(seconds_since(hung, camera.stopped()) < seconds_since({}, Clock::time_point(kStop)), "%g s",
                  seconds_since(hung, camera.stopped()));
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
  const auto hung = Pipeline::hang();
  p.stop();
  fail_unless(until([&] { return camera.speed() == 0; }));
  fail_unless(seconds_since(hung, camera.stopped()) < seconds_since({}, Clock::time_point(kStop)), "%g s",
              seconds_since(hung, camera.stopped()));
  fail_unless(until([] { return children(kHelper).empty(); }));
}
GST_END_TEST

GST_START_TEST(a_helper_that_rests_and_hangs_is_replaced_too) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  Pipeline p(camera.device());
  fail_unless(until([&] { return p.move_to(5) && std::abs(camera.pan() - 5) < 1 && camera.speed() == 0; }));
  Pipeline::hang();
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
    kill(helpers.front(), SIGSTOP);
    std::this_thread::sleep_for(200ms);
    kill(helpers.front(), SIGCONT);
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
