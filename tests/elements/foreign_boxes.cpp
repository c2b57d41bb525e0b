// SPDX-License-Identifier: LGPL-2.1-or-later
// Boxes that another element has found are the second witness of motiondetect: a fake detector attaches the true ones at 2 Hz, as
// regions of interest or as detections of GstAnalytics, while the camera turns.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "scene.h"

#include "cerberus/private/compat.hpp"
#if CERBERUS_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

namespace {

using scene::Regions;

constexpr int kLook = 12;  // frames from look to look: about 2 a second
constexpr int kGone = 60;  // frame at which the figure is gone
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // no confidence is given

void add_region_of_interest(GstBuffer* buffer, const char* label, double x, double y, double width,
                            double height, double confidence) {
  const auto pixels = [](double n) { return static_cast<guint>(static_cast<gint64>(n)); };
  GstVideoRegionOfInterestMeta* roi = gst_buffer_add_video_region_of_interest_meta(
      buffer, label, pixels(x), pixels(y), pixels(width), pixels(height));
  if (std::isnan(confidence)) return;
  gst_video_region_of_interest_meta_add_param(
      roi, gst_structure_new("detection", "confidence", G_TYPE_DOUBLE, confidence, nullptr));
}

#if CERBERUS_ANALYTICS
void add_detection(GstBuffer* buffer, const char* label, double x, double y, double width, double height,
                   double confidence) {
  GstAnalyticsRelationMeta* meta = gst_buffer_get_analytics_relation_meta(buffer);
  if (!meta) meta = gst_buffer_add_analytics_relation_meta(buffer);
  GstAnalyticsODMtd detection;
  fail_unless(gst_analytics_relation_meta_add_od_mtd(
      meta, g_quark_from_string(label), static_cast<gint>(x), static_cast<gint>(y), static_cast<gint>(width),
      static_cast<gint>(height), static_cast<gfloat>(std::isnan(confidence) ? 1 : confidence), &detection));
}
#endif

using Form = void (*)(GstBuffer*, const char*, double, double, double, double, double);
const std::vector<Form> kForms = {
    add_region_of_interest,
#if CERBERUS_ANALYTICS
    add_detection,
    // Both, as DL Streamer does.
    [](GstBuffer* buffer, const char* label, double x, double y, double width, double height,
       double confidence) {
      add_region_of_interest(buffer, label, x, y, width, height, confidence);
      add_detection(buffer, label, x, y, width, height, confidence);
    },
#endif
};

// The camera follows somebody who walks to the right, and loses sight of the figure at kGone.
scene::World walk() {
  scene::World world;
  world.start = 60, world.speed = 4, world.pan = 3;
  return world;
}

GstBuffer* frame_of(const scene::World& world, int number) {
  scene::World now = world;
  now.figure = number < kGone;
  return scene::grey_buffer(now, number);
}

void expect_figure(const CerberusRegion& r, const scene::World& world, int frame, double scale = 1) {
  const double left = world.figure_left(frame) * scale, top = world.figure_top() * scale;
  const double right = left + scene::kFigureWidth * scale, bottom = top + scene::kFigureHeight * scale;
  const double across = std::min(right, r.x + r.width) - std::max(left, r.x);
  const double down = std::min(bottom, r.y + r.height) - std::max(top, r.y);
  const double both = std::max(across, 0.0) * std::max(down, 0.0);
  const double shared = both / (r.width * r.height + (right - left) * (bottom - top) - both);
  fail_unless(shared > .5, "frame %d: %.0f,%.0f %.0fx%.0f shares %.2f", frame, r.x, r.y, r.width, r.height,
              shared);
}

int count_foreign(GstBuffer* buffer) {
  int count = 0;
  gpointer state = nullptr;
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE))
    count += !gst_video_region_of_interest_meta_get_param(
        reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta), CERBERUS_REGION_STRUCTURE);
  return count;
}

}  // namespace

