// SPDX-License-Identifier: LGPL-2.1-or-later
// The query "does any element downstream want the record kept?" on its way.
#include <utility>

#include "records.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include "support.h"

#include "../../plugins/shared/person_looks.hpp"

namespace {

using cerberus::plugin::ask_for_record;
using records::kRecordForReaders, records::kRecordForTracks, records::want_record;

constexpr char kCaps[] = "video/x-raw,format=GRAY8,framerate=25/1,width=64,height=48";

}  // namespace

START_TEST(the_query_passes_other_elements) {
  for (const char* launch :
       {"identity", "queue", "tee ! queue", "queue ! videoconvert ! videoscale", "capsfilter"}) {
    GstHarness* h = gst_harness_new_parse(launch);
    gst_harness_set_src_caps_str(h, kCaps);
    fail_unless_equals_int(ask_for_record(h->srcpad), 0);
    want_record(h->sinkpad);
    fail_unless(ask_for_record(h->srcpad) == kRecordForReaders, "%s: the answer was lost", launch);
    gst_harness_teardown(h);
  }
}
END_TEST

START_TEST(all_branches_of_a_tee_are_asked_and_each_adds_what_it_wants) {
  GstHarness* h = gst_harness_new_parse(
      "tee name=t ! motiontrack ! fakesink async=false t. ! motionview ! fakesink async=false t. ! identity");
  gst_harness_set_src_caps_str(h, kCaps);
  fail_unless_equals_int(ask_for_record(h->srcpad), kRecordForTracks | kRecordForReaders);
  gst_harness_teardown(h);
}
END_TEST

START_TEST(every_element_says_what_it_wants) {
  const std::pair<const char*, guint> cases[] = {
      {"cameramotion ! motionview", 0},
      {"threeframediff ! identity", 0},
      {"fuzzythreshold ! identity", 0},
      {"fuzzythreshold area=leading ! identity", kRecordForReaders},
      {"motionregions ! motionview", kRecordForReaders},
      {"motionregions keep-planes=never ! motionview", 0},
      {"motionregions keep-planes=always ! identity", kRecordForReaders},
      {"motionregions ! motiontrack", kRecordForTracks},
      {"motiontrack ! motionview", kRecordForTracks | kRecordForReaders},
      {"motiondetect ! motionview", 0},
  };
  for (const auto& [launch, wanted] : cases) {
    GstHarness* h = gst_harness_new_parse(launch);
    gst_harness_set_src_caps_str(h, kCaps);
    fail_unless(ask_for_record(h->srcpad) == wanted, "%s: %u", launch, ask_for_record(h->srcpad));
    gst_harness_teardown(h);
  }
}
END_TEST

START_TEST(a_tracker_anywhere_behind_takes_looks) {
  const std::pair<const char*, bool> cases[] = {
      {"motiondetect ! identity", true},
      {"queue ! videoconvert ! motiondetect ! identity", true},
      {"cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack ! identity", true},
      {"tee name=t ! fakesink async=false t. ! queue ! motiontrack ! fakesink async=false t. ! identity",
       true},
      {"cameramotion ! motionregions ! identity", false},
      {"identity", false},
  };
  for (const auto& [launch, taken] : cases) {
    GstHarness* h = gst_harness_new_parse(launch);
    gst_harness_set_src_caps_str(h, kCaps);
    fail_unless(cerberus::plugin::tracker_takes_looks(h->srcpad) == taken, "%s", launch);
    gst_harness_teardown(h);
  }
}
END_TEST

START_TEST(an_unlinked_pad_wants_nothing) {
  g_autoptr(GstPad) pad = gst_pad_new("src", GST_PAD_SRC);
  gst_object_ref_sink(pad);
  fail_unless_equals_int(ask_for_record(pad), 0);
}
END_TEST

START_TEST(other_queries_are_not_it) {
  GstQuery* const queries[] = {
      gst_query_new_latency(),
      gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty("something")),
      gst_query_new_custom(GST_QUERY_CUSTOM, nullptr),
  };
  for (GstQuery* query : queries) {
    fail_if(cerberus::plugin::is_record_query(query));
    gst_query_unref(query);
  }
}
END_TEST

static Suite* queries_suite(void) {
  watch_library_log();
  Suite* s = suite_create("queries");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_query_passes_other_elements);
  tcase_add_test(tc, all_branches_of_a_tee_are_asked_and_each_adds_what_it_wants);
  tcase_add_test(tc, every_element_says_what_it_wants);
  tcase_add_test(tc, a_tracker_anywhere_behind_takes_looks);
  tcase_add_test(tc, an_unlinked_pad_wants_nothing);
  tcase_add_test(tc, other_queries_are_not_it);
  return s;
}

GST_CHECK_MAIN(queries);
