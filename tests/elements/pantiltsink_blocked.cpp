// SPDX-License-Identifier: LGPL-2.1-or-later
// A driver that blocks for ever delays nothing else: no change of state, no frame on its way, no other element.
//
// Beside the time limit (promises.h), no round may take seconds, whatever the load: the element waits 10 s for a
// driver, which is what a lock held at the wrong moment costs.
#include <poll.h>

#include <array>
#include <chrono>
#include <future>
#include <thread>
#include <utility>

#include "head_rig.h"
#include "promises.h"

namespace {

using namespace head_rig;
using std::chrono::milliseconds;

constexpr milliseconds kHang(5000);

milliseconds change(Rig& rig, GstState state) {
  return time_taken([&] { fail_if(gst_element_set_state(rig.element, state) == GST_STATE_CHANGE_FAILURE); });
}

// ---- in the middle of a change

enum class What { segment, frame, gap };
constexpr const char* kWhat[] = {"segment", "frame", "gap"};

// Stands between pantiltsink and its base class: when `change` is under way and the element has done its own part of
// it, `what` is pushed, and the base class does its part once it has handed that to the element or keeps it waiting.
class Meeting {
 public:
  Meeting(Rig& rig, GstStateChange when, What what) : rig_(rig), when_(when), what_(what) {
    meeting = this;
    GstBaseSinkClass* sink = GST_BASE_SINK_GET_CLASS(rig.element);
    GstElementClass* base = GST_ELEMENT_CLASS(g_type_class_peek_parent(sink));
    change_state = std::exchange(base->change_state, on_change);
    render = std::exchange(sink->render, on_render);
    preroll = std::exchange(sink->preroll, on_preroll);
    event = std::exchange(sink->event, on_event);
  }
  ~Meeting() {
    GstBaseSinkClass* sink = GST_BASE_SINK_GET_CLASS(rig_.element);
    GST_ELEMENT_CLASS(g_type_class_peek_parent(sink))->change_state = change_state;
    sink->render = render;
    sink->preroll = preroll;
    sink->event = event;
    if (pusher_.joinable()) pusher_.join();
  }
  Meeting(const Meeting&) = delete;
  bool took_place() const { return took_place_; }
  // Whether the thread that pushes is through.
  bool pushed_within(milliseconds time) {
    return pushed_.get_future().wait_for(time) == std::future_status::ready;
  }

 private:
  static inline Meeting* meeting;
  static inline decltype(GstElementClass::change_state) change_state;
  static inline decltype(GstBaseSinkClass::render) render;
  static inline decltype(GstBaseSinkClass::preroll) preroll;
  static inline decltype(GstBaseSinkClass::event) event;

  static GstStateChangeReturn on_change(GstElement* element, GstStateChange change) {
    if (change == meeting->when_ && !meeting->took_place()) meeting->meet();
    return change_state(element, change);
  }
  static GstFlowReturn on_render(GstBaseSink* sink, GstBuffer* buffer) {
    meeting->arrive(What::frame);
    return render(sink, buffer);
  }
  static GstFlowReturn on_preroll(GstBaseSink*, GstBuffer*) {
    meeting->arrive(What::frame);
    return GST_FLOW_OK;
  }
  static gboolean on_event(GstBaseSink* sink, GstEvent* e) {
    if (GST_EVENT_TYPE(e) == GST_EVENT_GAP) meeting->arrive(What::gap);
    if (GST_EVENT_TYPE(e) == GST_EVENT_SEGMENT) meeting->arrive(What::segment);
    return event(sink, e);
  }

  void meet() {
    took_place_ = true;  // before another thread can see it
    pusher_ = std::thread([this] {
      if (what_ == What::segment) rig_.begin();
      if (what_ == What::frame) gst_harness_push(rig_.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT));
      if (what_ == What::gap) gst_harness_push_event(rig_.harness, gst_event_new_gap(0, kFrame));
      pushed_.set_value();
    });
    there_.get_future().wait();
  }
  void arrive(What what) {
    if (took_place() && what == what_ && !std::exchange(arrived_, true)) there_.set_value();
  }

  Rig& rig_;
  GstStateChange when_;
  What what_;
  std::thread pusher_;
  std::promise<void> there_, pushed_;
  bool took_place_ = false;
  bool arrived_ = false;  // under the base class's lock
};

void meet(const std::string& script, GstStateChange when, What what) {
  const auto from = GST_STATE_TRANSITION_CURRENT(when), to = GST_STATE_TRANSITION_NEXT(when);
  Rig rig(scripted(script), Source::stored, what != What::segment);
  if (from == GST_STATE_PAUSED) change(rig, GST_STATE_PAUSED);
  Meeting meeting(rig, when, what);
  const milliseconds took = change(rig, to);
  const milliseconds down = change(rig, GST_STATE_READY);  // lets go of what waits
  fail_unless(meeting.took_place());
  const std::string where = script + ": " + kWhat[static_cast<int>(what)] + " from " +
                            gst_element_state_get_name(from) + " to " + gst_element_state_get_name(to);
  fail_unless(took < kHang, "%s took %d ms", where.c_str(), static_cast<int>(took.count()));
  fail_unless(down < kHang, "%s, then READY took %d ms", where.c_str(), static_cast<int>(down.count()));
}

