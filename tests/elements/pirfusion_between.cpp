// SPDX-License-Identifier: LGPL-2.1-or-later
// A sensor reading between two frames of a live video is decided at once, published once, and agrees with the next
// frame.
#include <array>

#include "fusion_rig.h"

namespace {

using namespace rig;

void set_time(Rig& rig, GstClockTime now) {
  gst_harness_set_time(rig.video, now);
}

// Decisions published downstream since the last call, between frames: "time ms:rule name:action:head".
std::vector<std::string> events(Rig& rig) {
  std::vector<std::string> result;
  while (GstEvent* event = gst_harness_try_pull_event(rig.video)) {
    if (g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event))
      result.push_back(std::to_string(fusion->decided / kMs) + ":" + fusion->rule_name + ":" +
                       cerberus_fusion_action_get_nick(fusion->action) + ":" +
                       (fusion->head ? fusion->head : ""));
    gst_event_unref(event);
  }
  return result;
}

void assert_one(const std::vector<std::string>& found, const char* expected) {
  fail_unless(found.size() == 1, "%zu instead of \"%s\"", found.size(), expected);
  assert_says(found[0], expected);
}

// A frame 40 ms old, and all that it published is consumed.
CerberusFusion see(Rig& rig, GstClockTime now, GstBuffer* buffer) {
  set_time(rig, now);
  const CerberusFusion fusion = rig.show(buffer);
  events(rig);
  return fusion;
}

void begin(Rig& rig) {
  rig.read(0, {0, 0, 0});
  see(rig, 40 * kMs, frame_at(0, 0));
  rig.posted();
}

}  // namespace

GST_START_TEST(an_edge_does_not_wait_for_the_next_frame) {
  Rig rig;
  rig.add_pir();
  begin(rig);
  set_time(rig, 53 * kMs);
  rig.read(52 * kMs, {0, 0, 1});
  assert_one(rig.posted(), "53:0:turn-right");
  assert_one(events(rig), "53:sector:turn-right:head");
  set_time(rig, 60 * kMs);
  rig.read(60 * kMs, {0, 0, 1});  // a heartbeat
  fail_unless(rig.posted().empty() && events(rig).empty());

  const CerberusFusion frame = see(rig, 80 * kMs, frame_at(40 * kMs, 0));
  fail_unless_equals_int(frame.action, CERBERUS_FUSION_TURN_RIGHT);
  fail_unless_equals_uint64(frame.decided, 80 * kMs);
  fail_unless(rig.posted().empty(), "it was posted twice");
}
GST_END_TEST

// Shorter than the time between two frames: no frame would have shown it.
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
  fail_unless_equals_int(static_cast<int>(rig.posted().size()), 2);
  fail_unless_equals_int(see(rig, 80 * kMs, frame_at(40 * kMs, 0)).action, CERBERUS_FUSION_TURN_LEFT);
  fail_unless(rig.posted().empty());
}
GST_END_TEST

GST_START_TEST(the_cameras_last_word_counts) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  see(rig, 40 * kMs, frame_with(0, 7));
  rig.posted();
  set_time(rig, 50 * kMs);
  rig.read(50 * kMs, {0, 0, 1});
  assert_one(events(rig), "50:camera:track:head");
  assert_one(rig.posted(), "50:1:track");
}
GST_END_TEST

// The head's latest pose is newer than the one at which the last frame was taken.
GST_START_TEST(the_newest_pose_counts) {
  const struct {
    CerberusPose received;
    bool on_frame;  // the pose on the frame at 0 is straight ahead
    const char* decided;
  } cases[] = {{pose(100, 45 * kMs), true, "53:sector:search:head"},
               {pose(100, 45 * kMs), false, "53:sector:search:head"},
               {pose(-50, 45 * kMs, 20000), true, "53:sector:search:head"},  // 110 degrees at 53 ms
               {pose(100, 0), false, "53:sector:search:head"},               // published before
               {pose(100, 0), true, "53:sector:turn-right:head"},  // the pose on the frame takes precedence
               {pose(100, 60 * kMs), true, "53:sector:turn-right:head"},  // not yet
               {pose(100, 45 * kMs, 0, "tail"), true, "53:sector:turn-right:head"}};
  for (const auto& c : cases) {
    Rig rig;
    rig.add_pir();
    rig.read(0, {0, 0, 0});
    see(rig, 40 * kMs, c.on_frame ? frame_at(0, 0) : frame(0));
    rig.posted();
    say(rig, c.received);
    set_time(rig, 53 * kMs);
    rig.read(52 * kMs, {0, 0, 1});
    assert_one(events(rig), c.decided);
  }
  Rig rig(true, "head=\"\"");
  rig.add_pir();
  begin(rig);
  say(rig, pose(100, 45 * kMs, 0, "tail"));
  g_object_set(rig.element, "head", "head", nullptr);  // which has published nothing since
  set_time(rig, 53 * kMs);
  rig.read(52 * kMs, {0, 0, 1});
  assert_one(events(rig), "53:sector:turn-right:head");
}
END_TEST

