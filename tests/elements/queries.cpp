// SPDX-License-Identifier: LGPL-2.1-or-later
// The question "does anybody downstream want planes?" on its way.
#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include <initializer_list>

#include "support.h"

namespace {

constexpr char kCaps[] = "video/x-raw,format=GRAY8,framerate=25/1,width=64,height=48";

// Makes `pad` (a sink pad) answer as an element would that does, or does not, want planes.
void answer(GstPad* pad, bool wanted) {
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
        if (!cerberus_query_is_planes(query)) return GST_PAD_PROBE_OK;
        fail_unless(cerberus_query_set_planes_wanted(query, GPOINTER_TO_INT(data)));
        return GST_PAD_PROBE_HANDLED;
      },
      GINT_TO_POINTER(wanted), nullptr);
}

}  // namespace

START_TEST(nobody_wants_planes_until_somebody_says_so) {
  g_autoptr(GstQuery) query = cerberus_query_new_planes();
  gboolean wanted = TRUE;
  fail_unless(cerberus_query_is_planes(query));
  fail_unless(cerberus_query_parse_planes(query, &wanted));
  fail_if(wanted);
  fail_unless(cerberus_query_set_planes_wanted(query, TRUE));
  fail_unless(cerberus_query_parse_planes(query, &wanted));
  fail_unless(wanted);
  fail_unless(cerberus_query_set_planes_wanted(query, FALSE));
  fail_unless(cerberus_query_parse_planes(query, &wanted));
  fail_if(wanted);
}
END_TEST

START_TEST(the_question_passes_other_elements) {
  for (const char* launch :
       {"identity", "queue", "tee ! queue", "queue ! videoconvert ! videoscale", "capsfilter"}) {
    GstHarness* h = gst_harness_new_parse(launch);
    gst_harness_set_src_caps_str(h, kCaps);
    fail_if(cerberus_pad_peer_wants_planes(h->srcpad), "%s: nobody answered", launch);
    answer(h->sinkpad, true);
    fail_unless(cerberus_pad_peer_wants_planes(h->srcpad), "%s: the answer was lost", launch);
    gst_harness_teardown(h);
  }
}
END_TEST

// The branch that wants them may be any; an element that answers no must not speak for the others.
START_TEST(a_tee_asks_all_branches) {
  for (const int branch : {0, 1, 2}) {
    GstElement* tee = gst_element_factory_make("tee", nullptr);
    GstHarness* branches[3] = {
        gst_harness_new_with_element(tee, "sink", "src_%u"),
        gst_harness_new_with_element(tee, nullptr, "src_%u"),
        gst_harness_new_with_element(tee, nullptr, "src_%u"),
    };
    gst_harness_set_src_caps_str(branches[0], kCaps);
    fail_if(cerberus_pad_peer_wants_planes(branches[0]->srcpad));
    answer(branches[branch]->sinkpad, true);
    fail_unless(cerberus_pad_peer_wants_planes(branches[0]->srcpad), "branch %d was not asked", branch);
    for (GstHarness* h : {branches[2], branches[1], branches[0]}) gst_harness_teardown(h);
    gst_object_unref(tee);
  }
}
END_TEST

START_TEST(an_answer_of_no_is_a_no) {
  GstHarness* h = gst_harness_new_parse("identity");
  answer(h->sinkpad, false);
  fail_if(cerberus_pad_peer_wants_planes(h->srcpad));
  gst_harness_teardown(h);
}
END_TEST

START_TEST(an_unlinked_pad_wants_nothing) {
  g_autoptr(GstPad) pad = gst_pad_new("src", GST_PAD_SRC);
  gst_object_ref_sink(pad);
  fail_if(cerberus_pad_peer_wants_planes(pad));
}
END_TEST

START_TEST(other_queries_are_left_alone) {
  GstQuery* const queries[] = {
      gst_query_new_latency(),
      gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty("something")),
      gst_query_new_custom(GST_QUERY_CUSTOM, nullptr),
  };
  for (GstQuery* query : queries) {
    gboolean wanted = 77;
    fail_if(cerberus_query_is_planes(query));
    fail_if(cerberus_query_set_planes_wanted(query, TRUE));
    fail_if(cerberus_query_parse_planes(query, &wanted));
    fail_unless_equals_int(wanted, 77);
    gst_query_unref(query);
  }
  // The right name without the answer's field.
  g_autoptr(GstQuery) empty =
      gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty(CERBERUS_QUERY_PLANES));
  gboolean wanted = 77;
  fail_if(cerberus_query_parse_planes(empty, &wanted));
  fail_unless_equals_int(wanted, 77);
}
END_TEST

START_TEST(nothing_crashes_on_null) {
  EXPECT_CRITICAL(cerberus_query_is_planes(nullptr));
  EXPECT_CRITICAL(cerberus_query_set_planes_wanted(nullptr, TRUE));
  EXPECT_CRITICAL(cerberus_query_parse_planes(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_pad_peer_wants_planes(nullptr));
}
END_TEST

static Suite* queries_suite(void) {
  watch_library_log();
  Suite* s = suite_create("queries");
  TCase* tc = tcase_create("planes");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, nobody_wants_planes_until_somebody_says_so);
  tcase_add_test(tc, the_question_passes_other_elements);
  tcase_add_test(tc, a_tee_asks_all_branches);
  tcase_add_test(tc, an_answer_of_no_is_a_no);
  tcase_add_test(tc, an_unlinked_pad_wants_nothing);
  tcase_add_test(tc, other_queries_are_left_alone);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(queries)
