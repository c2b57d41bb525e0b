// SPDX-License-Identifier: LGPL-2.1-or-later
// What a sensor says between two frames of a live video is decided at once, told once, and agrees with the next frame.
#include "fusion_rig.h"

namespace {

using namespace rig;

void set_time(Rig& rig, GstClockTime now) {
  gst_harness_set_time(rig.video, now);
}

// What was told downstream since the last call, between frames: "time ms:rule name:action:head".
std::vector<std::string> events(Rig& rig) {
  std::vector<std::string> result;
  while (GstEvent* event = gst_harness_try_pull_event(rig.video)) {
    const gchar* head = nullptr;
    if (g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event, &head))
      result.push_back(std::to_string(fusion->decided / kMs) + ":" + fusion->rule_name + ":" +
                       cerberus_fusion_action_get_nick(fusion->action) + ":" + head);
    gst_event_unref(event);
  }
  return result;
}

void assert_one(const std::vector<std::string>& found, const char* expected) {
  fail_unless(found.size() == 1, "%zu instead of \"%s\"", found.size(), expected);
  assert_says(found[0], expected);
}

// A frame 40 ms old, and everything that it told is over.
CerberusFusion see(Rig& rig, GstClockTime now, GstBuffer* buffer) {
  set_time(rig, now);
  const CerberusFusion fusion = rig.show(buffer);
  events(rig);
  return fusion;
}

void begin(Rig& rig) {
  rig.read(0, {0, 0, 0});
  see(rig, 40 * kMs, frame_at(0, 0));
  rig.told();
}

}  // namespace

GST_START_TEST(an_edge_does_not_wait_for_the_next_frame) {
  Rig rig;
  rig.add_pir();
  begin(rig);
  set_time(rig, 53 * kMs);
  rig.read(52 * kMs, {0, 0, 1});
  assert_one(rig.told(), "53:0:turn-right");
  assert_one(events(rig), "53:sector:turn-right:head");
  set_time(rig, 60 * kMs);
  rig.read(60 * kMs, {0, 0, 1});  // a heartbeat
  fail_unless(rig.told().empty() && events(rig).empty());

  const CerberusFusion frame = see(rig, 80 * kMs, frame_at(40 * kMs, 0));
  fail_unless_equals_int(frame.action, CERBERUS_FUSION_TURN_RIGHT);
  fail_unless_equals_uint64(frame.decided, 80 * kMs);
  fail_unless(rig.told().empty(), "it was told twice");
}
GST_END_TEST

// Shorter than the time between two frames: no frame would have told of it.
GST_START_TEST(a_short_pulse_counts) {
  Rig rig;
  g_object_set(rig.element, "head", "", nullptr);
  rig.add_pir();
  begin(rig);
  set_time(rig, 50 * kMs);
  rig.read(50 * kMs, {0, 1, 0});
  assert_one(events(rig), "50:sector:turn-left:");
  set_time(rig, 60 * kMs);
  rig.read(60 * kMs, {0, 0, 0});
  assert_one(events(rig), "60:return:turn-left:");
  fail_unless_equals_int(static_cast<int>(rig.told().size()), 2);
  fail_unless_equals_int(see(rig, 80 * kMs, frame_at(40 * kMs, 0)).action, CERBERUS_FUSION_TURN_LEFT);
  fail_unless(rig.told().empty());
}
GST_END_TEST

GST_START_TEST(the_cameras_last_word_counts) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  see(rig, 40 * kMs, frame_with(0, 7));
  rig.told();
  set_time(rig, 50 * kMs);
  rig.read(50 * kMs, {0, 0, 1});
  assert_one(events(rig), "50:camera:track:head");
  assert_one(rig.told(), "50:1:track");
}
GST_END_TEST

GST_START_TEST(two_decisions_never_have_one_time_and_no_frame_knows_less) {
  Rig rig;
  rig.add_pir();
  rig.add_pir(kPaper);
  begin(rig);
  rig.read(0, {0, 0, 0}, 1);
  rig.told(), events(rig);
  set_time(rig, 50 * kMs);
  rig.read(50 * kMs, {0, 0, 1}, 0);
  rig.read(50 * kMs, {0, 0, 1}, 1);
  GstClockTime decided = 0;
  int count = 0;
  while (GstEvent* event = gst_harness_try_pull_event(rig.video)) {
    if (g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event, nullptr)) {
      fail_unless(fusion->decided > decided);
      decided = fusion->decided;
      ++count;
    }
    gst_event_unref(event);
  }
  fail_unless_equals_int(count, 2);
  const CerberusFusion frame = rig.show(frame_at(40 * kMs, 0));
  fail_unless(frame.decided >= decided);
}
GST_END_TEST