// A module holds its output for a while: counted from the event that reported the end of the robot's turn, not from
// the frame before that.
GST_START_TEST(doubt_lasts_from_when_the_robot_stands) {
  Rig rig;
  rig.add_pir();
  say(rig, base_event(30, 0));
  rig.read(0, {1, 0, 0});
  fail_unless_equals_int(static_cast<int>(see(rig, 40 * kMs, frame_at(0, 0)).doubtful), 1);
  say(rig, base_event(0, 700 * kMs));
  set_time(rig, 710 * kMs);
  rig.read(710 * kMs, {1, 0, 1});
  fail_unless(events(rig).size() == 1);
  const auto doubtful = [&](GstClockTime now) {
    set_time(rig, now);
    rig.read(now, {1, 0, 1});
    return see(rig, now, frame_at(now - 40 * kMs, 0)).doubtful;
  };
  fail_unless_equals_int(static_cast<int>(doubtful(3700 * kMs)), 0b101);
  fail_unless_equals_int(static_cast<int>(doubtful(3720 * kMs)), 0);
}
END_TEST

// It would be taken for a decision on the frames that leave here, and those are made here.
GST_START_TEST(what_another_one_upstream_decided_goes_no_further) {
  Rig rig;
  rig.add_pir();
  begin(rig);
  CerberusFusion other;
  cerberus_fusion_init(&other);
  other.action = CERBERUS_FUSION_TURN_LEFT;
  other.decided = 50 * kMs;
  for (const char* head : {"head", "", "tail"})
    fail_unless(gst_harness_push_event(rig.video, fusion_event(head, other)));
  fail_unless(gst_harness_try_pull_event(rig.video) == nullptr);
  fail_unless(gst_harness_push_event(
      rig.video, gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_OOB, gst_structure_new_empty("else"))));
  GstEvent* passed = gst_harness_try_pull_event(rig.video);
  fail_unless(passed && gst_event_has_name(passed, "else"));
  gst_event_unref(passed);
}
END_TEST

GST_START_TEST(two_decisions_never_have_one_time_and_no_frame_knows_less) {
  Rig rig;
  rig.add_pir();
  rig.add_pir(kPaper);
  begin(rig);
  rig.read(0, {0, 0, 0}, 1);
  rig.posted(), events(rig);
  set_time(rig, 50 * kMs);
  rig.read(50 * kMs, {0, 0, 1}, 0);
  rig.read(50 * kMs, {0, 0, 1}, 1);
  GstClockTime decided = 0;
  int count = 0;
  while (GstEvent* event = gst_harness_try_pull_event(rig.video)) {
    if (g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event)) {
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

// However long the posting thread is blocked, and however often a sensor changes meanwhile.
GST_START_TEST(what_was_decided_once_is_not_lost_among_what_is_decided_often) {
  struct Keeper {
    std::promise<void> there, go;
    bool kept = false;
  } keeper;
  Rig rig;
  rig.add_pir();
  rig.add_pir(kPaper);
  rig.read(0, {0, 0, 0}, 1);
  begin(rig);
  const auto keep = [](GstBus*, GstMessage* message, gpointer data) {
    auto* keeper = static_cast<Keeper*>(data);
    if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ELEMENT || std::exchange(keeper->kept, true))
      return GST_BUS_PASS;
    keeper->there.set_value();
    keeper->go.get_future().wait();
    return GST_BUS_PASS;
  };
  gst_bus_set_sync_handler(rig.bus, keep, &keeper, nullptr);
  set_time(rig, 50 * kMs);
  std::thread sensor([&] { rig.read(50 * kMs, {0, 0, 1}, 0); });
  keeper.there.get_future().wait();
  see(rig, 80 * kMs, frame_with(60 * kMs, 7));
  see(rig, 2 * GST_SECOND, frame_at(2 * GST_SECOND, 0));
  for (guint k = 1; k <= 600; ++k) {
    set_time(rig, 2 * GST_SECOND + k * kMs);
    const guint8 left = k % 2;
    rig.read(2 * GST_SECOND + k * kMs, {0, left, static_cast<guint8>(1 - left)}, 1);
  }
  keeper.go.set_value();
  sensor.join();
  gst_bus_set_sync_handler(rig.bus, nullptr, nullptr, nullptr);
  const std::vector<std::string> posted = rig.posted();
  fail_unless(posted.size() > 2 && posted[0] == "50:0:turn-right" && posted[1] == "60:1:track", "%zu %s %s",
              posted.size(), posted[0].c_str(), posted[1].c_str());
  assert_says(posted.back(), "2600:0:turn-right");
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
    fail_unless(rig.posted().empty() && events(rig).empty());
    const CerberusFusion frame = see(rig, 90 * kMs, frame_at(80 * kMs, 0));
    fail_unless_equals_int(frame.action, CERBERUS_FUSION_TURN_RIGHT);
    fail_unless_equals_uint64(frame.decided, live_video ? 90 * kMs : 80 * kMs);
    assert_one(rig.posted(), "80:0:turn-right");
  }
}
GST_END_TEST