// The regions at every frame: between looks the figure has its box and its identity, and none remains once it has left.
GST_START_TEST(a_detector_of_2_hz_gives_persons_who_are_followed_between_its_looks_and_end) {
  const scene::World world = walk();
  for (const Form attach : kForms)
    for (const double confidence : {.9, kNone}) {
      scene::Line line("motiondetect");
      std::set<guint> identities;
      int frames = 0, last = 0;
      for (int n = 0; n < kGone + 75; ++n) {
        GstBuffer* in = frame_of(world, n);
        const bool looked = n % kLook == 0 && n < kGone;
        if (looked)
          attach(in, "Person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                 scene::kFigureHeight, confidence);
        GstBuffer* out = line.through(in);
        const Regions regions(out);
        for (guint i = 0; i < regions.size(); ++i) {
          if (!regions[i].person) continue;
          identities.insert(regions[i].id);
          last = n;
          if (n >= kGone) continue;
          ++frames;
          expect_figure(regions[i], world, n);
        }
        if (attach == add_region_of_interest) fail_unless_equals_int(count_foreign(out), looked);
        gst_buffer_unref(out);
      }
      fail_unless_equals_int(identities.size(), 1);
      // From the second look on at the latest.
      fail_unless(frames >= kGone - kLook - 1, "%d", frames);
      fail_unless(last < kGone + 50, "still there at frame %d", last);
    }
}
GST_END_TEST

// Ten looks without the figure are .4 s.
GST_START_TEST(a_detector_of_every_frame_ends_a_person_soon) {
  const scene::World world = walk();
  scene::Line line("motiondetect");
  int last = 0;
  for (int n = 0; n < kGone + 40; ++n) {
    GstBuffer* in = frame_of(world, n);
    if (n < kGone)
      add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                             scene::kFigureHeight, .9);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i)
      if (regions[i].person) last = n;
    gst_buffer_unref(out);
  }
  fail_unless(last >= kGone - 1 && last < kGone + 12, "still there at frame %d", last);
}
GST_END_TEST

// As videorate makes three times as many frames: the copies have the boxes once more.
GST_START_TEST(boxes_on_copies_of_a_frame_are_no_further_looks) {
  const scene::World world = walk();
  constexpr int kCopies = 3;
  scene::Line line("motiondetect");
  std::set<guint> identities;
  int frames = 0;
  for (int n = 0; n < kGone; ++n)
    for (int copy = 0; copy < kCopies; ++copy) {
      GstBuffer* in = frame_of(world, n);
      GST_BUFFER_PTS(in) += static_cast<GstClockTime>(copy) * scene::kStep / kCopies;
      if (copy > 0) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
      if (n % kLook == 0)
        add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                               scene::kFigureHeight, .9);
      GstBuffer* out = line.through(in);
      const Regions regions(out);
      for (guint i = 0; i < regions.size(); ++i)
        if (regions[i].person)
          identities.insert(regions[i].id), ++frames, expect_figure(regions[i], world, n);
      gst_buffer_unref(out);
    }
  fail_unless_equals_int(identities.size(), 1);
  fail_unless(frames >= kCopies * (kGone - kLook - 1), "%d", frames);
}
GST_END_TEST

// videorate in front of the detector: the first box may be on a copy. What is published stays so.
GST_START_TEST(a_first_look_at_a_copy_takes_nothing_away) {
  scene::World world;
  scene::Line line("motiondetect");
  constexpr int kFirst = 20;
  for (int n = 0; n < 2 * kFirst; ++n)
    for (const bool copy : {false, true}) {
      GstBuffer* in = scene::grey_buffer(world, n);
      if (copy) {
        GST_BUFFER_PTS(in) += scene::kStep / 2;
        GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
      }
      if (copy && n >= kFirst && (n - kFirst) % kLook == 0)
        add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                               scene::kFigureHeight, .9);
      GstBuffer* out = line.through(in);
      if (n >= kFirst - 1) fail_unless_equals_int(Regions(out).size(), 1);
      gst_buffer_unref(out);
    }
}
GST_END_TEST

// Both witnesses count, whether the detector looks at all frames or at some.
GST_START_TEST(who_walks_before_a_detector_of_every_frame_moves) {
  const scene::World world;
  for (const int look : {1, 2, kLook}) {
    scene::Line line("motiondetect");
    int persons = 0, moving = 0;
    for (int n = 0; n < kGone; ++n) {
      GstBuffer* in = scene::grey_buffer(world, n);
      if (n % look == 0)
        add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                               scene::kFigureHeight, .9);
      GstBuffer* out = line.through(in);
      const Regions regions(out);
      for (guint i = 0; i < regions.size(); ++i) persons += regions[i].person, moving += regions[i].motion;
      gst_buffer_unref(out);
    }
    fail_unless(persons >= kGone - 2 * kLook && moving >= persons - kLook, "look %d: %d persons, %d move",
                look, persons, moving);
  }
}
GST_END_TEST

