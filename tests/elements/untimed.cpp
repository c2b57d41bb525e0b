// SPDX-License-Identifier: LGPL-2.1-or-later
// One frame without a time stamp ends no stream: every element that takes raw frames goes on.
#include <memory>

#include "support.h"

namespace {

constexpr const char* kElements[] = {
    "motiondetect",
    "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack",
    "motiondetect ! pirfusion",
    "motiondetect ! motionoverlay show-trails=true",
    "motiondetect keep-planes=always ! motionview",
    "privacymask masks=\"0,0 0.2,0 0.2,0.2\"",
    "virtualptz width=80 height=60 lockstep=off",
    "virtualptz width=80 height=60 ! motiondetect ! tee ! pantiltsink",
    "motiondetect ! motionjson",
    "motiondetect ! onvifmeta ! rtponvifmetapay",
    "motiondetect ! mqttpublish host=\"\"",
    "motiondetect ! tee ! pantiltsink",
};

}  // namespace

GST_START_TEST(a_frame_without_a_time_stamp_ends_nothing) {
  const std::string line = kElements[__i__];
  g_autoptr(GError) error = nullptr;
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      (std::string("appsrc name=source format=time caps=video/x-raw,format=GRAY8,width=160,height=120,"
                   "framerate=25/1 ! ") +
       line + (line.ends_with("pantiltsink") ? " name=end sync=false" : " ! fakesink name=end sync=false"))
          .c_str(),
      &error);
  fail_unless(pipeline && !error, "%s: %s", line.c_str(), error ? error->message : "");
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (guint k = 0; k < 30; ++k) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 160 * 120, nullptr);
    gst_buffer_memset(buffer, 0, static_cast<guint8>(100 + k % 3), 160 * 120);
    if (k != 10 && k != 20) {
      GST_BUFFER_PTS(buffer) = k * 40 * GST_MSECOND;
      GST_BUFFER_DURATION(buffer) = 40 * GST_MSECOND;
    }
    GstFlowReturn flow = GST_FLOW_OK;
    g_signal_emit_by_name(source, "push-buffer", buffer, &flow);
    gst_buffer_unref(buffer);
  }
  GstFlowReturn flow = GST_FLOW_OK;
  g_signal_emit_by_name(source, "end-of-stream", &flow);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(message != nullptr, "%s does not end", line.c_str());
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
    g_autoptr(GError) wrong = nullptr;
    gst_message_parse_error(message, &wrong, nullptr);
    ck_abort_msg("%s: %s", line.c_str(), wrong->message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST

static Suite* untimed_suite() {
  watch_library_log();
  Suite* suite = suite_create("untimed");
  TCase* tests = tcase_create("untimed");
  tcase_set_timeout(tests, 120);
  tcase_add_loop_test(tests, a_frame_without_a_time_stamp_ends_nothing, 0, G_N_ELEMENTS(kElements));
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(untimed)