GST_START_TEST(without_a_frame_to_speak_of_nothing_is_decided) {
  const auto edge = [](Rig& rig, GstClockTime time) {
    events(rig);
    rig.posted();
    set_time(rig, time);
    rig.read(time, {0, 0, 1});
    fail_unless(rig.posted().empty() && events(rig).empty());
  };
  {
    Rig rig;
    rig.add_pir();
    rig.read(0, {0, 0, 0});
    edge(rig, 20 * kMs);
  }
  for (const bool over : {false, true}) {
    Rig rig;
    rig.add_pir();
    begin(rig);
    gst_harness_push_event(rig.video, gst_event_new_flush_start());
    if (over) gst_harness_push_event(rig.video, gst_event_new_flush_stop(FALSE));
    edge(rig, 60 * kMs);
  }
  for (const bool another : {false, true}) {
    Rig rig;
    rig.add_pir();
    begin(rig);
    gst_harness_push_event(rig.video, gst_event_new_eos());
    if (another) gst_harness_push_event(rig.video, gst_event_new_stream_start("another"));
    edge(rig, 60 * kMs);
  }
  {
    Rig rig;
    rig.add_pir();
    begin(rig);
    g_autoptr(GstPad) sink = gst_element_get_static_pad(rig.element, "sink");
    gst_pad_set_active(sink, FALSE);  // as on the way to READY, while the sensors' pads are still active
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

// Two sensors' threads and the video's at once: every change of a sensor is decided before its thread delivers the
// next one, so that each is published. In another order sensors would seem to have changed more often.
GST_START_TEST(changes_are_published_once_and_in_their_order) {
  Rig rig;
  rig.add_pir(with_sensors(1, 0, 0).c_str());
  rig.add_pir(with_sensors(1, 0, 0).c_str());
  rig.read(0, {0}, 0);
  rig.read(0, {0}, 1);
  see(rig, 0, frame_at(0, 0));
  rig.posted();
  constexpr int kRounds = 200;
  const auto chatter = [&rig](std::size_t pad) {
    for (int i = 1; i <= kRounds; ++i) rig.read(0, {static_cast<guint8>(i % 2)}, pad);
  };
  std::thread one(chatter, 0), two(chatter, 1);
  for (int i = 1; i <= kRounds; ++i) rig.at(0);
  one.join();
  two.join();
  Bytes before{0, 0};
  std::array<int, 2> changes{};
  while (GstMessage* message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ELEMENT)) {
    g_autoptr(CerberusFusion) fusion = cerberus_message_parse_fusion(message);
    gst_message_unref(message);
    const Bytes now = sensors(*fusion);
    fail_if(now == before, "posted twice");
    for (std::size_t i = 0; i < changes.size(); ++i) changes[i] += now[i] != before[i];
    before = now;
  }
  fail_unless(before == Bytes({0, 0}), "the last word is not the last one: %s", text(before).c_str());
  for (const int count : changes) fail_unless_equals_int(count, kRounds);
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
  tcase_add_test(tc, the_newest_pose_counts);
  tcase_add_test(tc, doubt_lasts_from_when_the_robot_stands);
  tcase_add_test(tc, what_another_one_upstream_decided_goes_no_further);
  tcase_add_test(tc, two_decisions_never_have_one_time_and_no_frame_knows_less);
  tcase_add_test(tc, what_was_decided_once_is_not_lost_among_what_is_decided_often);
  tcase_add_test(tc, where_it_is_not_live_frames_alone_decide);
  tcase_add_test(tc, without_a_frame_to_speak_of_nothing_is_decided);
  tcase_add_test(tc, changes_are_published_once_and_in_their_order);
  return s;
}

GST_CHECK_MAIN(pirfusion_between)
