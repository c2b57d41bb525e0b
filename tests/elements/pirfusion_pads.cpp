// SPDX-License-Identifier: LGPL-2.1-or-later
// What comes to pirfusion's pads: readings and their caps, the video and its events.
#include "fusion_rig.h"

#include <gst/video/video.h>

namespace {

using namespace rig;

// The events that came out at the source pad since the last call.
std::vector<GstEventType> events_out(GstHarness* h) {
  std::vector<GstEventType> types;
  while (GstEvent* event = gst_harness_try_pull_event(h)) {
    types.push_back(GST_EVENT_TYPE(event));
    gst_event_unref(event);
  }
  return types;
}

}  // namespace

GST_START_TEST(live_the_newest_reading_not_later_than_the_frame_counts) {
  Rig rig;
  rig.add_pir();
  rig.read(10 * kMs, {1, 0, 0});
  rig.read(50 * kMs, {0, 1, 0});
  rig.read(100 * kMs, {0, 0, 1});
  const struct {
    int time;
    const char* values;
  } cases[] = {{0, "222"},  {9, "222"},  {10, "100"},  {49, "100"},
               {50, "010"}, {99, "010"}, {100, "001"}, {900, "001"}};
  for (const auto& c : cases) assert_says(text(sensors(rig.at(c.time * kMs))), c.values);
}
GST_END_TEST

GST_START_TEST(readings_out_of_order_are_put_where_they_belong) {
  Rig rig(true, "lost-after=0");
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  rig.read(100 * kMs, {1, 0, 0});
  rig.read(200 * kMs, {1, 0, 0});
  rig.read(50 * kMs, {0, 1, 0});
  const struct {
    int time;
    const char* values;
  } cases[] = {{40, "000"}, {60, "010"}, {99, "010"}, {110, "100"}, {250, "100"}};
  for (const auto& c : cases) assert_says(text(sensors(rig.at(c.time * kMs))), c.values);
  // Heartbeats repeat the last reading: one from before it does not undo it.
  for (const int time : {300, 400, 500}) rig.read(time * kMs, {1, 0, 0});
  rig.read(450 * kMs, {0, 0, 1});
  assert_says(text(sensors(rig.at(470 * kMs))), "001");
  assert_says(text(sensors(rig.at(500 * kMs))), "100");
  // Much later: running time began anew, and readings with future times are discarded.
  rig.read(10 * GST_SECOND, {0, 0, 1});
  rig.read(300 * kMs, {1, 1, 0});
  assert_says(text(sensors(rig.at(11 * GST_SECOND))), "110");
}
GST_END_TEST

GST_START_TEST(a_reading_of_unknown_value_or_wrong_size_is_invalid) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {1, 77, 2});
  assert_says(text(sensors(rig.at(0))), "122");
  fail_unless(rig.warning().empty());
  for (int k = 1; k < 4; ++k) {
    rig.read(k * 40 * kMs, {1, 1});
    assert_says(text(sensors(rig.at(k * 40 * kMs))), "222");
  }
  const std::string warning = rig.warning();
  fail_unless(
      warning.find("pir_0") != std::string::npos && warning.find("2 bytes for 3") != std::string::npos, "%s",
      warning.c_str());
  fail_unless(rig.warning().empty());  // once is enough
}
GST_END_TEST

// Without a time a reading is as late as the one before, a frame as late as the frame before.
GST_START_TEST(readings_and_frames_without_a_time_are_taken_as_they_come) {
  Rig rig;
  rig.add_pir();
  rig.read(GST_CLOCK_TIME_NONE, {1, 0, 0});
  assert_says(text(sensors(rig.at(GST_CLOCK_TIME_NONE))), "100");
  rig.read(GST_CLOCK_TIME_NONE, {0, 1, 0});
  assert_says(text(sensors(rig.at(80 * kMs))), "010");
  rig.read(60 * kMs, {0, 0, 1});
  assert_says(text(sensors(rig.at(GST_CLOCK_TIME_NONE))), "001");
}
GST_END_TEST

