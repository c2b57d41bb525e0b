// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink with driver=onvif, its helper process and an emulated camera: from the element to the motors and back.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>

#include "support/onvif_camera.h"

#include <gst/check/gstcheck.h>  // last: it defines fail()

extern char** environ;

namespace {

using namespace std::chrono_literals;
using cerberus::tests::OnvifCamera;
using cerberus::tests::OnvifFaults;
using Clock = std::chrono::steady_clock;

constexpr char kSpeeds[] = "pan-speed=100 tilt-speed=50";

GstElement* make_pipeline(const std::string& device, const std::string& options) {
  g_autoptr(GError) error = nullptr;
  GstElement* pipeline = gst_parse_launch(
      "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=25/1 ! pantiltsink name=head "
      "driver=onvif",
      &error);
  if (!pipeline)
    g_error("%s", error ? error->message : "no pipeline");  // not by check: also used outside of its tests
  g_autoptr(GstElement) head = gst_bin_get_by_name(GST_BIN(pipeline), "head");
  g_object_set(head, "device", device.c_str(), "device-options", options.c_str(), nullptr);
  return pipeline;
}

gboolean move_to(GstElement* pipeline, double pan) {
  g_autoptr(GstElement) head = gst_bin_get_by_name(GST_BIN(pipeline), "head");
  gboolean done = FALSE;
  g_signal_emit_by_name(head, "move-to", pan, 0.0, &done);
  return done;
}

// A pipeline of its own process, which turns the head as far as it goes until it is killed.
int run_pipeline(const char* device) {
  GstElement* pipeline = make_pipeline(device, kSpeeds);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (;; std::this_thread::sleep_for(20ms)) move_to(pipeline, 160);
}

template <typename Condition>
bool until(Condition holds) {
  for (const auto end = Clock::now() + 15s; Clock::now() < end; std::this_thread::sleep_for(5ms))
    if (holds()) return true;
  return false;
}

void stop(GstElement* pipeline) {
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

// The texts of the first error on the bus.
std::string error_of(GstElement* pipeline) {
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, 15 * GST_SECOND, GST_MESSAGE_ERROR);
  if (!message) return "no error";
  g_autoptr(GError) error = nullptr;
  g_autofree char* debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  return std::string(error->message) + " / " + (debug ? debug : "");
}

}  // namespace

GST_START_TEST(an_order_turns_the_camera_to_the_angle_and_the_end_stops_it) {
  OnvifCamera camera;
  GstElement* pipeline =
      make_pipeline(camera.device(), std::string(kSpeeds) + " range=-170,170,-90,90 no-absolute");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  fail_unless(until([&] { return move_to(pipeline, 40) && camera.speed() > 0; }));
  // Repeated: on a machine that stops for longer than the watchdog's time, the head stands until the next order.
  fail_unless(until([&] {
                return move_to(pipeline, 40) && camera.speed() == 0 && std::abs(camera.pan() - 40) < 1.5;
              }),
              "%g", camera.pan());
  fail_unless(until([&] { return move_to(pipeline, -100) && camera.speed() < 0; }));
  stop(pipeline);
  fail_unless(until([&] { return camera.speed() == 0; }));
}
GST_END_TEST

// The camera ignores its Timeout: the helper process alone stops it.
GST_START_TEST(a_pipeline_that_is_killed_leaves_no_camera_turning) {
  const char* wanted = g_getenv("CERBERUS_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 2;
  double longest = 0;
  for (int k = 0; k < kills; ++k) {
    OnvifFaults faults;
    faults.ignores_timeout = true;
    OnvifCamera camera(faults);
    std::string self = "/proc/self/exe", mode = "pipeline", device = camera.device();
    char* words[] = {self.data(), mode.data(), device.data(), nullptr};
    pid_t child = 0;
    fail_unless(posix_spawn(&child, self.c_str(), nullptr, nullptr, words, environ) == 0);
    const bool turned = until([&] { return camera.speed() > 1; });
    std::this_thread::sleep_for(std::chrono::milliseconds(g_random_int_range(0, 300)));
    const auto killed = Clock::now();
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    fail_unless(turned);
    fail_unless(until([&] { return camera.speed() == 0; }));
    const double milliseconds = std::chrono::duration<double, std::milli>(camera.stopped() - killed).count();
    longest = std::max(longest, milliseconds);
    fail_unless(milliseconds < 500, "stopped after %g ms", milliseconds);
  }
  if (wanted)
    g_print("%d pipelines killed; the longest time until the camera stood: %.0f ms\n", kills, longest);
}
GST_END_TEST

GST_START_TEST(a_password_in_a_property_is_refused_and_shown_nowhere) {
  for (const bool in_device : {true, false}) {
    GstElement* pipeline =
        make_pipeline(in_device ? "http://admin:hunter2@127.0.0.1:1" : "http://127.0.0.1:1",
                      in_device ? "user=admin" : "user=admin password=hunter2");
    g_autofree char* graph = gst_debug_bin_to_dot_data(GST_BIN(pipeline), GST_DEBUG_GRAPH_SHOW_ALL);
    fail_unless(strstr(graph, "hunter2") == nullptr);
    fail_unless(strstr(graph, "***") != nullptr);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    const std::string error = error_of(pipeline);
    fail_unless(error.find("a password is not given in device or device-options") != std::string::npos, "%s",
                error.c_str());
    fail_unless(error.find("hunter2") == std::string::npos);
    stop(pipeline);
  }
}
GST_END_TEST

GST_START_TEST(a_password_comes_from_the_environment_and_a_wrong_one_is_an_error) {
  OnvifFaults faults;
  faults.user = "admin";
  faults.password = "right";
  for (const bool right : {true, false}) {
    OnvifCamera camera(faults);
    g_setenv("CERBERUS_TEST_PASSWORD", right ? "right" : "wrong", TRUE);
    GstElement* pipeline = make_pipeline(
        camera.device(), std::string(kSpeeds) + " user=admin password-env=CERBERUS_TEST_PASSWORD");
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    if (right) {
      fail_unless(until([&] { return move_to(pipeline, 40) && camera.speed() > 0; }));
    } else {
      const std::string error = error_of(pipeline);
      fail_unless(error.find("refuses the login of the user \"admin\"") != std::string::npos, "%s",
                  error.c_str());
    }
    stop(pipeline);
  }
}
GST_END_TEST

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "pipeline") {
    gst_init(nullptr, nullptr);
    return run_pipeline(argv[2]);
  }
  gst_check_init(&argc, &argv);
  Suite* suite = suite_create("pantiltsink with an ONVIF camera");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 600);
  tcase_add_test(tests, an_order_turns_the_camera_to_the_angle_and_the_end_stops_it);
  tcase_add_test(tests, a_pipeline_that_is_killed_leaves_no_camera_turning);
  tcase_add_test(tests, a_password_in_a_property_is_refused_and_shown_nowhere);
  tcase_add_test(tests, a_password_comes_from_the_environment_and_a_wrong_one_is_an_error);
  return gst_check_run_suite(suite, "pantiltsink_onvif", __FILE__);
}
