// SPDX-License-Identifier: LGPL-2.1-or-later
// What holds for every element of the corridor, cameramotion to motiontrack and motiondetect: frames go through whole
// and uncopied, every format gives the same answer, and what cannot be analysed is refused in one clear sentence.
#include <algorithm>
#include <set>

#include "scene.h"
#include "support.h"

namespace {

using cerberus::vision::Stage;
using scene::kElementCount;
using scene::kElements;
using scene::Line;
using scene::Regions;
using scene::World;

struct Size {
  int width, height;
};

// Regions of a walk of `frames` frames in a format, as text.
std::string walk(const char* format, const std::string& launch, Size size = {scene::kWidth, scene::kHeight},
                 int frames = 20) {
  World world;
  world.width = size.width;
  world.height = size.height;
  Line line(launch, scene::caps(format, size.width, size.height));
  std::string text;
  for (int k = 0; k < frames; ++k) {
    GstBuffer* out =
        line.through(scene::buffer(format, size.width, size.height, world.picture(k), k * scene::kStep));
    text += Regions(out).text() + "\n";
    gst_buffer_unref(out);
  }
  return text;
}

GST_START_TEST(frames_go_through_in_the_same_memory_with_the_same_times) {
  Line line(kElements[__i__]);
  const World world;
  for (int k = 0; k < 10; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    const GstMemory* memory = gst_buffer_peek_memory(in, 0);
    const std::vector<std::uint8_t> picture = world.picture(k);
    GstBuffer* out = line.through(in);
    ck_assert_ptr_eq(gst_buffer_peek_memory(out, 0), memory);
    fail_unless_equals_int(gst_buffer_n_memory(out), 1);
    fail_unless_equals_uint64(GST_BUFFER_PTS(out), k * scene::kStep);
    fail_unless_equals_uint64(GST_BUFFER_DURATION(out), scene::kStep);
    fail_unless_equals_int(gst_buffer_memcmp(out, 0, picture.data(), picture.size()), 0);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// As behind a tee: the buffer has a second reference and is not writable.
GST_START_TEST(a_shared_frame_is_neither_copied_nor_annotated_for_the_others) {
  Line line(kElements[__i__]);
  const World world;
  for (int k = 0; k < 10; ++k) {
    GstBuffer* in = gst_buffer_ref(scene::grey_buffer(world, k));
    GstBuffer* out = line.through(in);
    fail_unless(out != in);
    ck_assert_ptr_eq(gst_buffer_peek_memory(out, 0), gst_buffer_peek_memory(in, 0));
    gpointer position = nullptr;
    fail_unless(gst_buffer_iterate_meta(in, &position) == nullptr, "the other branch's buffer got a meta");
    position = nullptr;
    fail_unless(gst_buffer_iterate_meta(out, &position) != nullptr, "our branch's buffer got none");
    gst_buffer_unref(in);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(every_format_gives_the_same_regions) {
  const std::string expected = walk("GRAY8", "motiondetect confirm-time=0");
  fail_unless(expected.find('.') != std::string::npos, "nothing was found at all");
  const std::string found = walk(kFormats[__i__], "motiondetect confirm-time=0");
  ck_assert_str_eq(found.c_str(), expected.c_str());
}
GST_END_TEST

GST_START_TEST(every_format_works_at_odd_sizes) {
  const Size odd{331, 241};
  const std::string expected = walk("GRAY8", "motiondetect confirm-time=0", odd);
  const std::string found = walk(kFormats[__i__], "motiondetect confirm-time=0", odd);
  ck_assert_str_eq(found.c_str(), expected.c_str());
  walk(kFormats[__i__], "motiondetect", {33, 35}, 5);
}
GST_END_TEST

GST_START_TEST(sizes_from_32x32_to_8192x8192_are_accepted) {
  for (const Size size : {Size{32, 32}, Size{33, 35}, Size{4096, 2160}, Size{2160, 3840}, Size{4000, 3000},
                          Size{8192, 8192}, Size{8192, 32}, Size{32, 8192}}) {
    Line line(kElements[__i__], scene::caps("GRAY8", size.width, size.height));
    for (int k = 0; k < 3; ++k) {
      const std::vector<std::uint8_t> grey(static_cast<std::size_t>(size.width) * size.height, 100);
      gst_buffer_unref(line.through(scene::buffer("GRAY8", size.width, size.height, grey, k * scene::kStep)));
    }
    fail_unless(line.messages(GST_MESSAGE_ERROR).empty());
  }
}
GST_END_TEST

void expect_refusal(const char* element, const std::string& caps, const char* word, const char* other_word) {
  Line line(element, caps);
  g_autoptr(GstBuffer) in = gst_buffer_new_allocate(nullptr, 4096 * 2304 * 2, nullptr);
  for (int start = 0; start < 2; ++start) {
    fail_unless_equals_int(gst_harness_push(line.harness, gst_buffer_ref(in)), GST_FLOW_NOT_NEGOTIATED);
    line.push_caps(caps);  // upstream tries again
    fail_unless_equals_int(gst_harness_push(line.harness, gst_buffer_ref(in)), GST_FLOW_NOT_NEGOTIATED);
    const std::vector<std::string> errors = line.messages(GST_MESSAGE_ERROR);
    fail_unless_equals_int(errors.size(), 1);
    fail_unless(errors[0].find(word) != std::string::npos, "%s", errors[0].c_str());
    fail_unless(errors[0].find(other_word) != std::string::npos, "%s", errors[0].c_str());
    // A restart is reported again.
    line.restart(caps);
  }
}

// As upstream sees it before it sends anything: what a template promises is taken, and nothing else.
GST_START_TEST(pads_promise_exactly_the_sizes_that_are_accepted) {
  Line line(kElements[__i__]);
  for (GstPad* pad : {line.harness->srcpad, line.harness->sinkpad})
    for (const auto& [size, good] : {std::pair{Size{32, 32}, true},
                                     {Size{8192, 8192}, true},
                                     {Size{31, 240}, false},
                                     {Size{320, 31}, false},
                                     {Size{8193, 240}, false},
                                     {Size{320, 8193}, false}}) {
      g_autoptr(GstCaps) caps =
          gst_caps_from_string(scene::caps("P010_10LE", size.width, size.height).c_str());
      g_autoptr(GstPad) peer = gst_pad_get_peer(pad);
      g_autoptr(GstCaps) pad_template = gst_pad_get_pad_template_caps(peer);
      fail_unless_equals_int(gst_caps_can_intersect(caps, pad_template), good);
      fail_unless_equals_int(gst_pad_query_accept_caps(peer, caps), good);
    }
}
GST_END_TEST

GST_START_TEST(what_is_too_large_or_too_small_is_scaled_by_a_videoscale_in_front) {
  for (const Size size : {Size{9000, 90}, Size{16, 64}}) {
    Line line("videoscale ! " + std::string(kElements[__i__]), scene::caps("GRAY8", size.width, size.height));
    const std::vector<std::uint8_t> grey(static_cast<std::size_t>(size.width) * size.height, 100);
    gst_buffer_unref(line.through(scene::buffer("GRAY8", size.width, size.height, grey, 0)));
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(line.harness->sinkpad);
    gint width = 0;
    fail_unless(gst_structure_get_int(gst_caps_get_structure(caps, 0), "width", &width));
    fail_unless_equals_int(width, size.width > 32 ? 8192 : 32);
  }
}
GST_END_TEST

GST_START_TEST(interlaced_video_is_refused_naming_deinterlace) {
  for (const char* mode : {"interleaved", "mixed"})
    expect_refusal(
        kElements[__i__],
        scene::caps("I420", 320, 240, (std::string(",framerate=25/1,interlace-mode=") + mode).c_str()),
        "deinterlace", "Interlaced");
  expect_refusal(kElements[__i__],
                 "video/x-raw(format:Interlaced),format=I420,width=320,height=240,framerate=25/1,"
                 "interlace-mode=alternate",
                 "deinterlace", "Interlaced");
}
GST_END_TEST

GST_START_TEST(caps_without_a_frame_rate_are_enough) {
  for (const char* rate : {"", ",framerate=0/1"}) {
    Line line(kElements[__i__], scene::caps("GRAY8", scene::kWidth, scene::kHeight, rate));
    line.run(World{}, 0, 10);
    fail_unless(line.messages(GST_MESSAGE_ERROR).empty());
  }
}
GST_END_TEST

GST_START_TEST(a_new_size_in_mid_stream_begins_a_new_scene) {
  Line line(kElements[__i__]);
  line.run(World{}, 0, 10);
  World larger;
  larger.width = 400;
  larger.height = 300;
  gst_harness_set_src_caps_str(line.harness, scene::caps("GRAY8", 400, 300).c_str());
  line.run(larger, 10, 12, [](int, GstBuffer* out) { fail_unless_equals_int(Regions(out).size(), 0); });
  line.run(larger, 12, 20);
  gst_harness_set_src_caps_str(line.harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  line.run(World{}, 20, 30);
  fail_unless(line.messages(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST

GST_START_TEST(the_end_of_the_stream_goes_through_and_the_element_starts_again) {
  Line line(kElements[__i__]);
  line.run(World{}, 0, 10);
  fail_unless(gst_harness_push_event(line.harness, gst_event_new_eos()));
  GstEvent* event = nullptr;
  while ((event = gst_harness_pull_event(line.harness)) && GST_EVENT_TYPE(event) != GST_EVENT_EOS)
    gst_event_unref(event);
  fail_unless(event != nullptr);
  gst_event_unref(event);
  line.restart();
  line.run(World{}, 0, 10);
  fail_unless(line.messages(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST

GST_START_TEST(two_instances_do_not_know_of_each_other) {
  World left, right;
  right.start = 220;
  right.speed = -3;
  right.wall = 9;
  const auto alone = [&](const World& world) {
    Line line(kElements[__i__]);
    std::string text;
    line.run(world, 0, 20, [&](int, GstBuffer* out) { text += Regions(out).text() + "\n"; });
    return text;
  };
  const std::string expected_left = alone(left), expected_right = alone(right);
  std::string text_left, text_right;
  Line a(kElements[__i__]), b(kElements[__i__]);
  for (int k = 0; k < 20; ++k) {
    a.run(left, k, k + 1, [&](int, GstBuffer* out) { text_left += Regions(out).text() + "\n"; });
    b.run(right, k, k + 1, [&](int, GstBuffer* out) { text_right += Regions(out).text() + "\n"; });
  }
  ck_assert_str_eq(text_left.c_str(), expected_left.c_str());
  ck_assert_str_eq(text_right.c_str(), expected_right.c_str());
}
GST_END_TEST

GST_START_TEST(no_latency_is_added_and_quality_of_service_is_off) {
  GstElement* element = gst_element_factory_make(kElements[__i__], nullptr);
  Line line(kElements[__i__]);
  fail_unless_equals_uint64(gst_harness_query_latency(line.harness), 0);
  if (GST_IS_BASE_TRANSFORM(element)) fail_if(gst_base_transform_is_qos_enabled(GST_BASE_TRANSFORM(element)));
  gst_object_unref(element);
}
GST_END_TEST

// What each stage promises when nothing is upstream: the missing steps are done with their defaults.
GST_START_TEST(a_stage_alone_does_the_missing_steps_itself) {
  struct Promise {
    const char* element;
    std::vector<Stage> fields;
    bool motion, threshold, regions;
  };
  const Promise promises[] = {
      {"cameramotion", {Stage::luma, Stage::camera}, true, false, false},
      {"threeframediff", {Stage::luma, Stage::differences}, false, false, false},
      {"fuzzythreshold", {Stage::luma, Stage::differences, Stage::foreground}, false, true, false},
      {"motionregions keep-planes=always",
       {Stage::luma, Stage::differences, Stage::foreground, Stage::regions},
       false,
       true,
       true},
      {"motiontrack confirm-time=0", {}, false, true, true},
      {"motiondetect confirm-time=0", {}, true, true, true},
  };
  const Promise& promise = promises[__i__];
  // A capsfilter makes a launch line of the single element.
  Line line(std::string(promise.element) + " ! identity");
  line.run(World{}, 0, 20, [&](int k, GstBuffer* out) {
    const cerberus::vision::Record record = records::record_of(out);
    fail_unless_equals_int(static_cast<bool>(record), !promise.fields.empty());
    for (int s = 0; record && s <= static_cast<int>(Stage::tracks); ++s) {
      const auto stage = static_cast<Stage>(s);
      fail_unless_equals_int(record->has(stage), std::ranges::count(promise.fields, stage));
    }
    fail_unless((cerberus_buffer_peek_camera_motion(out) != nullptr) == promise.motion);
    fail_unless((records::threshold_facts_of(out) != nullptr) == promise.threshold);
    if (k < 15) return;
    fail_unless((Regions(out).size() > 0) == promise.regions, "frame %d has %u regions", k,
                Regions(out).size());
  });
}
GST_END_TEST

// A frame that waits in a queue holds none of our memory, and no picture is allocated per frame.
GST_START_TEST(pictures_are_used_again) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  std::set<const void*> memories;
  line.run(World{}, 0, 60, [&](int, GstBuffer* out) {
    const cerberus::vision::Record record = records::record_of(out);
    if (!record) return;
    for (const auto* picture :
         {&*record->luma, &record->differences->current, &record->foreground->mask, &record->regions->mask})
      if (*picture) memories.insert((*picture)->view().data);
  });
  fail_unless(memories.size() <= 8, "%zu different pictures in 60 frames", memories.size());
}
GST_END_TEST

Suite* corridor_suite() {
  Suite* suite = suite_create("corridor");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 120);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  constexpr int kFormatCount = G_N_ELEMENTS(kFormats);
  tcase_add_loop_test(tests, frames_go_through_in_the_same_memory_with_the_same_times, 0, kElementCount);
  tcase_add_loop_test(tests, a_shared_frame_is_neither_copied_nor_annotated_for_the_others, 0, kElementCount);
  tcase_add_loop_test(tests, every_format_gives_the_same_regions, 0, kFormatCount);
  tcase_add_loop_test(tests, every_format_works_at_odd_sizes, 0, kFormatCount);
  tcase_add_loop_test(tests, sizes_from_32x32_to_8192x8192_are_accepted, 0, kElementCount);
  tcase_add_loop_test(tests, pads_promise_exactly_the_sizes_that_are_accepted, 0, kElementCount);
  tcase_add_loop_test(tests, what_is_too_large_or_too_small_is_scaled_by_a_videoscale_in_front, 0,
                      kElementCount);
  tcase_add_loop_test(tests, interlaced_video_is_refused_naming_deinterlace, 0, kElementCount);
  tcase_add_loop_test(tests, caps_without_a_frame_rate_are_enough, 0, kElementCount);
  tcase_add_loop_test(tests, a_new_size_in_mid_stream_begins_a_new_scene, 0, kElementCount);
  tcase_add_loop_test(tests, the_end_of_the_stream_goes_through_and_the_element_starts_again, 0,
                      kElementCount);
  tcase_add_loop_test(tests, two_instances_do_not_know_of_each_other, 0, kElementCount);
  tcase_add_loop_test(tests, no_latency_is_added_and_quality_of_service_is_off, 0, kElementCount);
  tcase_add_loop_test(tests, a_stage_alone_does_the_missing_steps_itself, 0, kElementCount);
  tcase_add_loop_test(tests, pictures_are_used_again, 0, kElementCount);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(corridor);