GST_START_TEST(several_pir_pads_are_one_row_of_sensors_in_the_order_of_their_numbers) {
  Rig rig;
  rig.add_pir(with_sensors(2, 90, 60).c_str(), "pir_5");
  rig.add_pir(with_sensors(1, -30, 0).c_str(), "pir_2");
  rig.add_pir(with_sensors(1, -100, 0).c_str());  // the first free number
  fail_unless(rig.pir.size() == 3 && static_pad(rig.element, "pir_0"));
  rig.read(0, {1, 0}, 0);
  rig.read(0, {2}, 1);
  const CerberusFusion before = rig.show(frame_at(0, 0));
  assert_says(text(sensors(before)), "2222210");
  rig.read(40 * kMs, {0}, 2);
  const CerberusFusion fusion = rig.show(frame_at(40 * kMs, 0));
  assert_says(text(sensors(fusion)), "0222210");
  // The first sensor of pir_5 looks at 90 +- 30.
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TURN_RIGHT);
  fail_unless(fusion.sector_from == 60 && fusion.sector_to == 120);
  const double bearings[] = {-100, 0, -30, 0, 0, 90, 150};  // the bearings in between were not reported
  for (int i = 0; i < 7; ++i) fail_unless(fusion.bearings[i] == bearings[i], "%d: %g", i, fusion.bearings[i]);
}
GST_END_TEST

// The paper's three, one a pad. Rules mean sensors by their places, whatever has become of the others.
GST_START_TEST(a_sensor_of_which_nothing_is_known_keeps_its_place) {
  const char* const kPads[] = {"pir_0", "pir_1", "pir_2"};
  const double bearings[] = {0, -120, 120};
  const auto turns = [&](const char* missing, bool requested, std::size_t fires, int rule,
                         CerberusFusionAction action, const char* expected) {
    Rig rig(true, "rules=paper");
    for (std::size_t i = 0; i < 3; ++i) {
      const bool there = !g_str_equal(kPads[i], missing);
      const std::string caps = with_sensors(1, bearings[i], 0, 120);
      if (there || requested) rig.add_pir(there ? caps.c_str() : nullptr, kPads[i]);
      if (there) rig.read(0, {guint8(i == fires)}, rig.pir.size() - 1);
    }
    const CerberusFusion fusion = rig.show(frame_at(0, 0));
    assert_says(text(sensors(fusion)), expected);
    fail_unless_equals_int(fusion.rule, rule);
    fail_unless_equals_int(fusion.action, action);
  };
  for (const bool requested : {true, false}) {
    turns("pir_0", requested, 2, 4, CERBERUS_FUSION_TURN_RIGHT, "201");
    turns("pir_0", requested, 1, 3, CERBERUS_FUSION_TURN_LEFT, "210");
    turns("pir_1", requested, 2, 4, CERBERUS_FUSION_TURN_RIGHT, "021");
    turns("pir_2", requested, 1, 3, CERBERUS_FUSION_TURN_LEFT, requested ? "012" : "01");
  }
}
GST_END_TEST

GST_START_TEST(no_more_than_sixteen_places_are_given_away) {
  Rig rig;
  rig.add_pir(with_sensors(1, 0, 0).c_str(), "pir_15");  // the 16th
  rig.read(0, {1});
  assert_says(text(sensors(rig.at(0))), "2222222222222221");
  fail_if(gst_element_request_pad_simple(rig.element, "pir_16"));
  gst_harness_set_src_caps_str(rig.add_pir(nullptr, "pir_3"), with_sensors(2, 0, 9).c_str());
  const std::string error = rig.error();
  fail_unless(error.find("pir_3: 2 PIR sensors are too many besides the other pads' 15") != error.npos, "%s",
              error.c_str());
}
GST_END_TEST

GST_START_TEST(each_pad_has_its_own_field_of_view) {
  Rig rig;
  rig.add_pir(with_sensors(1, -90, 0, 40).c_str());
  rig.add_pir(with_sensors(1, 90, 0, 100).c_str());
  rig.read(0, {1}, 0);
  rig.read(0, {0}, 1);
  CerberusFusion fusion = rig.show(frame_at(0, 0));
  fail_unless(fusion.sector_from == -110 && fusion.sector_to == -70);
  rig.read(40 * kMs, {0}, 0);
  rig.read(40 * kMs, {1}, 1);
  fusion = rig.show(frame_at(40 * kMs, 0));
  fail_unless(std::abs(fusion.sector_from - 40) < 1e-9 && std::abs(fusion.sector_to - 140) < 1e-9);
}
GST_END_TEST