// Before a camera that stands what moves has a track before the detector looks first: it is the same afterwards.
GST_START_TEST(the_first_look_leaves_the_tracks_of_before_as_they_are) {
  scene::World world;
  scene::Line line("motiondetect");
  constexpr int kFirst = 20;
  guint before = 0;
  for (int n = 0; n < 60; ++n) {
    GstBuffer* in = scene::grey_buffer(world, n);
    if (n >= kFirst && (n - kFirst) % kLook == 0)
      add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                             scene::kFigureHeight, .9);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    if (n == kFirst - 1) {
      fail_unless_equals_int(regions.size(), 1);
      before = regions[0].id;
    } else if (n >= kFirst) {
      fail_unless(regions.size() == 1 && regions[0].id == before && regions[0].motion, "frame %d", n);
      fail_unless(regions[0].person);
    }
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// The first box is elsewhere in the picture, and the track has not gone far yet: what was published stays published.
GST_START_TEST(a_first_look_at_another_place_leaves_the_tracks_of_before_where_they_are) {
  scene::World world;
  world.speed = 1;
  scene::Line line("motiondetect");
  int first = -1;
  guint before = 0;
  for (int n = 0; n < 90 && (first < 0 || n < first + 24); ++n) {
    GstBuffer* in = scene::grey_buffer(world, n);
    if (first >= 0 && (n - first) % kLook == 1) add_region_of_interest(in, "person", 260, 20, 40, 80, .9);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    if (first < 0 && regions.size() > 0) first = n, before = regions[0].id;
    bool there = false;
    for (guint i = 0; i < regions.size(); ++i) there = there || regions[i].id == before;
    fail_unless(first < 0 || there, "gone at frame %d, first at %d", n, first);
    gst_buffer_unref(out);
  }
  fail_unless(first >= 0);
}
GST_END_TEST

GST_START_TEST(boxes_follow_a_picture_that_is_converted_and_scaled_on_its_way) {
  const scene::World world = walk();
  scene::Line line(
      "videoconvert ! video/x-raw,format=RGB ! videoscale ! video/x-raw,width=240,height=180 ! motiondetect "
      "! "
      "identity");
  int frames = 0;
  for (int n = 0; n < kGone; ++n) {
    GstBuffer* in = frame_of(world, n);
    if (n % kLook == 0)
      add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                             scene::kFigureHeight, .9);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i)
      if (regions[i].person) expect_figure(regions[i], world, n, .75), ++frames;
    gst_buffer_unref(out);
  }
  fail_unless(frames >= kGone - kLook - 1, "%d", frames);
}
GST_END_TEST

GST_START_TEST(each_object_is_one_object_of_a_line) {
  const scene::World world = walk();
  scene::Line line("motiondetect ! motionjson");
  for (int n = 0; n < kGone; ++n) {
    GstBuffer* in = frame_of(world, n);
    add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                           scene::kFigureHeight, .9);
    GstBuffer* out = line.through(in);
    GstMapInfo map;
    fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
    const std::string text(reinterpret_cast<const char*>(map.data), map.size);
    gst_buffer_unmap(out, &map);
    gst_buffer_unref(out);
    const auto first = text.find("\"id\"");
    if (n > kGone - 20)
      fail_unless(first != std::string::npos && text.find("\"id\"", first + 1) == std::string::npos);
  }
}
GST_END_TEST

