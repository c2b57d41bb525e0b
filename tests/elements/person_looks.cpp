// SPDX-License-Identifier: LGPL-2.1-or-later
// personverify in front of a tracker: both witnesses, as behind it. A drawn person walks before a textured wall.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene.h"
#include "support/bodies.h"

namespace {

using scene::Regions;

constexpr int kPersonTop = 90, kPersonHeight = 100, kPersonWidth = 40;

// A camera that turns by `pan` pixels a frame, and a person who walks from `start` to the right, where `until` has not come.
struct Walk {
  double pan = 0, start = 60, speed = 1.5;
  int until = 1000;

  double left(int frame) const { return start + (speed - pan) * frame; }
  GstBuffer* frame(int number) const {
    std::vector<std::uint8_t> picture;
    picture.reserve(static_cast<std::size_t>(scene::kWidth) * scene::kHeight);
    for (int y = 0; y < scene::kHeight; ++y)
      for (int x = 0; x < scene::kWidth; ++x)
        picture.push_back(static_cast<std::uint8_t>(150 + .15 * scene::texture(x + pan * number, y, 9, 1)));
    if (number < until)
      cerberus::tests::draw_person({picture.data(), scene::kWidth, scene::kHeight, scene::kWidth},
                                   left(number), kPersonTop, kPersonHeight, 60);
    return scene::buffer("GRAY8", scene::kWidth, scene::kHeight, picture, number * scene::kStep);
  }
};

// Not live: results come at the same frames in every run.
struct Line : scene::Line {
  explicit Line(const std::string& launch) : scene::Line(launch) { gst_harness_set_live(harness, FALSE); }
};

// Everything that comes out of a line for so many frames, as text.
std::string text_of(const std::string& launch, const Walk& walk, int frames) {
  Line line(launch);
  std::string all;
  for (int n = 0; n < frames; ++n) {
    GstBuffer* out = line.through(walk.frame(n));
    GstMapInfo map;
    fail_unless(gst_buffer_map(out, &map, GST_MAP_READ));
    all.append(reinterpret_cast<const char*>(map.data), map.size);
    gst_buffer_unmap(out, &map);
    gst_buffer_unref(out);
  }
  return all;
}

// The regions are one person, where it is drawn (scaled by `scale`).
void expect_person(const Regions& regions, double left, double scale = 1) {
  fail_unless_equals_int(regions.size(), 1);
  const CerberusRegion& r = regions[0];
  fail_unless(r.person);
  const double middle = (r.x + r.width / 2) / scale, height = r.height / scale;
  fail_unless(std::abs(middle - (left + kPersonWidth / 2)) < 12, "middle %.0f, not %.0f", middle,
              left + kPersonWidth / 2);
  fail_unless(height > 70 && height < 130, "%.0f high", height);
}

constexpr Walk kStill{}, kTurning{.pan = -2, .start = 40, .speed = 0};
constexpr int kFrames = 50;

}  // namespace

GST_START_TEST(in_front_and_behind_give_the_same_lines) {
  const struct {
    Walk walk;
    std::string verify;
  } cases[] = {{kStill, "personverify"}, {kTurning, "personverify require=person rate=8 phase=0.5"}};
  for (const auto& [walk, verify] : cases) {
    const std::string behind = text_of("motiondetect ! " + verify + " ! motionjson", walk, kFrames);
    fail_unless(behind.find("\"type\":\"person\"") != std::string::npos);
    const std::string front = text_of(verify + " ! motiondetect ! motionjson", walk, kFrames);
    fail_unless(front == behind, "%s", verify.c_str());
  }
}
GST_END_TEST

// While the camera turns, a person is first published by looks.
GST_START_TEST(identities_count_from_1_in_both_orders) {
  for (const char* order : {"personverify ! motiondetect", "motiondetect ! personverify"})
    for (const Walk& walk : {kStill, kTurning, Walk{.pan = 3, .start = 120, .speed = 2}}) {
      const std::string lines = text_of(std::string(order) + " ! motionjson", walk, kFrames);
      guint highest = 0;
      for (std::size_t at = lines.find("\"id\":"); at != std::string::npos;
           at = lines.find("\"id\":", at + 1)) {
        const auto id = static_cast<guint>(std::stoul(lines.substr(at + 5)));
        fail_unless(id >= 1 && id <= highest + 1, "%s: %u after %u", order, id, highest);
        highest = std::max(highest, id);
      }
      fail_unless(highest >= 1 && highest <= 2, "%s: %u", order, highest);
    }
}
GST_END_TEST