GST_START_TEST(new_pir_caps_count_from_their_first_reading_on) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  rig.read(40 * kMs, {1, 0, 0});
  gst_harness_set_src_caps_str(rig.pir[0], with_sensors(2, 100, 40).c_str());
  rig.read(80 * kMs, {0, 1});
  assert_says(text(sensors(rig.at(20 * kMs))), "000");
  assert_says(text(sensors(rig.at(60 * kMs))), "100");
  const CerberusFusion fusion = rig.show(frame_at(90 * kMs, 0));
  assert_says(text(sensors(fusion)), "01");
  fail_unless(std::abs(fusion.sector_from - 110) < 1e-9);  // 140 +- 30
}
GST_END_TEST

GST_START_TEST(what_happens_at_a_pir_pad_stays_there) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  rig.read(0, {1, 0, 0});
  rig.at(0);
  events_out(rig.video);
  gst_harness_set_src_caps_str(pir, with_sensors(1, 0, 0).c_str());
  rig.read(40 * kMs, {1});
  fail_unless(gst_harness_push_event(pir, gst_event_new_tag(gst_tag_list_new_empty())));
  fail_unless(gst_harness_push_event(
      pir, gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty("something"))));
  fail_unless(gst_harness_push_event(pir, gst_event_new_flush_start()));
  rig.at(80 * kMs);  // in the middle of the flush
  fail_unless(gst_harness_push_event(pir, gst_event_new_flush_stop(TRUE)));
  assert_says(text(sensors(rig.at(120 * kMs))), "2");  // earlier readings are discarded
  push_segment(pir);
  rig.read(160 * kMs, {1});
  assert_says(text(sensors(rig.at(160 * kMs))), "1");
  fail_unless(gst_harness_push_event(pir, gst_event_new_eos()));
  assert_says(text(sensors(rig.at(200 * kMs))), "1");  // ended: its last word
  for (const GstEventType type : events_out(rig.video))
    ck_abort_msg("%s reached the source pad", gst_event_type_get_name(type));
}
GST_END_TEST

GST_START_TEST(pir_caps_that_cannot_be_fused_are_refused_by_the_name_of_the_pad) {
  const struct {
    std::string caps;
    const char* why;
  } cases[] = {
      {"application/x-pir,format=presence,sensors=2,bearings=<0.0>,field-of-view=90.0", "bearings"},
      {"application/x-pir,format=presence", "sensors must be 1 to 16"},
      {with_sensors(14, 0, 10), "14 PIR sensors are too many besides the other pads' 3: 16"},
  };
  for (const auto& c : cases) {
    Rig rig;
    rig.add_pir();
    GstHarness* pir = rig.add_pir(nullptr);
    gst_harness_set_src_caps_str(pir, c.caps.c_str());
    const std::string text = rig.error();
    fail_unless(text.find("pir_1") != std::string::npos && text.find(c.why) != std::string::npos, "%s",
                text.c_str());
    fail_unless(rig.error().empty(), "one message a failure");
    fail_unless_equals_int(gst_harness_push(pir, reading(0, {1})), GST_FLOW_NOT_NEGOTIATED);
  }
  Rig rig;
  GstHarness* pir = rig.add_pir();
  GstSegment bytes;
  gst_segment_init(&bytes, GST_FORMAT_BYTES);
  gst_harness_push_event(pir, gst_event_new_segment(&bytes));
  fail_if(gst_harness_push(pir, reading(0, {1, 0, 0})) == GST_FLOW_OK);
  fail_unless(rig.error().find("pir_0") != std::string::npos);
  fail_unless(rig.error().empty(), "one message a failure");
}
GST_END_TEST

