// SPDX-License-Identifier: LGPL-2.1-or-later
// A head's reports are published in the order of its actions, whichever thread reports and whichever callback blocks.
#include <future>
#include <thread>

#include "head_rig.h"

namespace {

using namespace head_rig;

// Blocks the thread that posts the first state of this name until it is released.
class Keeper {
 public:
  Keeper(Rig& rig, std::string state) : rig_(rig), state_(std::move(state)) {
    gst_bus_set_sync_handler(rig.bus, on_message, this, nullptr);
  }
  ~Keeper() { gst_bus_set_sync_handler(rig_.bus, nullptr, nullptr, nullptr); }
  void wait() { there_.get_future().wait(); }
  void let_go() { go_.set_value(); }

 private:
  static GstBusSyncReply on_message(GstBus*, GstMessage* message, gpointer keeper) {
    auto* self = static_cast<Keeper*>(keeper);
    const HeadState reported(message);
    if (self->state_ != reported.state || self->kept_) return GST_BUS_PASS;
    self->kept_ = true;
    self->there_.set_value();
    self->go_.get_future().wait();
    return GST_BUS_PASS;
  }

  Rig& rig_;
  std::string state_;
  std::promise<void> there_, go_;
  bool kept_ = false;
};

}  // namespace

GST_START_TEST(a_thread_blocked_while_posting_is_not_overtaken) {
  Rig rig("watchdog-timeout=0", Source::live);
  Keeper keeper(rig, "turning");
  std::thread frames([&] { gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT)); });
  keeper.wait();
  // Nor does it keep the application.
  fail_unless(rig.call("stop"));
  fail_unless(rig.call("auto"));
  keeper.let_go();
  frames.join();
  const std::string states = rig.states();
  fail_unless(states == "turning manual holding", "\"%s\"", states.c_str());
}
GST_END_TEST

// The head was commanded by a frame and now waits for the driver.
GST_START_TEST(a_thread_that_waits_for_the_driver_is_not_overtaken) {
  Pipe gate, record;
  Rig rig("driver=scripted script=\"record " + record.writer() + "; command wait " + gate.reader() + "\"");
  rig.messages();
  std::thread frames([&] { gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT)); });
  while (!record.line().starts_with("command")) {  // it is in the call
  }
  fail_unless(rig.call("stop"));
  gate.close_writer();
  frames.join();
  const std::string states = rig.states();
  fail_unless(states == "turning manual", "\"%s\"", states.c_str());
}
GST_END_TEST

// A handler of a state message may call the element from within.
GST_START_TEST(a_reply_is_published_after_its_cause) {
  Rig rig("watchdog-timeout=0", Source::live);
  gst_bus_set_sync_handler(
      rig.bus,
      [](GstBus*, GstMessage* message, gpointer answering) {
        const HeadState reported(message);
        if (reported.state == "turning") fail_unless(static_cast<Rig*>(answering)->call("stop"));
        return GST_BUS_PASS;
      },
      &rig, nullptr);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT));
  const std::string states = rig.states();
  fail_unless(states == "turning manual", "\"%s\"", states.c_str());
  gst_bus_set_sync_handler(rig.bus, nullptr, nullptr, nullptr);
}
GST_END_TEST

// A thread that delivers reports of one head is blocked until the sink drives another: each report names its own head.
GST_START_TEST(each_report_names_its_head) {
  Rig rig("head=first", Source::live);
  gst_bus_set_sync_handler(
      rig.bus,
      [](GstBus*, GstMessage* message, gpointer data) {
        auto* rig = static_cast<Rig*>(data);
        const HeadState said(message);
        if (said.state != "manual" || said.head != "first") return GST_BUS_PASS;
        gst_element_set_state(rig->element, GST_STATE_READY);
        g_object_set(rig->element, "head", "second", nullptr);
        gst_element_set_state(rig->element, GST_STATE_PAUSED);
        fail_unless(rig->call("stop"));
        return GST_BUS_PASS;
      },
      &rig, nullptr);
  fail_unless(rig.call("stop"));
  gst_bus_set_sync_handler(rig.bus, nullptr, nullptr, nullptr);
  std::string all;
  while (GstMessage* message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ELEMENT)) {
    const HeadState reported(message);
    if (!reported.state.empty()) all += reported.head + " " + reported.state + ". ";
    gst_message_unref(message);
  }
  fail_unless_equals_string(all.c_str(), "first manual. first stopped. second manual. ");
}
GST_END_TEST

// However long the posting thread is blocked, and however often the state changes meanwhile.
GST_START_TEST(a_warning_is_not_lost_among_states) {
  Rig rig;
  Keeper keeper(rig, "manual");
  std::thread application([&] { rig.call("stop"); });
  keeper.wait();
  fail_unless(rig.call("auto") && rig.follow(7));
  GstBuffer* here = frame_at(0);
  add(here, person(7, 5));
  rig.push(here);
  rig.push(frame_at(kFrame));
  rig.push(frame_at(6 * GST_SECOND));  // without 7 for longer than it is waited for
  for (int k = 0; k < 300; ++k) fail_unless(rig.call("stop") && rig.call("auto"));
  fail_unless(rig.call("stop"));
  keeper.let_go();
  application.join();
  int warnings = 0;
  std::string last;
  while (GstMessage* message = gst_bus_pop(rig.bus)) {
    warnings += GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING;
    const HeadState reported(message);
    if (!reported.state.empty()) last = reported.state;
    gst_message_unref(message);
  }
  fail_unless_equals_int(warnings, 1);
  fail_unless(last == "manual", "\"%s\"", last.c_str());
}
GST_END_TEST

static Suite* pantiltsink_order_suite() {
  watch_library_log();
  Suite* suite = suite_create("pantiltsink's messages in their order");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, a_thread_blocked_while_posting_is_not_overtaken);
  tcase_add_test(tests, a_thread_that_waits_for_the_driver_is_not_overtaken);
  tcase_add_test(tests, a_reply_is_published_after_its_cause);
  tcase_add_test(tests, a_warning_is_not_lost_among_states);
  tcase_add_test(tests, each_report_names_its_head);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_order)