GST_START_TEST(in_front_of_the_stages_it_is_as_in_front_of_motiondetect) {
  const std::string one = text_of("personverify ! motiondetect ! motionjson", kTurning, kFrames);
  for (const char* stages :
       {"personverify ! cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack",
        "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! personverify ! motiontrack"}) {
    const std::string chain = text_of(std::string(stages) + " ! motionjson", kTurning, kFrames);
    fail_unless(chain == one, "%s", stages);
  }
}
GST_END_TEST

GST_START_TEST(what_it_has_seen_follows_a_picture_that_is_converted_and_scaled) {
  Line line(
      "personverify ! videoconvert ! video/x-raw,format=RGB ! videoscale ! video/x-raw,width=240,height=180 "
      "! "
      "motiondetect ! identity");
  for (int n = 0; n < kFrames; ++n) {
    GstBuffer* out = line.through(kTurning.frame(n));
    if (n > kFrames - 10) expect_person(Regions(out), kTurning.left(n), .75);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(one_warning_says_that_what_it_has_seen_is_lost_by_cropping) {
  const struct {
    const char* launch;
    bool lost;
  } cases[] = {{"personverify require=person ! videocrop left=20 ! motiondetect ! identity", true},
               {"personverify require=person ! queue ! videocrop left=20 ! motiondetect ! identity", true},
               {"videocrop left=20 ! personverify require=person ! motiondetect ! identity", false},
               {"personverify require=person ! videoscale ! video/x-raw,width=160,height=120 ! motiondetect "
                "! identity",
                false},
               {"motiondetect ! videocrop left=20 ! personverify ! identity", false}};
  for (const auto& each : cases) {
    Line line(each.launch);
    for (int n = 0; n < 120; ++n) {
      fail_unless_equals_int(gst_harness_push(line.harness, kTurning.frame(n)), GST_FLOW_OK);
      gst_buffer_unref(gst_harness_pull(line.harness));
    }
    const auto told = line.messages(GST_MESSAGE_WARNING);
    fail_unless_equals_int(told.size(), each.lost);
    if (each.lost) fail_unless(told[0].find("crop") != std::string::npos, "%s", told[0].c_str());
  }
}
GST_END_TEST

// A person whom looks alone show comes out of what is left out, as somebody does whom motion shows.
GST_START_TEST(zones_hold_for_persons_whom_only_the_detector_shows) {
  constexpr double kEdge = .45;  // of the width
  const std::string left_out = "zones=\"exclude 0,0 0.45,0 0.45,1 0,1\"",
                    stages =
                        "cameramotion ! threeframediff ! fuzzythreshold ! motionregions " + left_out + " ! ";
  for (const std::string& launch :
       {"personverify ! motiondetect " + left_out + " ! identity",
        "motiondetect " + left_out + " ! personverify ! identity", "personverify ! " + stages + "motiontrack",
        stages + "motiontrack ! personverify",
        "motiondetect " + left_out +
            " ! videoconvert ! video/x-raw,format=RGB ! videoscale ! "
            "video/x-raw,width=320,height=240 ! personverify ! identity"}) {
    Line line(launch);
    for (int n = 0; n < 65; ++n) {
      GstBuffer* out = line.through(kTurning.frame(n));
      const double middle = kTurning.left(n) + kPersonWidth / 2;
      if (middle > kEdge * scene::kWidth + 12)
        expect_person(Regions(out), kTurning.left(n));
      else if (middle < kEdge * scene::kWidth - 12)
        fail_unless_equals_int(Regions(out).size(), 0);
      gst_buffer_unref(out);
    }
  }
}
GST_END_TEST

GST_START_TEST(zones_that_are_set_while_it_plays_hold_for_persons_from_the_next_frame_on) {
  for (const char* launch : {"personverify ! motiondetect name=detect ! identity",
                             "motiondetect name=detect ! personverify ! identity"}) {
    Line line(launch);
    g_autoptr(GstElement) detect = gst_bin_get_by_name(GST_BIN(line.harness->element), "detect");
    for (int n = 0; n < 60; ++n) {
      if (n == 40) g_object_set(detect, "zones", "exclude 0,0 1,0 1,1 0,1", nullptr);
      if (n == 50) g_object_set(detect, "zones", "", nullptr);
      GstBuffer* out = line.through(kTurning.frame(n));
      if (n >= 30) fail_unless_equals_int(Regions(out).size(), n >= 40 && n < 50 ? 0 : 1);
      gst_buffer_unref(out);
    }
  }
}
GST_END_TEST

// Of three frames two are dropped between the two, among them such at which a look has begun or ended.
GST_START_TEST(dropped_frames_between_the_two_show_nobody_where_nobody_is) {
  Line line("personverify rate=5 ! identity name=between ! motiondetect ! identity");
  g_autoptr(GstElement) between = gst_bin_get_by_name(GST_BIN(line.harness->element), "between");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(between, "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer) {
        const auto number = GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info)) / scene::kStep;
        return number % 3 == 0 ? GST_PAD_PROBE_OK : GST_PAD_PROBE_DROP;
      },
      nullptr, nullptr);
  int seen = 0;
  const Walk fast{.pan = -4, .start = 20, .speed = 0};
  for (int n = 0; n < 65; ++n) {
    fail_unless_equals_int(gst_harness_push(line.harness, fast.frame(n)), GST_FLOW_OK);
    GstBuffer* out = gst_harness_try_pull(line.harness);
    fail_unless((out != nullptr) == (n % 3 == 0));
    if (!out) continue;
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i)
      if (regions[i].person) {
        expect_person(regions, fast.left(n));
        ++seen;
      }
    gst_buffer_unref(out);
  }
  fail_unless(seen >= 5, "%d", seen);
}
GST_END_TEST