GST_START_TEST(pads_come_and_go_while_frames_pass) {
  Rig rig;
  rig.at(0);
  rig.add_pir();
  rig.read(40 * kMs, {1, 0, 0});
  fail_unless_equals_int(rig.at(40 * kMs).n_sensors, 3);
  rig.add_pir(with_sensors(1, 50, 0).c_str());
  rig.read(80 * kMs, {1}, 1);
  assert_says(text(sensors(rig.at(80 * kMs))), "1001");
  EXPECT_CRITICAL(fail_if(gst_element_request_pad_simple(rig.element, "pir_1")));  // taken
  rig.remove_pir(0);
  assert_says(text(sensors(rig.at(120 * kMs))), "21");
  rig.remove_pir(1);
  fail_unless_equals_int(rig.at(160 * kMs).n_sensors, 0);
  rig.add_pir();  // the first number is free again
  fail_unless(static_pad(rig.element, "pir_0"));

  // And while another thread pushes.
  std::thread frames([&] {
    for (int k = 5; k < 400; ++k) rig.at(k * 40 * kMs);
  });
  for (int round = 0; round < 60; ++round) {
    GstPad* pad = gst_element_request_pad_simple(rig.element, "pir_%u");
    gst_element_release_request_pad(rig.element, pad);
    gst_object_unref(pad);
  }
  frames.join();
}
GST_END_TEST

// A pad without a link is absent: its sensors are invalid, and earlier readings are not kept.
GST_START_TEST(a_pad_that_is_unlinked_says_nothing_any_more) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  rig.read(0, {1, 0, 0});
  assert_says(text(sensors(rig.at(0))), "100");
  GstPad* pad = static_pad(rig.element, "pir_0");
  fail_unless(gst_pad_unlink(pir->srcpad, pad));
  assert_says(text(sensors(rig.at(40 * kMs))), "222");
  fail_unless_equals_int(gst_pad_link(pir->srcpad, pad), GST_PAD_LINK_OK);
  assert_says(text(sensors(rig.at(80 * kMs))), "100");
}
GST_END_TEST

// Two sensors of the same bearing disagree; then two of opposite bearings both detect.
GST_START_TEST(sensors_that_contradict_each_other_are_answered_without_hunting) {
  Rig rig(true, "lost-after=0");
  for (const double bearing : {90, 90, -90}) rig.add_pir(with_sensors(1, bearing, 0).c_str());
  for (const std::size_t pad : {0, 1, 2}) rig.read(0, {pad == 0}, pad);
  CerberusFusion fusion = rig.show(frame_at(0, 0));
  assert_says(text(sensors(fusion)), "100");
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TURN_RIGHT);
  for (const std::size_t pad : {0, 1}) rig.read(40 * kMs, {pad == 1}, pad);  // the other way about
  fusion = rig.show(frame_at(40 * kMs, 0));
  assert_says(text(sensors(fusion)), "010");
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TURN_RIGHT);
  rig.posted();
  rig.read(80 * kMs, {1}, 2);  // equally near: the later one is chosen, and kept
  for (int k = 2; k < 100; ++k) {
    fusion = rig.show(frame_at(k * 40 * kMs, 0));
    assert_says(text(sensors(fusion)), "011");
    fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TURN_LEFT);
  }
  fail_unless_equals_int(rig.posted().size(), 1);
  fail_unless(rig.warning().empty() && rig.error().empty());
}
GST_END_TEST

// The pads that a pirsrc and the video of a launch line have been linked to, as "pir_0 sink".
std::string linked_pads(const char* line) {
  g_autoptr(GError) error = nullptr;
  GstElement* pipeline = gst_parse_launch(line, &error);
  std::string names = error ? error->message : "";
  for (const char* of : {"pir", "more", "video"}) {
    GstElement* source = gst_bin_get_by_name(GST_BIN(pipeline), of);
    if (!source) continue;
    GstPad* pad = gst_element_get_static_pad(source, "src");
    GstPad* peer = gst_pad_get_peer(pad);
    names += std::string(names.empty() ? "" : " ") + (peer ? GST_PAD_NAME(peer) : "none");
    if (peer) gst_object_unref(peer);
    gst_object_unref(pad);
    gst_object_unref(source);
  }
  gst_object_unref(pipeline);
  return names;
}

