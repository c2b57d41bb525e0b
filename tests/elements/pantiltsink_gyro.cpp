// SPDX-License-Identifier: LGPL-2.1-or-later
// A gyro on the base (base-gyro of pantiltsink): a folder of files stands for the kernel's device.
#include <filesystem>
#include <fstream>
#include <string>

#include "../support/says.h"
#include "head_rig.h"

namespace {

using namespace head_rig;

// It turns at 10 degrees a second to the right, all of which is bias while the base stands.
class Gyro {
 public:
  Gyro() {
    char name[] = "/tmp/cerberus-gyro-XXXXXX";
    fail_unless(mkdtemp(name) != nullptr);
    folder_ = name;
    write("in_anglvel_scale", "0.017453292519943295");  // raw values are degrees a second
    write("in_anglvel_z_raw", "-10");
  }
  ~Gyro() { std::filesystem::remove_all(folder_); }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ + "/" + file) << text << '\n';
  }
  std::string property() const { return "watchdog-timeout=0 base-gyro=" + folder_; }

 private:
  std::string folder_;
};

// A frame of a standing camera, taken at `pts`.
GstBuffer* still_frame(GstClockTime pts, guint age) {
  GstBuffer* buffer = frame_with(CERBERUS_FUSION_HOLD, pts);
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.confidence = 1;
  motion.still = TRUE;
  motion.from = pts - kFrame;
  motion.scene_age = age;
  motion.path_id = 1;
  for (const int i : {0, 4, 8}) motion.matrix[i] = motion.path[i] = 1;
  cerberus_buffer_set_camera_motion(buffer, &motion);
  return buffer;
}

// The first rate that goes upstream meanwhile; NaN: none. The gyro is read in real time, 50 times a second.
double next_rate(Rig& rig, GstClockTime patience = 50 * GST_MSECOND) {
  fail_if(gst_bus_timed_pop_filtered(rig.bus, patience, GST_MESSAGE_ERROR), "an error came");
  double rate = NAN;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(rig.harness)) {
    if (std::isnan(rate)) parse_base(event, &rate, nullptr);
    gst_event_unref(event);
  }
  return rate;
}

// The rate after the base has stood, as `tell(rig, from)` says for the second from that running time on, in whose
// middle the clock stands. Samples are taken at their own pace, so it is sent again until there were enough of them.
template <typename Tell>
double rate_after_standing(Rig& rig, Tell tell) {
  double rate = NAN;
  for (GstClockTime now = 2 * GST_SECOND; std::isnan(rate); now += 3 * GST_SECOND) {
    gst_harness_set_time(rig.harness, now);
    rate = next_rate(rig, 300 * GST_MSECOND);
    tell(rig, now - GST_SECOND / 2);
    gst_harness_set_time(rig.harness, now + 1600 * GST_MSECOND);  // the robot's own word holds no more
    if (std::isnan(rate)) rate = next_rate(rig);
  }
  return rate;
}

GST_START_TEST(a_robot_that_says_that_it_stands_teaches_the_bias) {
  const Gyro gyro;
  Rig rig(gyro.property(), Source::live);
  const double rate = rate_after_standing(rig, [](Rig& robot, GstClockTime from) {
    for (const GstClockTime time : {from, from + GST_SECOND / 2, from + GST_SECOND})
      fail_unless(gst_element_send_event(robot.element, base_event(0, time)));
    next_rate(robot);  // what was reported
  });
  fail_unless(std::fabs(rate) < 1e-6, "%g", rate);
  gyro.write("in_anglvel_z_raw", "-25");  // now it turns
  double turning = 0;
  while (std::fabs(turning - 15) > 1e-6) {
    turning = next_rate(rig);
    fail_unless(std::isnan(turning) || std::fabs(turning) < 1e-6 || std::fabs(turning - 15) < 1e-6, "%g",
                turning);
  }
}
GST_END_TEST

GST_START_TEST(a_picture_that_does_not_move_teaches_the_bias) {
  const Gyro gyro;
  Rig rig(gyro.property(), Source::live);
  guint age = 0;
  const double rate = rate_after_standing(rig, [&](Rig& robot, GstClockTime from) {
    for (int k = 0; k <= 26; ++k) robot.push(still_frame(from - kFrame + k * kFrame, age++));
  });
  fail_unless(std::fabs(rate) < 1e-6, "%g", rate);
}
GST_END_TEST

std::string refusal(const std::string& gyro) {
  g_autoptr(GstElement) sink = gst_parse_launch(("pantiltsink base-gyro=" + gyro).c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(sink, bus);
  gst_element_set_state(sink, GST_STATE_PAUSED);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  gst_element_set_state(sink, GST_STATE_NULL);
  gst_element_set_bus(sink, nullptr);
  return error->message;
}

GST_START_TEST(what_is_no_gyro_is_an_error_that_names_it) {
  fail_unless(says(refusal("attic"), "There is no IIO device \"attic\" for the base's gyro"));
  fail_unless(says(refusal("\"attic axis=up\""), "names no gyro"));
}
GST_END_TEST

Suite* pantiltsink_gyro_suite() {
  Suite* suite = suite_create("pantiltsink with a gyro");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_robot_that_says_that_it_stands_teaches_the_bias);
  tcase_add_test(tests, a_picture_that_does_not_move_teaches_the_bias);
  tcase_add_test(tests, what_is_no_gyro_is_an_error_that_names_it);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pantiltsink_gyro);
