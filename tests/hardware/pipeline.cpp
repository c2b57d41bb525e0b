// SPDX-License-Identifier: LGPL-2.1-or-later
// A whole pipeline that turns a motor on a GPIO chip that the kernel simulates, and is killed: videotestsrc, pantiltsink
// and cerberus-head, which CERBERUS_HEAD names. `hardware-pipeline play CHIP` is that pipeline.
#include "simulated.h"  // before gst-check, whose macros C++ streams cannot bear

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>

#include <gst/check/gstcheck.h>

namespace {

using namespace std::chrono_literals;
using simulated::Chip;

gboolean turn(gpointer sink) {
  gboolean done = FALSE;
  g_signal_emit_by_name(sink, "turn", 30.0, 0.0, &done);
  return G_SOURCE_CONTINUE;
}

int play(const std::string& chip) {
  gst_init(nullptr, nullptr);
  g_autoptr(GstPlugin) plugin = gst_plugin_load_file(PLUGINS_FOLDER "/libgstvideotestsrc.so", nullptr);
  const std::string line =
      "videotestsrc is-live=true ! pantiltsink name=sink "
      "driver=stepper-gpio watchdog-timeout=0 helper-timeout=10000000000 device=" +
      chip + " device-options=\"pan='lines=2,3,4,5' late-limit=5000 release-delay=never\"";
  g_autoptr(GError) error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  if (!plugin || !pipeline || error) {
    std::printf("no pipeline: %s\n", error ? error->message : "no videotestsrc");
    return 1;
  }
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_timeout_add(100, turn, gst_bin_get_by_name(GST_BIN(pipeline), "sink"));  // it holds for 500 ms
  g_main_loop_run(g_main_loop_new(nullptr, FALSE));
  return 0;
}

// Returns how long it took until the coils were on or off, in milliseconds.
double wait_for_coils(const Chip& chip, bool off) {
  const auto took = simulated::wait_coils(chip, off, 60s);
  fail_unless(took.has_value(), "the coils are still %s", off ? "on" : "off");
  return std::chrono::duration<double, std::milli>(took.value_or(60s)).count();
}

GST_START_TEST(the_coils_are_off_when_a_pipeline_is_killed) {
  double least = 1e9, most = 0;
  for (int round = 0; round < 5; ++round) {
    const Chip chip(12);
    const pid_t pipeline = fork();
    if (pipeline == 0) {
      execl("/proc/self/exe", "hardware-pipeline", "play", chip.path().c_str(), nullptr);
      _exit(126);
    }
    wait_for_coils(chip, false);
    std::this_thread::sleep_for(53ms * round);  // other moments of the motion
    kill(pipeline, SIGKILL);
    const double took = wait_for_coils(chip, true);
    fail_unless(waitpid(pipeline, nullptr, 0) == pipeline);
    least = std::min(least, took);
    most = std::max(most, took);
    std::this_thread::sleep_for(300ms);  // the helper ends: its lines are free again
  }
  std::printf(
      "killed pipeline with frames (an emulated machine keeps no times): coils off after %.0f to %.0f ms\n",
      least, most);
}
GST_END_TEST

Suite* pipeline_suite() {
  Suite* suite = suite_create("pipeline");
  TCase* tests = tcase_create("pipeline");
  tcase_set_timeout(tests, 120);
  tcase_add_test(tests, the_coils_are_off_when_a_pipeline_is_killed);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "play") return play(argv[2]);
  gst_check_init(&argc, &argv);
  return gst_check_run_suite(pipeline_suite(), "pipeline", __FILE__);
}