GST_START_TEST(a_source_that_names_no_pad_is_linked_to_the_pad_of_its_kind) {
  for (const char* line :
       {"videotestsrc name=video ! pirfusion name=f ! fakesink pirsrc name=pir ! f.",
        "pirsrc name=pir ! f. videotestsrc name=video ! pirfusion name=f ! fakesink",
        "pirsrc name=pir ! pirfusion name=f ! fakesink videotestsrc name=video ! f.",
        "pirsrc ! queue name=pir ! f. videotestsrc ! queue name=video ! f. pirfusion name=f ! fakesink",
        "videotestsrc ! queue name=video ! f. pirsrc ! queue name=pir ! f. pirfusion name=f ! fakesink"})
    assert_says(linked_pads(line), "pir_0 sink");
  assert_says(linked_pads("pirsrc name=pir ! f. pirsrc name=more ! f. pirfusion name=f ! fakesink"),
              "pir_0 pir_1");
  // A queue that nothing is linked to yet, as behind a decoder that has not begun, waits for video.
  assert_says(linked_pads("pirsrc name=pir ! f. queue name=video ! f. pirfusion name=f ! fakesink"),
              "pir_0 sink");
}
GST_END_TEST

GST_START_TEST(the_video_path_is_as_if_nothing_were_there) {
  Rig rig(true, "return-delay=0");
  GstHarness* pir = rig.add_pir();
  // Latency: the video's, whatever a PIR source answers.
  gst_harness_set_upstream_latency(rig.video, 30 * kMs);
  gst_harness_set_upstream_latency(pir, 500 * kMs);
  fail_unless_equals_uint64(gst_harness_query_latency(rig.video), 30 * kMs);
  // Caps: what downstream takes, and any kind.
  gst_harness_set_sink_caps_str(rig.video, "image/jpeg");
  g_autoptr(GstCaps) caps = gst_pad_peer_query_caps(rig.video->srcpad, nullptr);
  g_autoptr(GstCaps) jpeg = gst_caps_from_string("image/jpeg");
  fail_unless(gst_caps_is_equal(caps, jpeg));
  gst_harness_set_src_caps_str(rig.video, "image/jpeg");
  fail_unless_equals_int(rig.at(0).rule, 7);
  // Allocation: downstream's pool and metas.
  gst_harness_add_propose_allocation_meta(rig.video, GST_VIDEO_META_API_TYPE, nullptr);
  g_autoptr(GstQuery) query = gst_query_new_allocation(jpeg, FALSE);
  fail_unless(gst_pad_peer_query(rig.video->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  g_autoptr(GstQuery) other = gst_query_new_allocation(jpeg, FALSE);
  fail_if(gst_pad_peer_query(pir->srcpad, other));
  // EOS and buffers as they came: same memory, all metas.
  GstBuffer* in = frame_with(40 * kMs, 4);
  GstMemory* memory = gst_buffer_peek_memory(in, 0);
  gst_harness_push(rig.video, in);
  g_autoptr(GstBuffer) out = gst_harness_pull(rig.video);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory);
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 1);
  events_out(rig.video);
  fail_unless(gst_harness_push_event(rig.video, gst_event_new_eos()));
  const auto events = events_out(rig.video);
  fail_unless(events.size() == 1 && events[0] == GST_EVENT_EOS);
}
GST_END_TEST

// Another branch of a tee holds the same buffer: it must not see our meta, and the memory is not copied.
GST_START_TEST(a_shared_frame_is_not_written_on) {
  Rig rig;
  GstBuffer* in = gst_buffer_ref(frame(0));
  gst_harness_push(rig.video, in);
  g_autoptr(GstBuffer) out = gst_harness_pull(rig.video);
  fail_unless(out != in && cerberus_buffer_peek_fusion(out) && !cerberus_buffer_peek_fusion(in));
  fail_unless(gst_buffer_peek_memory(out, 0) == gst_buffer_peek_memory(in, 0));
  gst_buffer_unref(in);
}
GST_END_TEST

