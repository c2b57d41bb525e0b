// SPDX-License-Identifier: LGPL-2.1-or-later
// The end of the stream reaches the application.
#include <future>
#include <thread>

#include "support.h"

namespace {

// Keeps the thread that posts PAUSED of the pipeline until the application has set PLAYING: the order in which a busy
// machine may run the two threads.
struct Keeper {
  GstElement* pipeline;
  std::promise<void> paused, playing;
  std::thread::id application = std::this_thread::get_id();

  static GstBusSyncReply on_message(GstBus*, GstMessage* message, gpointer data) {
    auto* self = static_cast<Keeper*>(data);
    GstState state = GST_STATE_NULL;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_STATE_CHANGED &&
        GST_MESSAGE_SRC(message) == GST_OBJECT(self->pipeline))
      gst_message_parse_state_changed(message, nullptr, &state, nullptr);
    if (state == GST_STATE_PAUSED && GST_STATE_TARGET(self->pipeline) == GST_STATE_PAUSED) {
      self->paused.set_value();
      // Where the decoder was faster than the change of state, the application's own thread posts it.
      if (std::this_thread::get_id() != self->application) self->playing.get_future().wait();
    }
    return GST_BUS_PASS;
  }
};

void ends(const char* launch) {
  GstElement* pipeline = gst_parse_launch(launch, nullptr);
  GstBus* bus = gst_element_get_bus(pipeline);
  Keeper keeper{.pipeline = pipeline, .paused = {}, .playing = {}};
  gst_bus_set_sync_handler(bus, Keeper::on_message, &keeper, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  keeper.paused.get_future().wait();
  fail_unless(gst_element_set_state(pipeline, GST_STATE_PLAYING) == GST_STATE_CHANGE_SUCCESS);
  keeper.playing.set_value();
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, 10 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless(end && GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS, "%s", launch);
  fail_unless(!gst_bus_pop_filtered(bus, GST_MESSAGE_EOS));
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr);
  gst_object_unref(bus);
  gst_object_unref(pipeline);
}

}  // namespace

GST_START_TEST(a_pipeline_whose_decoder_completes_paused_late_ends) {
  ends("videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! decodebin ! pantiltsink");
}
GST_END_TEST

GST_START_TEST(so_does_one_with_the_sink_in_a_bin) {
  ends(
      "videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! decodebin ! bin.( queue ! pantiltsink "
      ")");
}
GST_END_TEST

static Suite* pantiltsink_end_suite() {
  Suite* suite = suite_create("pantiltsink at the end of the stream");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_pipeline_whose_decoder_completes_paused_late_ends);
  tcase_add_test(tests, so_does_one_with_the_sink_in_a_bin);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_end);