// A frame that the base class lets through before the element
// itself is in PLAYING waits for the element, which has to wake it.
class EarlyFrame {
 public:
  explicit EarlyFrame(Rig& rig) : rig_(rig) {
    frame = this;
    GstBaseSinkClass* sink = GST_BASE_SINK_GET_CLASS(rig.element);
    GstElementClass* base = GST_ELEMENT_CLASS(g_type_class_peek_parent(sink));
    change_state = std::exchange(base->change_state, on_change);
    render = std::exchange(sink->render, on_render);
  }
  ~EarlyFrame() {
    GstBaseSinkClass* sink = GST_BASE_SINK_GET_CLASS(rig_.element);
    GST_ELEMENT_CLASS(g_type_class_peek_parent(sink))->change_state = change_state;
    sink->render = render;
  }
  EarlyFrame(const EarlyFrame&) = delete;

 private:
  static inline EarlyFrame* frame;
  static inline decltype(GstElementClass::change_state) change_state;
  static inline decltype(GstBaseSinkClass::render) render;

  static GstStateChangeReturn on_change(GstElement* element, GstStateChange change) {
    const GstStateChangeReturn done = change_state(element, change);
    if (change != GST_STATE_CHANGE_PAUSED_TO_PLAYING) return done;
    frame->there_.get_future().wait();
    GST_BASE_SINK_PREROLL_LOCK(element);  // the frame has given it up: it waits
    GST_BASE_SINK_PREROLL_UNLOCK(element);
    return done;
  }
  static GstFlowReturn on_render(GstBaseSink* sink, GstBuffer* buffer) {
    frame->there_.set_value();
    return render(sink, buffer);
  }

  Rig& rig_;
  std::promise<void> there_;
};

// A base class that does not come to PLAYING.
class Refusing {
 public:
  explicit Refusing(Rig& rig)
      : base_(GST_ELEMENT_CLASS(g_type_class_peek_parent(GST_BASE_SINK_GET_CLASS(rig.element)))) {
    change_state_ = std::exchange(base_->change_state,
                                  [](GstElement*, GstStateChange) { return GST_STATE_CHANGE_FAILURE; });
  }
  ~Refusing() { base_->change_state = change_state_; }
  Refusing(const Refusing&) = delete;

 private:
  GstElementClass* base_;
  decltype(GstElementClass::change_state) change_state_;
};

}  // namespace

GST_START_TEST(what_comes_in_the_middle_of_a_change_of_state_does_not_hold_it_up) {
  for (const GstStateChange when : {GST_STATE_CHANGE_PAUSED_TO_PLAYING, GST_STATE_CHANGE_PLAYING_TO_PAUSED,
                                    GST_STATE_CHANGE_PAUSED_TO_READY})
    for (const char* call : {"command", "state", "stop"})
      for (const What what : {What::segment, What::frame, What::gap}) {
        Pipe gate;
        // The first question is the segment's.
        const bool later = what != What::segment && g_str_equal(call, "state");
        meet(std::string(call) + (later ? " 2" : "") + " wait " + gate.reader(), when, what);
      }
}
GST_END_TEST

// A live source sends it with a lock held that its own change to PAUSED, which comes after the sink's, needs.
GST_START_TEST(a_segment_of_a_live_source_does_not_wait_in_paused) {
  for (const Source source : {Source::live, Source::silent}) {
    Pipe gate;
    Rig rig(scripted("state wait " + gate.reader()), source, false);
    Meeting meeting(rig, GST_STATE_CHANGE_PLAYING_TO_PAUSED, What::segment);
    change(rig, GST_STATE_PAUSED);
    const bool through = meeting.pushed_within(kHang);
    change(rig, GST_STATE_READY);
    fail_unless(meeting.took_place() && through);
  }
}
GST_END_TEST

GST_START_TEST(a_frame_that_is_early_for_playing_goes_on_by_itself) {
  Pipe record;
  Rig rig(scripted("record " + record.writer()));
  change(rig, GST_STATE_PAUSED);
  fail_unless(record.line().starts_with("open"));
  fail_unless(record.line().starts_with("stop"));  // of PAUSED
  EarlyFrame early(rig);
  std::thread pusher([&] { gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT)); });
  change(rig, GST_STATE_PLAYING);
  fail_unless(record.line().starts_with("command"));
  pusher.join();
}
GST_END_TEST