GST_START_TEST(a_flush_and_a_new_segment_clear_the_followed_track) {
  for (const bool flush : {true, false}) {
    Rig rig;
    rig.show(frame_with(0, 3));
    fail_unless(rig.at(40 * kMs).camera_found);
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    segment.base = 80 * kMs;  // running time goes on
    segment.start = segment.time = 10 * GST_SECOND;
    if (flush) {
      gst_harness_push_event(rig.video, gst_event_new_flush_start());
      gst_harness_push_event(rig.video, gst_event_new_flush_stop(FALSE));
    }
    gst_harness_push_event(rig.video, gst_event_new_segment(&segment));
    fail_if(rig.at(segment.start).camera_found);
  }
  // The same segment again (a new link upstream) is no new one.
  Rig rig;
  rig.show(frame_with(0, 3));
  GstSegment same;
  gst_segment_init(&same, GST_FORMAT_TIME);
  gst_harness_push_event(rig.video, gst_event_new_segment(&same));
  fail_unless(rig.at(40 * kMs).camera_found);
}
GST_END_TEST

GST_START_TEST(running_time_counts_not_the_timestamps) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  GstSegment late;
  gst_segment_init(&late, GST_FORMAT_TIME);
  late.start = late.time = 100 * GST_SECOND;  // running time 0 at 100 s
  gst_harness_push_event(rig.video, gst_event_new_segment(&late));
  late.start = 50 * GST_SECOND;
  gst_harness_push_event(pir, gst_event_new_segment(&late));
  rig.read(50 * GST_SECOND, {1, 0, 0});
  rig.read(50 * GST_SECOND + 80 * kMs, {0, 1, 0});
  say(rig, pose(15, 60 * kMs));
  say(rig, pose(25, 100 * kMs));
  CerberusFusion fusion = rig.at(100 * GST_SECOND + 79 * kMs);
  fail_unless(text(sensors(fusion)) == "100" && fusion.pan == 15);
  fusion = rig.at(100 * GST_SECOND + 100 * kMs);
  fail_unless(text(sensors(fusion)) == "010" && fusion.pan == 25);
}
GST_END_TEST

static Suite* pirfusion_pads_suite() {
  watch_library_log();
  Suite* s = suite_create("pirfusion_pads");
  TCase* tc = tcase_create("readings");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, live_the_newest_reading_not_later_than_the_frame_counts);
  tcase_add_test(tc, readings_out_of_order_are_put_where_they_belong);
  tcase_add_test(tc, a_reading_of_unknown_value_or_wrong_size_is_invalid);
  tcase_add_test(tc, readings_and_frames_without_a_time_are_taken_as_they_come);
  tcase_add_test(tc, several_pir_pads_are_one_row_of_sensors_in_the_order_of_their_numbers);
  tcase_add_test(tc, a_sensor_of_which_nothing_is_known_keeps_its_place);
  tcase_add_test(tc, no_more_than_sixteen_places_are_given_away);
  tcase_add_test(tc, each_pad_has_its_own_field_of_view);
  tcase_add_test(tc, new_pir_caps_count_from_their_first_reading_on);
  tcase_add_test(tc, what_happens_at_a_pir_pad_stays_there);
  tcase_add_test(tc, pir_caps_that_cannot_be_fused_are_refused_by_the_name_of_the_pad);
  tcase_add_test(tc, pads_come_and_go_while_frames_pass);
  tcase_add_test(tc, a_pad_that_is_unlinked_says_nothing_any_more);
  tcase_add_test(tc, sensors_that_contradict_each_other_are_answered_without_hunting);
  tc = tcase_create("video");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_source_that_names_no_pad_is_linked_to_the_pad_of_its_kind);
  tcase_add_test(tc, the_video_path_is_as_if_nothing_were_there);
  tcase_add_test(tc, a_shared_frame_is_not_written_on);
  tcase_add_test(tc, a_flush_and_a_new_segment_clear_the_followed_track);
  tcase_add_test(tc, running_time_counts_not_the_timestamps);
  return s;
}

GST_CHECK_MAIN(pirfusion_pads)
