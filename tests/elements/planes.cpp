// SPDX-License-Identifier: LGPL-2.1-or-later
// Planes: kept where an element requests them, and writing to one copy changes no other.
#include <cmath>
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

namespace {

using scene::entering;
using scene::Line;
using scene::moving_pixels;
using scene::World;

bool has_record(GstBuffer* buffer) {
  return static_cast<bool>(records::record_of(buffer));
}

GST_START_TEST(planes_are_kept_only_where_an_element_requests_them) {
  struct Case {
    const char* launch;
    bool asked;
    bool kept;
  };
  const Case cases[] = {
      {"motiondetect ! queue ! identity", false, false},
      {"motiondetect ! queue ! identity", true, true},
      {"motiondetect keep-planes=never ! identity", true, false},
      {"motiondetect keep-planes=always ! identity", false, true},
      {"motiontrack ! identity", false, false},
      {"motiontrack ! identity", true, true},
  };
  const Case& c = cases[__i__];
  GstHarness* harness = gst_harness_new_parse(c.launch);
  if (c.asked) records::want_record(harness->sinkpad);
  gst_harness_set_src_caps_str(harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  for (int k = 0; k < 10; ++k) {
    gst_harness_push(harness, scene::grey_buffer(World{}, k));
    GstBuffer* out = gst_harness_pull(harness);
    fail_unless(has_record(out) == c.kept, "%s, %s", c.launch, c.asked ? "asked" : "not asked");
    gst_buffer_unref(out);
  }
  gst_harness_teardown(harness);
}
GST_END_TEST

// An element is linked later and sends a reconfigure event.
GST_START_TEST(planes_stay_after_a_reconfigure_event_when_they_are_wanted_then) {
  Line line("motiondetect ! identity");
  line.run(World{}, 0, 5, [](int, GstBuffer* out) { fail_if(has_record(out)); });
  records::want_record(line.harness->sinkpad);
  gst_harness_push_upstream_event(line.harness, gst_event_new_reconfigure());
  line.run(World{}, 5, 8, [](int k, GstBuffer* out) {
    if (k > 5) fail_unless(has_record(out));
    fail_unless(k < 5 || records::threshold_facts_of(out)->result.ready, "the scene ended with a question");
  });
}
GST_END_TEST

// The mask is cleaned in place, except where another branch of a tee still looks at the uncleaned one.
GST_START_TEST(another_branch_keeps_its_uncleaned_mask) {
  Line threshold("fuzzythreshold"),
      regions("motionregions keep-planes=always zones=\"exclude 0,0.5 1,0.5 1,1 0,1\" ! identity");
  const World world = entering();
  long changed = 0;
  for (int k = 0; k < 40; ++k) {
    GstBuffer* out = threshold.through(scene::grey_buffer(world, k));
    GstBuffer* other = gst_buffer_copy(out);  // shares the planes
    const long before = moving_pixels(other);
    GstBuffer* cleaned = regions.through(out);
    changed += moving_pixels(cleaned) != before;
    fail_unless_equals_int(moving_pixels(other), before);
    gst_buffer_unref(other);
    gst_buffer_unref(cleaned);
  }
  fail_unless(changed > 0, "cleaning never changed anything: this test proves nothing");
}
GST_END_TEST

GST_START_TEST(regions_are_found_again_on_a_record_that_has_them) {
  Line line("motiondetect keep-planes=always ! motionregions keep-planes=always ! motiontrack ! identity");
  const World world = entering();
  for (int k = 0; k < 30; ++k) {
    GstBuffer* out = line.through(scene::grey_buffer(world, k));
    fail_unless(cerberus_buffer_regions_known(out));
    fail_unless(moving_pixels(out) >= 0);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// One person in black and one in white meet before the wall, stand together and return to where they came from.
class Meeting {
 public:
  static constexpr int kFrames = 115;
  static double left_of(int person, int frame) {
    return 146 + (person == 0 ? -2 : 2) * std::max(std::abs(frame - 60.0) - 6, 0.0);
  }
  static GstBuffer* frame(int k) {
    World world;
    world.figure = false;
    std::vector<std::uint8_t> picture = world.picture(k);
    for (int person = 1; person >= 0; --person)
      for (int y = 80; y < 80 + scene::kFigureHeight; ++y)
        for (int x = 0; x < scene::kFigureWidth; ++x) {
          const int at = static_cast<int>(left_of(person, k)) + x;
          if (at >= 0 && at < scene::kWidth)
            picture[static_cast<std::size_t>(y) * scene::kWidth + at] = static_cast<std::uint8_t>(
                (person == 0 ? 8 : 225) + 0.08 * scene::texture(x, y, 5, 7 + person));
        }
    return scene::buffer("GRAY8", scene::kWidth, scene::kHeight, picture, k * scene::kStep);
  }
};

// The tracker's appearance model needs the planes of the stages; by their positions these two seem to pass each other.
GST_START_TEST(identities_are_distinguished_by_the_planes) {
  const bool taken_away = __i__ > 0;
  int taken = 0;  // frames with planes
  Line line("motionregions ! identity name=between ! motiontrack");
  g_autoptr(GstElement) between = gst_bin_get_by_name(GST_BIN(line.harness->element), "between");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(between, "src");
  if (taken_away)
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer taken) {
          GstBuffer* buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
          *static_cast<int*>(taken) += has_record(buffer);
          records::set_record(buffer, {});
          GST_PAD_PROBE_INFO_DATA(info) = buffer;
          return GST_PAD_PROBE_OK;
        },
        &taken, nullptr);
  guint before[2] = {};
  for (int k = 0; k < Meeting::kFrames; ++k) {
    GstBuffer* out = line.through(Meeting::frame(k));
    fail_if(has_record(out));
    const scene::Regions found(out);
    int kept = 0;
    for (int person = 0; person < 2 && (k == 40 || k == Meeting::kFrames - 1); ++person) {
      guint id = 0;
      for (guint i = 0; i < found.size(); ++i)
        if (std::abs(found[i].x - Meeting::left_of(person, k)) < 10) id = found[i].id;
      fail_unless(id > 0, "frame %d: there is no track at person %d", k, person);
      if (k == 40)
        before[person] = id;
      else
        kept += id == before[person];
    }
    if (k == Meeting::kFrames - 1)
      fail_unless((kept == 2) != taken_away, "%d of two have kept their identity", kept);
    gst_buffer_unref(out);
  }
  fail_unless(!taken_away || taken > 100, "%d frames had planes", taken);
}
GST_END_TEST

// In `made`: on how many frames the element `d` puts D(k-1).
void count_previous(Line& line, int& made) {
  g_autoptr(GstElement) differences = gst_bin_get_by_name(GST_BIN(line.harness->element), "d");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(differences, "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer count) {
        *static_cast<int*>(count) += records::has_previous(GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      &made, nullptr);
}

// D(k-1) is used by area=leading and area=common, and by elements that show planes.
GST_START_TEST(the_previous_difference_is_computed_where_an_element_reads_it) {
  struct Case {
    const char* launch;
    bool asked, made;
  };
  const Case cases[] = {
      {"threeframediff name=d ! identity", false, false},
      {"threeframediff name=d ! fuzzythreshold ! identity", false, false},
      {"threeframediff name=d ! queue ! fuzzythreshold memory=false ! identity", false, false},
      {"threeframediff name=d ! fuzzythreshold ! identity", true, true},
      {"threeframediff name=d ! fuzzythreshold area=leading ! identity", false, true},
      {"threeframediff name=d ! fuzzythreshold area=common ! motiontrack", false, true},
      {"threeframediff name=d ! fuzzythreshold ! motionregions ! motiontrack", false, false},
      {"threeframediff name=d ! fuzzythreshold ! motionregions keep-planes=always ! identity", false, true},
      {"threeframediff name=d ! tee ! fuzzythreshold area=leading ! identity", false, true},
      // An element that never keeps planes makes requests behind it futile, but not in another branch.
      {"threeframediff name=d ! fuzzythreshold ! motionregions keep-planes=never ! identity", true, false},
      {"threeframediff name=d ! fuzzythreshold ! tee name=t ! motionregions keep-planes=never ! "
       "fakesink async=false t. ! identity",
       true, true},
  };
  const Case& c = cases[__i__];
  Line line(c.launch);
  if (c.asked) records::want_record(line.harness->sinkpad);
  int made = 0;
  count_previous(line, made);
  for (int k = 0; k < 10; ++k) gst_harness_push(line.harness, scene::grey_buffer(World{}, k));
  for (int k = 0; k < 10; ++k) gst_buffer_unref(gst_harness_pull(line.harness));
  fail_unless_equals_int(made, c.made ? 10 : 0);
}
GST_END_TEST

GST_START_TEST(a_request_behind_keep_planes_never_takes_effect_when_that_changes) {
  Line line("threeframediff name=d ! fuzzythreshold ! motionregions name=r ! identity");
  records::want_record(line.harness->sinkpad);
  g_autoptr(GstElement) regions = gst_bin_get_by_name(GST_BIN(line.harness->element), "r");
  int made = 0, k = 0;
  count_previous(line, made);
  for (const char* keep : {"auto", "never", "auto"}) {
    gst_util_set_object_arg(G_OBJECT(regions), "keep-planes", keep);
    line.run(World{}, k, k + 1);  // the request reaches upstream with the next frame
    made = 0;
    line.run(World{}, k + 1, k + 6);
    fail_unless_equals_int(made, std::string(keep) == "never" ? 0 : 5);
    k += 6;
  }
}
GST_END_TEST

GST_START_TEST(planes_come_and_go_with_the_property_while_frames_flow) {
  Line line("threeframediff ! fuzzythreshold ! motionregions name=r ! identity");
  g_autoptr(GstElement) regions = gst_bin_get_by_name(GST_BIN(line.harness->element), "r");
  int k = 0;
  for (const char* keep : {"auto", "always", "never", "always"}) {
    gst_util_set_object_arg(G_OBJECT(regions), "keep-planes", keep);
    const bool kept = std::string(keep) == "always";
    line.run(World{}, k, k + 6, [&](int frame, GstBuffer* out) {
      fail_unless_equals_int(has_record(out), kept);
      // The request reaches upstream with the next frame.
      const bool previous = records::has_previous(out);
      if (frame > k) fail_unless_equals_int(previous, kept);
      fail_unless_equals_int(records::threshold_facts_of(out)->result.ready, frame >= 2);
    });
    k += 6;
  }
}
GST_END_TEST

Suite* planes_suite() {
  Suite* suite = suite_create("planes");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, planes_are_kept_only_where_an_element_requests_them, 0, 6);
  tcase_add_test(tests, planes_stay_after_a_reconfigure_event_when_they_are_wanted_then);
  tcase_add_loop_test(tests, identities_are_distinguished_by_the_planes, 0, 2);
  tcase_add_loop_test(tests, the_previous_difference_is_computed_where_an_element_reads_it, 0, 11);
  tcase_add_test(tests, a_request_behind_keep_planes_never_takes_effect_when_that_changes);
  tcase_add_test(tests, planes_come_and_go_with_the_property_while_frames_flow);
  tcase_add_test(tests, another_branch_keeps_its_uncleaned_mask);
  tcase_add_test(tests, regions_are_found_again_on_a_record_that_has_them);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(planes);