// What is no person changes nothing, nor do boxes that cannot be any, nor regions of ours.
GST_START_TEST(other_labels_bad_boxes_and_our_own_regions_are_no_witness) {
  constexpr double kHuge = 4e9;
  const std::vector<std::function<void(GstBuffer*, Form)>> kinds = {
      [](GstBuffer* in, Form attach) { attach(in, "car", 200, 100, 60, 40, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "", 200, 100, 60, 40, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "personal bag", 200, 100, 60, 40, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", 200, 100, 0, 40, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", 200, 100, 40, 0, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", 200, 100, -40, -80, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", 2000, 100, 40, 80, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", -200, 100, 40, 80, .9); },
      [](GstBuffer* in, Form) { add_region_of_interest(in, "person", kHuge, kHuge, kHuge, kHuge, .9); },
      [](GstBuffer* in, Form attach) { attach(in, "person", 200, 100, 40, 80, -1); },
      [](GstBuffer* in, Form) {
        GstVideoRegionOfInterestMeta* roi =
            gst_buffer_add_video_region_of_interest_meta(in, "person", 200, 100, 40, 80);
        gst_video_region_of_interest_meta_add_param(
            roi, gst_structure_new("detection", "confidence", G_TYPE_DOUBLE, kNone, nullptr));
      },
      [](GstBuffer* in, Form) {
        GstVideoRegionOfInterestMeta* roi =
            gst_buffer_add_video_region_of_interest_meta(in, "person", 200, 100, 40, 80);
        gst_video_region_of_interest_meta_add_param(
            roi, gst_structure_new("detection", "confidence", G_TYPE_STRING, "0.1", nullptr));
      },
      [](GstBuffer* in, Form) {
        CerberusRegion region;
        cerberus_region_init(&region);
        region.id = 7, region.tracked = region.person = TRUE, region.confidence = .9;
        region.x = 200, region.y = 100, region.width = 40, region.height = 80;
        fail_unless(cerberus_buffer_add_region(in, &region));
      },
  };
  const scene::World world = walk();
  std::string alone[kGone];
  {
    scene::Line line("motiondetect");
    line.run(world, 0, kGone, [&](int n, GstBuffer* out) { alone[n] = Regions(out).text(); });
  }
  for (const Form attach : kForms)
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      scene::Line line("motiondetect");
      for (int n = 0; n < kGone; ++n) {
        GstBuffer* in = scene::grey_buffer(world, n);
        kinds[kind](in, attach);
        GstBuffer* out = line.through(in);
        fail_unless(Regions(out).text() == alone[n], "kind %d, frame %d", static_cast<int>(kind), n);
        gst_buffer_unref(out);
      }
    }
}
GST_END_TEST

// A detector that has gone mad costs no more than one that finds as many objects as there ever are.
GST_START_TEST(of_thousands_of_boxes_on_a_frame_the_first_are_read) {
  const scene::World world = walk();
  for (const int before : {100, 5000}) {
    scene::Line line("motiondetect");
    bool person = false;
    for (int n = 0; n < 24; ++n) {
      GstBuffer* in = scene::grey_buffer(world, n);
      for (int i = 0; i < before; ++i) add_region_of_interest(in, "car", 200, 20, 60, 40, .9);
      add_region_of_interest(in, "person", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                             scene::kFigureHeight, .9);
      GstBuffer* out = line.through(in);
      const Regions regions(out);
      for (guint i = 0; i < regions.size(); ++i) person = person || regions[i].person;
      gst_buffer_unref(out);
    }
    fail_unless(person == (before < 1000));
  }
}
GST_END_TEST

// A box that reaches beyond the picture counts for the part inside.
GST_START_TEST(a_person_who_is_cut_by_the_edge_is_a_person) {
  scene::World world;
  world.start = 30, world.speed = -3;
  scene::Line line("motiondetect");
  bool person = false;
  for (int n = 0; n < 14; ++n) {
    GstBuffer* in = scene::grey_buffer(world, n);
    add_region_of_interest(in, "pedestrian", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                           scene::kFigureHeight, .9);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i) {
      person = person || regions[i].person;
      fail_unless(regions[i].x >= 0 && regions[i].y >= 0);
    }
    gst_buffer_unref(out);
  }
  fail_unless(person);
}
GST_END_TEST

GST_START_TEST(one_message_names_a_label_that_is_none_of_a_person) {
  const struct {
    std::vector<const char*> labels;  // on each frame
    int frames;
    bool told;
  } cases[] = {{{"hat"}, 40, true}, {{"hat"}, 5, false}, {{"hat", "person"}, 40, false}, {{}, 40, false}};
  const scene::World world = walk();
  for (const Form attach : kForms)
    for (const auto& each : cases) {
      scene::Line line("motiondetect");
      for (int n = 0; n < each.frames; ++n) {
        GstBuffer* in = frame_of(world, n);
        for (const char* label : each.labels) attach(in, label, 200, 20, 60, 40, .9);
        gst_buffer_unref(line.through(in));
      }
      const auto told = line.messages(GST_MESSAGE_INFO);
      fail_unless_equals_int(told.size(), each.told);
      if (each.told)
        fail_unless(
            told[0].find("\"hat\"") != std::string::npos && told[0].find("person") != std::string::npos, "%s",
            told[0].c_str());
    }
}
GST_END_TEST

