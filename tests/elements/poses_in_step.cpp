// SPDX-License-Identifier: LGPL-2.1-or-later
// Poses that come as events count in a stream that is not live only if they come in step with its frames.
#include <cerberus/cerberus.h>

#include <cmath>
#include <string>
#include <vector>

#include "support.h"

namespace {

struct Seen {
  std::vector<double> on_frames, fused;  // pan, degrees; NaN: not known
  int warnings = 0;
};

GstPadProbeReturn note(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto& seen = *static_cast<Seen*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
  seen.on_frames.push_back(pose ? pose->pan : NAN);
  seen.fused.push_back(fusion ? fusion->pan : NAN);
  return GST_PAD_PROBE_OK;
}

Seen run(const std::string& corridor, const std::string& link) {
  const std::string launch =
      "videotestsrc num-buffers=10 ! video/x-raw,width=64,height=48,framerate=25/1 ! " + corridor +
      " ! identity name=end ! " + link + " ! pantiltsink start-pan=5";
  GstElement* pipeline = gst_parse_launch(launch.c_str(), nullptr);
  GstElement* end = gst_bin_get_by_name(GST_BIN(pipeline), "end");
  GstPad* pad = gst_element_get_static_pad(end, "sink");
  Seen seen;
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, note, &seen, nullptr);
  gst_object_unref(pad);
  gst_object_unref(end);
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (bool ended = false; !ended;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus, 20 * GST_SECOND,
        static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING));
    fail_unless(message && GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR);
    ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    seen.warnings += !ended;
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(pipeline);
  fail_unless_equals_int(seen.on_frames.size(), 10);
  return seen;
}

}  // namespace

GST_START_TEST(without_a_queue_every_frame_has_the_pose) {
  const Seen seen = run("cameramotion ! pirfusion", "identity");
  for (std::size_t k = 0; k < 10; ++k) {
    fail_unless(seen.on_frames[k] == 5, "frame %zu: %g", k, seen.on_frames[k]);
    fail_unless(seen.fused[k] == 5, "frame %zu: %g", k, seen.fused[k]);
  }
  fail_unless_equals_int(seen.warnings, 0);
}
GST_END_TEST

// How many frames are ahead of the pose differs from run to run.
GST_START_TEST(through_a_queue_no_frame_has_one_and_each_element_warns_at_most_once) {
  for (int round = 0; round < 10; ++round) {
    const Seen seen = run("cameramotion ! pirfusion", "queue max-size-buffers=2");
    for (std::size_t k = 0; k < 10; ++k)
      fail_unless(std::isnan(seen.on_frames[k]) && std::isnan(seen.fused[k]));
    fail_unless(seen.warnings <= 2);
  }
}
GST_END_TEST

GST_START_TEST(live_the_newest_pose_counts_through_a_queue) {
  const std::string launch =
      "videotestsrc is-live=true num-buffers=40 ! video/x-raw,width=64,height=48,framerate=100/1 ! "
      "cameramotion ! "
      "identity name=end ! queue ! pantiltsink start-pan=5";
  GstElement* pipeline = gst_parse_launch(launch.c_str(), nullptr);
  GstElement* end = gst_bin_get_by_name(GST_BIN(pipeline), "end");
  GstPad* pad = gst_element_get_static_pad(end, "sink");
  Seen seen;
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, note, &seen, nullptr);
  gst_object_unref(pad);
  gst_object_unref(end);
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, 20 * GST_SECOND,
      static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING));
  fail_unless(message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(pipeline);
  fail_unless(seen.on_frames.back() == 5, "%g", seen.on_frames.back());
}
GST_END_TEST

static Suite* poses_in_step_suite() {
  Suite* suite = suite_create("poses in step with frames");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, without_a_queue_every_frame_has_the_pose);
  tcase_add_test(tests, through_a_queue_no_frame_has_one_and_each_element_warns_at_most_once);
  tcase_add_test(tests, live_the_newest_pose_counts_through_a_queue);
  return suite;
}

GST_CHECK_MAIN(poses_in_step);
