// SPDX-License-Identifier: LGPL-2.1-or-later
// Planes: who wants them gets them, and nobody sees another one's changes.
#include "scene.h"
#include "support.h"

namespace {

using scene::entering;
using scene::Line;
using scene::moving_pixels;
using scene::World;

int planes_of(GstBuffer* buffer) {
  int count = 0;
  for (int kind = CERBERUS_PLANE_LUMA; kind <= CERBERUS_PLANE_LABELS; ++kind)
    count += cerberus_buffer_get_plane_meta(buffer, static_cast<CerberusPlaneKind>(kind)) != nullptr;
  return count;
}

GstPadProbeReturn want_planes(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
  if (!cerberus_query_is_planes(query)) return GST_PAD_PROBE_OK;
  cerberus_query_set_planes_wanted(query, TRUE);
  return GST_PAD_PROBE_HANDLED;
}

GST_START_TEST(planes_stay_only_where_somebody_asks_for_them) {
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
  if (c.asked)
    gst_pad_add_probe(harness->sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, want_planes, nullptr, nullptr);
  gst_harness_set_src_caps_str(harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
  for (int k = 0; k < 10; ++k) {
    gst_harness_push(harness, scene::grey_buffer(World{}, k));
    GstBuffer* out = gst_harness_pull(harness);
    fail_unless((planes_of(out) > 0) == c.kept, "%s, %s: %d planes", c.launch,
                c.asked ? "asked" : "not asked", planes_of(out));
    gst_buffer_unref(out);
  }
  gst_harness_teardown(harness);
}
GST_END_TEST

// Somebody is linked later and asks upstream to reconfigure.
GST_START_TEST(planes_stay_after_a_reconfigure_event_when_they_are_wanted_then) {
  Line line("motiondetect ! identity");
  line.run(World{}, 0, 5, [](int, GstBuffer* out) { fail_unless_equals_int(planes_of(out), 0); });
  gst_pad_add_probe(line.harness->sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, want_planes, nullptr,
                    nullptr);
  gst_harness_push_upstream_event(line.harness, gst_event_new_reconfigure());
  line.run(World{}, 5, 8, [](int k, GstBuffer* out) {
    if (k > 5) fail_unless(planes_of(out) > 0);
    fail_unless(k < 5 || cerberus_buffer_get_threshold_meta(out)->threshold.ready,
                "the scene ended with a question");
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

Suite* planes_suite() {
  Suite* suite = suite_create("planes");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 300);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, planes_stay_only_where_somebody_asks_for_them, 0, 6);
  tcase_add_test(tests, planes_stay_after_a_reconfigure_event_when_they_are_wanted_then);
  tcase_add_test(tests, another_branch_keeps_its_uncleaned_mask);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(planes);