// The base class may refuse PLAYING: the head then executes no command, as before, and none that was given in PAUSED.
GST_START_TEST(a_head_that_does_not_reach_playing_stands) {
  Pipe record;
  Rig rig(scripted("record " + record.writer()), Source::live);
  change(rig, GST_STATE_PAUSED);
  fail_unless(rig.call("move-to", 10, 0));
  {
    Refusing refusing(rig);
    fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  }
  fail_unless(rig.call("move-to", -10, 0));
  change(rig, GST_STATE_READY);
  std::string calls;
  for (std::string line; !line.starts_with("close"); calls += line.substr(0, line.find(' ')) + " ")
    line = record.line();
  fail_unless(calls.find("command") == std::string::npos, "%s", calls.c_str());
}
GST_END_TEST

GST_START_TEST(a_blocked_driver_delays_no_change_of_state) {
  constexpr std::array kStates = {GST_STATE_PAUSED, GST_STATE_PLAYING, GST_STATE_PAUSED, GST_STATE_READY};
  for (const char* call : {"open", "command", "state", "stop", "close"})
    for (const Source source : {Source::stored, Source::live}) {
      std::array<milliseconds, kStates.size()> best;
      best.fill(milliseconds::max());
      for (int round = 0; round < kRounds && std::ranges::max(best) >= kPromised; ++round) {
        Pipe gate;
        Rig rig(scripted(std::string(call) + " wait " + gate.reader()), source, false);
        std::thread pusher([&] {
          rig.begin();
          gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT));
        });
        if (source == Source::live) {
          const milliseconds took = time_taken([&] { pusher.join(); });
          fail_unless(took < kHang, "%s: live, a frame waited for %d ms", call,
                      static_cast<int>(took.count()));
        }
        for (std::size_t k = 0; k < kStates.size(); ++k) {
          const milliseconds took = change(rig, kStates[k]);
          fail_unless(took < kHang, "%s: %s took %d ms", call, gst_element_state_get_name(kStates[k]),
                      static_cast<int>(took.count()));
          best[k] = std::min(best[k], took);
        }
        if (pusher.joinable()) pusher.join();
      }
      for (std::size_t k = 0; k < kStates.size(); ++k)
        fail_unless(best[k] < kPromised, "%s: %s takes %d ms", call, gst_element_state_get_name(kStates[k]),
                    static_cast<int>(best[k].count()));
    }
}
GST_END_TEST

GST_START_TEST(a_frame_that_waits_for_the_driver_lets_go_of_a_flush_and_of_a_stop) {
  for (const bool flush : {true, false})
    assert_prompt(flush ? "flush" : "READY", [&] {
      Pipe gate, record;
      Rig rig(scripted("record " + record.writer() + "; command wait " + gate.reader()));
      std::thread pusher([&] { gst_harness_push(rig.harness, frame_with(CERBERUS_FUSION_TURN_RIGHT)); });
      while (!record.line().starts_with("command")) {  // it is in the call
      }
      const milliseconds took = time_taken([&] {
        if (flush)
          gst_harness_push_event(rig.harness, gst_event_new_flush_start());
        else
          gst_element_set_state(rig.element, GST_STATE_PAUSED);
      });
      gst_element_set_state(rig.element, GST_STATE_READY);
      pusher.join();
      return took;
    });
}
GST_END_TEST

GST_START_TEST(a_head_whose_driver_blocks_is_opened_again_when_it_is_through) {
  Pipe gate, record;
  const std::string head = "pantiltsink head=door driver=scripted script=";
  {
    Rig rig("head=door driver=scripted script=\"close wait " + gate.reader() + "\"", Source::stored);
  }
  GstElement* next = gst_parse_launch((head + "\"record " + record.writer() + "\"").c_str(), nullptr);
  GstElement* third = gst_parse_launch((head + "\"\"").c_str(), nullptr);
  for (GstElement* sink : {next, third}) gst_object_ref_sink(sink);
  fail_unless(gst_element_set_state(next, GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE);
  fail_unless_equals_int(gst_element_set_state(third, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  pollfd opened{record.ends[0], POLLIN, 0};
  fail_unless_equals_int(::poll(&opened, 1, 20), 0);
  gate.close_writer();
  fail_unless(record.line().starts_with("open"));
  for (GstElement* sink : {next, third}) {
    gst_element_set_state(sink, GST_STATE_NULL);
    gst_object_unref(sink);
  }
}
GST_END_TEST

static Suite* pantiltsink_blocked_suite() {
  watch_library_log();
  Suite* suite = suite_create("pantiltsink whose driver blocks");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, what_comes_in_the_middle_of_a_change_of_state_does_not_hold_it_up);
  tcase_add_test(tests, a_segment_of_a_live_source_does_not_wait_in_paused);
  tcase_add_test(tests, a_frame_that_is_early_for_playing_goes_on_by_itself);
  tcase_add_test(tests, a_head_that_does_not_reach_playing_stands);
  tcase_add_test(tests, a_blocked_driver_delays_no_change_of_state);
  tcase_add_test(tests, a_frame_that_waits_for_the_driver_lets_go_of_a_flush_and_of_a_stop);
  tcase_add_test(tests, a_head_whose_driver_blocks_is_opened_again_when_it_is_through);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_blocked)
