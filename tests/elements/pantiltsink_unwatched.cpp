// SPDX-License-Identifier: LGPL-2.1-or-later
// A clock-driven head does not move while there is no thread for its watchdog.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <string>

#include "head_rig.h"

namespace {

std::atomic<bool> no_threads = false;

}  // namespace

// Replaces the system's thread creation, which fails while a test demands it.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* how, void* (*body)(void*),
                              void* data) {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  return no_threads ? EAGAIN : create(thread, how, body, data);
}

namespace {

using namespace head_rig;

struct WithoutThreads {
  WithoutThreads() { no_threads = true; }
  ~WithoutThreads() { no_threads = false; }
};

// The cause was reported once.
void assert_complained(Rig& rig) {
  g_autoptr(GstMessage) message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  fail_unless_equals_string(error->message,
                            "The head \"head\" is not moved: there is no thread to watch over it.");
  fail_unless(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_FAILED));
}

void assert_no_complaint(Rig& rig) {
  fail_unless(gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ERROR) == nullptr);
}

}  // namespace

GST_START_TEST(without_a_thread_a_head_with_a_clock_does_not_come_to_playing) {
  Pipe record;
  Rig rig("driver=scripted script=\"record " + record.writer() + "\"", Source::live);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  fail_unless(rig.call("move-to", 10, 0));
  while (!record.line().starts_with("stop")) {  // of PAUSED
  }
  {
    const WithoutThreads none;
    fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  }
  assert_complained(rig);
  assert_no_complaint(rig);
  GstState state = GST_STATE_NULL;
  gst_element_get_state(rig.element, &state, nullptr, 0);
  fail_unless_equals_int(state, GST_STATE_PAUSED);
  fail_unless(rig.call("move-to", 20, 0));
  // What comes next is the order that it has now: 20 degrees, in radians.
  fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PLAYING), GST_STATE_CHANGE_SUCCESS);
  std::string line;
  while (!line.starts_with("command")) line = record.line();
  fail_unless(line.find(" 0.349") != std::string::npos, "%s", line.c_str());
  assert_no_complaint(rig);
}
GST_END_TEST

// A handler of messages runs in the thread that posts: no lock is held that it would need to begin anew.
GST_START_TEST(a_handler_of_the_error_may_restart_at_once) {
  Pipe record;
  Rig rig("driver=scripted script=\"record " + record.writer() + "\"", Source::live);
  struct Received {
    GstElement* element;
    int errors = 0;
    GstStateChangeReturn anew = GST_STATE_CHANGE_FAILURE;
  } received{rig.element};
  const auto on_error = [](GstBus*, GstMessage* message, gpointer data) {
    auto& received = *static_cast<Received*>(data);
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) return GST_BUS_PASS;
    ++received.errors;
    no_threads = false;
    gst_element_set_state(received.element, GST_STATE_READY);
    received.anew = gst_element_set_state(received.element, GST_STATE_PLAYING);
    return GST_BUS_PASS;
  };
  gst_bus_set_sync_handler(rig.bus, on_error, &received, nullptr);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  {
    const WithoutThreads none;
    gst_element_set_state(rig.element, GST_STATE_PLAYING);
  }
  gst_bus_set_sync_handler(rig.bus, nullptr, nullptr, nullptr);
  fail_unless_equals_int(received.errors, 1);
  fail_unless_equals_int(received.anew, GST_STATE_CHANGE_SUCCESS);
  rig.begin();  // and it plays: what comes next is the order that it is given, 20 degrees, in radians
  fail_unless(rig.call("move-to", 20, 0));
  std::string line;
  while (!line.starts_with("command")) line = record.line();
  fail_unless(line.find(" 0.349") != std::string::npos, "%s", line.c_str());
}
GST_END_TEST

// Only with the stream it is known that the clock moves a simulated one.
GST_START_TEST(without_a_thread_no_frame_of_a_live_stream_is_taken) {
  Rig rig("", Source::live, false);
  {
    const WithoutThreads none;
    rig.begin();
    fail_unless_equals_int(gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT, 0)),
                           GST_FLOW_ERROR);
  }
  assert_complained(rig);
  const std::vector<Message> messages = rig.messages();
  fail_unless_equals_int(static_cast<int>(messages.size()), 1);
  fail_unless_equals_string(messages[0].state.c_str(), "stopped");
  fail_unless_equals_string(messages[0].reason.c_str(), "no thread for the watchdog");
  fail_unless_equals_int(gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT, kFrame)),
                         GST_FLOW_ERROR);
  assert_no_complaint(rig);
  // Nor does a manual command move it, whatever is flushed.
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_stop(TRUE)));
  fail_unless(rig.call("move-to", 10, 0));
  GstSegment later;
  gst_segment_init(&later, GST_FORMAT_TIME);
  later.base = GST_SECOND;
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_segment(&later)));
  fail_unless(rig.poses().back().pan == 0);  // in a second
  // The next start may find a thread.
  gst_element_set_state(rig.element, GST_STATE_READY);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.messages();
  rig.begin();
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "turning");
}
GST_END_TEST

static Suite* pantiltsink_unwatched_suite() {
  watch_library_log();
  Suite* suite = suite_create("pantiltsink without a thread to watch over its head");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, without_a_thread_a_head_with_a_clock_does_not_come_to_playing);
  tcase_add_test(tests, a_handler_of_the_error_may_restart_at_once);
  tcase_add_test(tests, without_a_thread_no_frame_of_a_live_stream_is_taken);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_unwatched)