// What sways in one place is published by motion alone, and is nobody where a detector looks on. One box was there, once.
GST_START_TEST(a_stray_box_counts_until_other_caps_a_flush_or_half_a_minute_without_one) {
  scene::World world;
  world.path = [](int n) { return 150 + 6 * std::sin(.5 * n); };
  for (const std::string end : {"nothing", "caps", "flush", "time"}) {
    scene::Line line("motiondetect");
    int n = 0;
    guint found = 0;
    GstClockTime time = 0;
    const auto run = [&](int frames, GstClockTime step, bool figure) {
      for (const int last = n + frames; n < last; ++n, time += step) {
        scene::World now = world;
        now.figure = figure;
        GstBuffer* in = scene::grey_buffer(now, n);
        GST_BUFFER_PTS(in) = time;
        if (n == 2) add_region_of_interest(in, "person", 20, 20, 40, 80, .9);
        GstBuffer* out = line.through(in);
        found = Regions(out).size();
        gst_buffer_unref(out);
      }
    };
    run(50, scene::kStep, true);
    fail_unless_equals_int(found, 0);
    if (end == "caps") line.push_caps(scene::caps("GRAY8", scene::kWidth, scene::kHeight, ",framerate=24/1"));
    if (end == "flush") {
      gst_harness_push_event(line.harness, gst_event_new_flush_start());
      gst_harness_push_event(line.harness, gst_event_new_flush_stop(TRUE));
      push_segment(line.harness);
      time = 0;
    }
    if (end == "time") run(160, GST_SECOND / 5, false);
    run(50, scene::kStep, true);
    fail_unless_equals_int(found, end == "nothing" ? 0 : 1);
  }
}
GST_END_TEST

GST_START_TEST(messages_tell_of_the_persons_too) {
  const scene::World world = walk();
  scene::Line line("motiondetect");
  bool person = false;
  for (int n = 0; n < kGone; ++n) {
    GstBuffer* in = frame_of(world, n);
    if (n % kLook == 0)
      add_region_of_interest(in, "PEOPLE", world.figure_left(n), world.figure_top(), scene::kFigureWidth,
                             scene::kFigureHeight, kNone);
    gst_buffer_unref(line.through(in));
  }
  while (GstMessage* message = gst_bus_pop_filtered(line.bus, GST_MESSAGE_ELEMENT)) {
    g_autoptr(CerberusTrack) track = cerberus_message_parse_track(message);
    person = person || (track && track->region.person);
    gst_message_unref(message);
  }
  fail_unless(person);
}
GST_END_TEST

namespace {

Suite* foreign_boxes_suite() {
  watch_library_log();
  Suite* suite = suite_create("foreign_boxes");
  TCase* tests = tcase_create("all");
  tcase_set_timeout(tests, 60);
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, a_detector_of_2_hz_gives_persons_who_are_followed_between_its_looks_and_end);
  tcase_add_test(tests, a_detector_of_every_frame_ends_a_person_soon);
  tcase_add_test(tests, boxes_on_copies_of_a_frame_are_no_further_looks);
  tcase_add_test(tests, a_first_look_at_a_copy_takes_nothing_away);
  tcase_add_test(tests, who_walks_before_a_detector_of_every_frame_moves);
  tcase_add_test(tests, the_first_look_leaves_the_tracks_of_before_as_they_are);
  tcase_add_test(tests, a_first_look_at_another_place_leaves_the_tracks_of_before_where_they_are);
  tcase_add_test(tests, boxes_follow_a_picture_that_is_converted_and_scaled_on_its_way);
  tcase_add_test(tests, each_object_is_one_object_of_a_line);
  tcase_add_test(tests, other_labels_bad_boxes_and_our_own_regions_are_no_witness);
  tcase_add_test(tests, of_thousands_of_boxes_on_a_frame_the_first_are_read);
  tcase_add_test(tests, a_person_who_is_cut_by_the_edge_is_a_person);
  tcase_add_test(tests, one_message_names_a_label_that_is_none_of_a_person);
  tcase_add_test(tests, a_stray_box_counts_until_other_caps_a_flush_or_half_a_minute_without_one);
  tcase_add_test(tests, messages_tell_of_the_persons_too);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(foreign_boxes)