GST_START_TEST(where_it_is_not_live_frames_alone_decide) {
  for (const auto& [live_video, live_sensors] : {std::pair{false, false}, {true, false}, {false, true}}) {
    Rig rig(live_video);
    rig.add_pir(kPaper, "pir_%u", live_sensors);  // a recording may be ahead of the video
    begin(rig);
    set_time(rig, 50 * kMs);
    rig.read(45 * kMs, {0, 0, 1});
    rig.read(3 * GST_SECOND, {0, 0, 1});
    fail_unless(rig.told().empty() && events(rig).empty());
    const CerberusFusion frame = see(rig, 90 * kMs, frame_at(80 * kMs, 0));
    fail_unless_equals_int(frame.action, CERBERUS_FUSION_TURN_RIGHT);
    fail_unless_equals_uint64(frame.decided, live_video ? 90 * kMs : 80 * kMs);
    assert_one(rig.told(), "80:0:turn-right");
  }
}
GST_END_TEST

GST_START_TEST(without_a_frame_to_speak_of_nothing_is_decided) {
  const auto edge = [](Rig& rig, GstClockTime time) {
    events(rig);
    rig.told();
    set_time(rig, time);
    rig.read(time, {0, 0, 1});
    fail_unless(rig.told().empty() && events(rig).empty());
  };
  {
    Rig rig;
    rig.add_pir();
    rig.read(0, {0, 0, 0});
    edge(rig, 20 * kMs);
  }
  {
    Rig rig;
    rig.add_pir();
    begin(rig);
    gst_harness_push_event(rig.video, gst_event_new_flush_start());
    gst_harness_push_event(rig.video, gst_event_new_flush_stop(FALSE));
    edge(rig, 60 * kMs);
  }
  {
    Rig rig;
    rig.add_pir();
    begin(rig);
    set_time(rig, 1030 * kMs);
    rig.read(1030 * kMs, {0, 1, 0});
    fail_unless(events(rig).size() == 1);
    edge(rig, 1050 * kMs);  // the camera has been silent for more than a second
  }
  {
    Rig rig;
    rig.add_pir();
    begin(rig);
    gst_harness_set_src_caps_str(rig.pir[0], with_sensors(3, 30, 100).c_str());  // other sensors
    edge(rig, 60 * kMs);
  }
}
GST_END_TEST

// Two sensors' threads and the video's at once: every change is told, and in the order in which it was decided.
GST_START_TEST(changes_are_told_once_and_in_their_order) {
  Rig rig;
  rig.add_pir(with_sensors(1, 0, 0).c_str());
  rig.add_pir(with_sensors(1, 0, 0).c_str());
  rig.read(0, {0}, 0);
  rig.read(0, {0}, 1);
  see(rig, 0, frame_at(0, 0));
  rig.told();
  constexpr int kRounds = 200;
  const auto chatter = [&rig](std::size_t pad) {
    for (int i = 1; i <= kRounds; ++i) rig.read(0, {static_cast<guint8>(i % 2)}, pad);
  };
  std::thread one(chatter, 0), two(chatter, 1);
  for (int i = 1; i <= kRounds; ++i) rig.at(0);
  one.join();
  two.join();
  Bytes before;
  int told = 0;
  while (GstMessage* message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ELEMENT)) {
    g_autoptr(CerberusFusion) fusion = cerberus_message_parse_fusion(message, nullptr);
    gst_message_unref(message);
    const Bytes now = sensors(*fusion);
    fail_if(now == before, "told twice");
    before = now;
    ++told;
  }
  fail_unless(before == Bytes({0, 0}), "the last word is not the last one: %s", text(before).c_str());
  fail_unless(told > 0);
}
GST_END_TEST

static Suite* pirfusion_between_suite() {
  watch_library_log();
  Suite* s = suite_create("pirfusion_between");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, an_edge_does_not_wait_for_the_next_frame);
  tcase_add_test(tc, a_short_pulse_counts);
  tcase_add_test(tc, the_cameras_last_word_counts);
  tcase_add_test(tc, two_decisions_never_have_one_time_and_no_frame_knows_less);
  tcase_add_test(tc, where_it_is_not_live_frames_alone_decide);
  tcase_add_test(tc, without_a_frame_to_speak_of_nothing_is_decided);
  tcase_add_test(tc, changes_are_told_once_and_in_their_order);
  return s;
}

GST_CHECK_MAIN(pirfusion_between)
