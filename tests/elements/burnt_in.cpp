// SPDX-License-Identifier: LGPL-2.1-or-later
// A clock and a logo that the camera writes into its pictures, drawn with cairo over a wall that the camera sweeps or
// looks at: what motiondetect and the stages make of it.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "../bench/burnt_in_scenes.h"
#include "scene.h"

namespace {

using cerberus::bench::Corner;
using cerberus::bench::write_into;
using cerberus::bench::Writing;
using cerberus::vision::Box;
using scene::kHeight;
using scene::kWidth;
using scene::Line;
using scene::Regions;

constexpr double kRate = 25, kLearnt = 5, kSeconds = 8, kSecondsWithTens = 12;
constexpr int kTurn = 3, kReach = 60;  // pixels a frame; frames from one end of the sweep to the other
constexpr char kChain[] = "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack";

struct Film {
  bool sweeps = false;
  std::vector<Box> writing{};  // of the last frame

  GstBuffer* frame(int n) {
    const int turn = n % (2 * kReach), place = turn < kReach ? turn : 2 * kReach - turn;
    std::vector<std::uint8_t> grey = scene::World{}.wall_from(sweeps ? kTurn * place : 0);
    const cerberus::vision::MutableGrayView view{grey.data(), kWidth, kHeight, kWidth};
    writing = {write_into(view, Writing::sans_clock, Corner::top_left, n / kRate),
               write_into(view, Writing::monospace_clock, Corner::bottom_left, n / kRate)};
    return scene::buffer("GRAY8", kWidth, kHeight, grey, static_cast<GstClockTime>(n) * scene::kStep);
  }
};

// The boxes of all messages that say what was found.
std::vector<Box> reported(GstBus* bus) {
  std::vector<Box> boxes;
  while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_INFO)) {
    g_autoptr(GError) error = nullptr;
    g_autofree gchar* detail = nullptr;
    gst_message_parse_info(message, &error, &detail);
    gst_message_unref(message);
    const std::string text = error->message;
    // gst-launch-1.0 prints the detail only.
    fail_unless(strstr(detail, text.c_str()) && strstr(detail, "burnt-in=false"), "%s", detail);
    constexpr char kBefore[] = "left out: ";
    const std::size_t at = text.find(kBefore);
    fail_unless(at != std::string::npos, "%s", text.c_str());
    long w, h, x, y;
    int length = 0;
    for (const char* p = text.c_str() + at + sizeof kBefore - 1;
         std::sscanf(p, "%ldx%ld+%ld+%ld%n", &w, &h, &x, &y, &length) == 4; p += p[0] == ',' ? 2 : 0) {
      boxes.push_back({double(x), double(y), double(w), double(h)});
      p += length;
    }
  }
  return boxes;
}

}  // namespace

// The tens of the seconds change after 10 s: a box that grows is not reported again.
GST_START_TEST(each_box_is_reported_once_and_no_object_is_left) {
  for (const bool sweeps : {false, true}) {
    Line line("motiondetect ! identity");
    Film film{sweeps};
    int with_object = 0;
    for (int n = 0; n < kSecondsWithTens * kRate; ++n) {
      GstBuffer* out = line.through(film.frame(n));
      with_object += n > kLearnt * kRate && Regions(out).size() > 0;
      gst_buffer_unref(out);
    }
    fail_unless(with_object <= .01 * (kSecondsWithTens - kLearnt) * kRate, "%s: an object in %d frames",
                sweeps ? "sweeping" : "standing", with_object);
    const std::vector<Box> boxes = reported(line.bus);
    fail_unless_equals_int(boxes.size(), film.writing.size());
    for (const Box& writing : film.writing) {
      int over = 0;
      for (const Box& box : boxes) over += overlap_area(box, writing) > 0;
      fail_unless_equals_int(over, 1);
    }
  }
}
GST_END_TEST

GST_START_TEST(without_the_property_nothing_is_reported_and_the_clock_is_an_object) {
  Line line("motiondetect burnt-in=false ! identity");
  Film film{true};
  int with_object = 0;
  for (int n = 0; n < kSeconds * kRate; ++n) {
    GstBuffer* out = line.through(film.frame(n));
    with_object += n > kLearnt * kRate && Regions(out).size() > 0;
    gst_buffer_unref(out);
  }
  fail_unless(reported(line.bus).empty());
  fail_unless(with_object > .5 * (kSeconds - kLearnt) * kRate, "%d frames", with_object);
}
GST_END_TEST

// The element that measures the camera receives the boxes from the one that learns them.
GST_START_TEST(the_stages_one_by_one_give_what_motiondetect_gives) {
  Line whole("motiondetect ! identity"), chain(kChain);
  Film film{true};
  for (int n = 0; n < kSeconds * kRate; ++n) {
    GstBuffer* in = film.frame(n);
    GstBuffer *a = whole.through(gst_buffer_copy_deep(in)), *b = chain.through(in);
    const std::string of_whole = Regions(a).text(), of_chain = Regions(b).text();
    ck_assert_str_eq(of_whole.c_str(), of_chain.c_str());
    const auto *of_a = cerberus_buffer_peek_camera_motion(a), *of_b = cerberus_buffer_peek_camera_motion(b);
    for (int i = 0; i < 9; ++i) fail_unless(of_a->matrix[i] == of_b->matrix[i], "frame %d: element %d", n, i);
    gst_buffer_unref(a);
    gst_buffer_unref(b);
  }
  const std::vector<Box> boxes = reported(whole.bus), others = reported(chain.bus);
  fail_unless_equals_int(boxes.size(), 2);
  fail_unless_equals_int(others.size(), 2);
}
GST_END_TEST

// The list is published again when it changes: the last one is empty when nothing is learnt any longer.
GST_START_TEST(the_measuring_element_receives_that_nothing_is_learnt_any_longer) {
  Line line("fuzzythreshold");
  Film film{true};
  std::vector<gsize> lengths;
  for (int n = 0; n < (kSeconds + 1) * kRate; ++n) {
    if (n == kSeconds * kRate) g_object_set(line.harness->element, "burnt-in", FALSE, nullptr);
    gst_buffer_unref(line.through(film.frame(n)));
    while (GstEvent* event = gst_harness_try_pull_upstream_event(line.harness)) {
      if (gst_event_has_name(event, "cerberus-burnt-in")) {
        g_autoptr(GBytes) boxes = nullptr;
        int width = 0, height = 0;
        fail_unless(gst_structure_get(gst_event_get_structure(event), "boxes", G_TYPE_BYTES, &boxes, "width",
                                      G_TYPE_INT, &width, "height", G_TYPE_INT, &height, nullptr));
        fail_unless(width == kWidth && height == kHeight);
        lengths.push_back(g_bytes_get_size(boxes) / sizeof(Box));
      }
      gst_event_unref(event);
    }
  }
  fail_unless(lengths.size() >= 3);
  fail_unless_equals_int(lengths.front(), 0);  // what another element said before is true no longer
  fail_unless_equals_int(lengths[lengths.size() - 2], film.writing.size());
  fail_unless_equals_int(lengths.back(), 0);
}
GST_END_TEST

static Suite* burnt_in_suite() {
  watch_library_log();
  Suite* suite = suite_create("burnt_in");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, each_box_is_reported_once_and_no_object_is_left);
  tcase_add_test(tests, without_the_property_nothing_is_reported_and_the_clock_is_an_object);
  tcase_add_test(tests, the_measuring_element_receives_that_nothing_is_learnt_any_longer);
  tcase_add_test(tests, the_stages_one_by_one_give_what_motiondetect_gives);
  return suite;
}

GST_CHECK_MAIN(burnt_in)