// As videorate makes twice as many frames.
GST_START_TEST(repeated_frames_change_no_identity) {
  Line line("personverify ! motiondetect ! identity");
  std::set<guint> identities;
  for (int n = 0; n < 2 * kFrames; ++n) {
    GstBuffer* in = kTurning.frame(n / 2);
    GST_BUFFER_PTS(in) = static_cast<GstClockTime>(n) * scene::kStep / 2;
    if (n % 2 != 0) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
    GstBuffer* out = line.through(in);
    fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_GAP) == (n % 2 != 0));
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i)
      if (regions[i].person) identities.insert(regions[i].id);
    if (n > 2 * kFrames - 20) expect_person(regions, kTurning.left(n / 2));
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(identities.size(), 1);
}
GST_END_TEST

GST_START_TEST(a_tracker_that_is_linked_later_takes_over) {
  Line line("personverify ! identity");
  for (int n = 0; n < 20; ++n) gst_buffer_unref(line.through(kStill.frame(n)));
  GstElement* track = gst_element_factory_make("motiondetect", nullptr);
  g_autoptr(GstElement) last = nullptr;
  GstIterator* elements = gst_bin_iterate_sorted(GST_BIN(line.harness->element));
  GValue value = G_VALUE_INIT;
  fail_unless_equals_int(gst_iterator_next(elements, &value), GST_ITERATOR_OK);
  last = GST_ELEMENT(g_value_dup_object(&value));
  g_value_unset(&value);
  gst_iterator_free(elements);
  g_autoptr(GstPad) source = gst_element_get_static_pad(last, "src");
  g_autoptr(GstPad) ghost = gst_element_get_static_pad(line.harness->element, "src");
  gst_bin_add(GST_BIN(line.harness->element), track);
  gst_element_sync_state_with_parent(track);
  g_autoptr(GstPad) in = gst_element_get_static_pad(track, "sink");
  g_autoptr(GstPad) out = gst_element_get_static_pad(track, "src");
  gst_ghost_pad_set_target(GST_GHOST_PAD(ghost), out);
  fail_unless_equals_int(gst_pad_link(source, in), GST_PAD_LINK_OK);
  for (int n = 20; n < 20 + kFrames; ++n) {
    GstBuffer* buffer = line.through(kStill.frame(n));
    if (n > kFrames - 5) expect_person(Regions(buffer), kStill.left(n));
    gst_buffer_unref(buffer);
  }
}
GST_END_TEST

namespace {

Suite* person_looks_suite() {
  watch_library_log();
  Suite* suite = suite_create("person_looks");
  TCase* tests = tcase_create("all");
  tcase_set_timeout(tests, 120);
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, in_front_and_behind_give_the_same_lines);
  tcase_add_test(tests, identities_count_from_1_in_both_orders);
  tcase_add_test(tests, in_front_of_the_stages_it_is_as_in_front_of_motiondetect);
  tcase_add_test(tests, what_it_has_seen_follows_a_picture_that_is_converted_and_scaled);
  tcase_add_test(tests, one_warning_says_that_what_it_has_seen_is_lost_by_cropping);
  tcase_add_test(tests, zones_hold_for_persons_whom_only_the_detector_shows);
  tcase_add_test(tests, zones_that_are_set_while_it_plays_hold_for_persons_from_the_next_frame_on);
  tcase_add_test(tests, dropped_frames_between_the_two_show_nobody_where_nobody_is);
  tcase_add_test(tests, repeated_frames_change_no_identity);
  tcase_add_test(tests, a_tracker_that_is_linked_later_takes_over);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(person_looks)
