// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions on buffers. (In structures and messages: motion_messages.cpp.)
// C++ first: check's macros (fail) bite standard headers.
#include "records.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include <cmath>

#include "annotated.h"
#include "cerberus/private/compat.hpp"
#include "support.h"

#if CERBERUS_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

namespace {

using annotated::assert_same, annotated::at, annotated::walker;

GstVideoRegionOfInterestMeta* roi(GstBuffer* frame) {
  return reinterpret_cast<GstVideoRegionOfInterestMeta*>(
      gst_buffer_get_meta(frame, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE));
}

guint count_rois(GstBuffer* frame) {
  return gst_buffer_get_n_meta(frame, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE);
}

GstBuffer* through(const char* launch, const char* out_caps, const CerberusRegion& region) {
  GstHarness* h = gst_harness_new_parse(launch);
  gst_harness_set_src_caps_str(h, annotated::kI420);
  gst_harness_set_sink_caps_str(h, out_caps);
  GstBuffer* frame = annotated::plain_frame();
  fail_unless(cerberus_buffer_add_region(frame, &region));
  fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(h);
  gst_harness_teardown(h);
  return out;
}

}  // namespace

START_TEST(a_region_reads_back_as_it_was_added) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  const CerberusRegion region = walker();
  fail_unless(cerberus_buffer_add_region(frame, &region));
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(frame);
  fail_unless_equals_int(regions->len, 1);
  assert_same(at(regions, 0), region);
}
END_TEST

START_TEST(regions_keep_their_order) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusRegion region = walker();
  for (guint id = 9; id > 0; --id) {
    region.id = id;
    cerberus_buffer_add_region(frame, &region);
  }
  g_autoptr(GstBuffer) copy = gst_buffer_copy(frame);
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(copy);
  fail_unless_equals_int(regions->len, 9);
  for (guint i = 0; i < 9; ++i) fail_unless_equals_int(at(regions, i).id, 9 - i);
}
END_TEST

// Others read GStreamer's meta: whole pixels (edges 8.25 and 23.75 are nearest to 8 and 24) and the known params.
START_TEST(other_tools_find_a_region_of_interest) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusRegion region = walker();
  cerberus_buffer_add_region(frame, &region);
  GstVideoRegionOfInterestMeta* meta = roi(frame);
  fail_unless_equals_string(g_quark_to_string(meta->roi_type), "motion");
  fail_unless_equals_int(meta->id, 5);
  fail_unless_equals_int(meta->x, 8);
  fail_unless_equals_int(meta->y, 16);
  fail_unless_equals_int(meta->w, 16);
  fail_unless_equals_int(meta->h, 24);
  double confidence = 0;
  int id = 0;
  gst_structure_get_double(gst_video_region_of_interest_meta_get_param(meta, "detection"), "confidence",
                           &confidence);
  gst_structure_get_int(gst_video_region_of_interest_meta_get_param(meta, "object_id"), "id", &id);
  fail_unless_equals_float(confidence, 0.9);
  fail_unless_equals_int(id, 5);
  const GstStructure* ours = gst_video_region_of_interest_meta_get_param(meta, "cerberus-object");
  fail_unless_equals_string(gst_structure_get_string(ours, "state"), "coasted");

  g_autoptr(GstBuffer) second_frame = gst_buffer_new();
  region.person = TRUE;
  region.tracked = FALSE;
  cerberus_buffer_add_region(second_frame, &region);
  fail_unless_equals_string(g_quark_to_string(roi(second_frame)->roi_type), "person");
  fail_if(gst_video_region_of_interest_meta_get_param(roi(second_frame), "object_id"));
}
END_TEST

// 64x48 to 160x12: 2.5 times as wide, a quarter as high; GStreamer's own meta loses its params there (1.22).
START_TEST(scaling_scales_regions_and_keeps_what_others_read) {
  g_autoptr(GstBuffer) out =
      through("videoscale", "video/x-raw,format=I420,framerate=25/1,width=160,height=12", walker());
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 1);
  CerberusRegion expected = walker();
  expected.x = 20.625;
  expected.y = 4;
  expected.width = 38.75;
  expected.height = 6;
  expected.vx = 25;
  expected.vy = -1.25;
  assert_same(at(regions, 0), expected);
  fail_unless_equals_int(count_rois(out), 1);
  fail_unless_equals_int(roi(out)->x, 21);  // 20.625
  fail_unless_equals_int(roi(out)->w, 38);  // to 59.375
  fail_unless(gst_video_region_of_interest_meta_get_param(roi(out), "detection"));
  fail_unless(gst_video_region_of_interest_meta_get_param(roi(out), "object_id"));
  double vx = 0;
  gst_structure_get_double(gst_video_region_of_interest_meta_get_param(roi(out), "cerberus-object"), "vx",
                           &vx);
  fail_unless_equals_float(vx, 25);
}
END_TEST

// Up and down again, several times: nothing drifts, and metas that other elements read stay as they are. Two regions
// with one number and one of another element beside them are not mixed up.
START_TEST(scaling_often_loses_nothing) {
  for (const char* width : {"384", "65", "61", "512"}) {
    g_autofree gchar* launch = g_strdup_printf(
        "videoscale ! video/x-raw,width=%s,height=480 ! videoscale ! video/x-raw,width=100,height=100 ! "
        "videoconvert ! "
        "video/x-raw,format=RGB ! videoscale",
        width);
    GstHarness* h = gst_harness_new_parse(launch);
    gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,framerate=25/1,width=64,height=48");
    gst_harness_set_sink_caps_str(h, "video/x-raw,format=RGB,framerate=25/1,width=64,height=48");
    GstBuffer* frame = gst_buffer_new_allocate(nullptr, 64 * 48 * 3 / 2, nullptr);
    gst_buffer_memset(frame, 0, 128, -1);
    CerberusRegion one = walker(), two = walker();
    one.x = 8.5;  // rounds up: 9
    one.id = two.id = 0;
    one.tracked = two.tracked = FALSE;
    two.x = 40.5;
    gst_buffer_add_video_region_of_interest_meta(frame, "motion", 14, 19, 16, 24);
    cerberus_buffer_add_region(frame, &one);
    cerberus_buffer_add_region(frame, &two);
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    g_autoptr(GstBuffer) out = gst_harness_pull(h);
    gst_harness_teardown(h);

    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    fail_unless_equals_int(regions->len, 2);
    fail_unless(std::abs(at(regions, 0).x - 8.5) < 1e-9 && std::abs(at(regions, 1).x - 40.5) < 1e-9);
    fail_unless(std::abs(at(regions, 0).vx - 10) < 1e-9);
    const double places[] = {NAN, at(regions, 0).x, at(regions, 1).x};
    gpointer state = nullptr;
    for (const double place : places) {
      auto* meta = reinterpret_cast<GstVideoRegionOfInterestMeta*>(
          gst_buffer_iterate_meta_filtered(out, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE));
      fail_unless(meta);
      fail_unless_equals_int(g_list_length(meta->params), std::isnan(place) ? 0 : 2);
      if (std::isnan(place)) continue;
      fail_unless_equals_int(meta->x, std::lround(place));
      double x = 0;
      gst_structure_get_double(gst_video_region_of_interest_meta_get_param(meta, "cerberus-object"), "x", &x);
      fail_unless(x == place);
    }
    cerberus_buffer_remove_regions(out);
    fail_unless_equals_int(count_rois(out), 1);
  }
}
END_TEST

// A GStreamer that scales its meta and keeps the params would leave numbers of the old size in them.
START_TEST(params_that_survive_scaling_are_brought_up_to_date) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  const CerberusRegion region = walker();
  cerberus_buffer_add_region(frame, &region);
  g_autoptr(GstBuffer) scaled = gst_buffer_new();
  GstVideoRegionOfInterestMeta* meta =
      gst_buffer_add_video_region_of_interest_meta(scaled, "motion", 16, 32, 32, 48);
  meta->id = 5;
  for (GList* l = roi(frame)->params; l; l = l->next)
    gst_video_region_of_interest_meta_add_param(meta,
                                                gst_structure_copy(static_cast<GstStructure*>(l->data)));

  GstMeta* own = gst_buffer_get_meta(frame, g_type_from_name("CerberusRegionMetaAPI"));
  GstVideoInfo in, out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_GRAY8, 64, 48);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_GRAY8, 128, 96);
  GstVideoMetaTransform scale{&in, &out};
  fail_unless(
      own->info->transform_func(scaled, own, frame, gst_video_meta_transform_scale_get_quark(), &scale));
  fail_unless_equals_int(g_list_length(meta->params), 3);
  double x = 0;
  gst_structure_get_double(gst_video_region_of_interest_meta_get_param(meta, "cerberus-object"), "x", &x);
  fail_unless_equals_float(x, 16.5);
  fail_unless_equals_int(meta->x, 17);
}
END_TEST

START_TEST(converting_changes_nothing) {
  g_autoptr(GstBuffer) out =
      through("videoconvert", "video/x-raw,format=RGB,framerate=25/1,width=64,height=48", walker());
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 1);
  assert_same(at(regions, 0), walker());
  fail_unless(gst_video_region_of_interest_meta_get_param(roi(out), "cerberus-object"));
}
END_TEST

START_TEST(removing_regions_leaves_those_of_other_elements) {
  GstBuffer* const frames[] = {
      gst_buffer_new(),
      through("videoscale", "video/x-raw,format=I420,framerate=25/1,width=31,height=17", walker()),
  };
  for (GstBuffer* frame : frames) {
    const CerberusRegion region = walker();
    gst_buffer_add_video_region_of_interest_meta(frame, "motion", 1, 2, 3, 4);
    cerberus_buffer_add_region(frame, &region);
    gst_buffer_add_video_region_of_interest_meta(frame, "face", 5, 6, 7, 8);
    cerberus_buffer_add_region(frame, &region);
    cerberus_buffer_remove_regions(frame);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(frame);
    fail_unless_equals_int(regions->len, 0);
    fail_unless_equals_int(count_rois(frame), 2);
    fail_unless_equals_int(roi(frame)->x, 1);
    gst_buffer_unref(frame);
  }
}
END_TEST

START_TEST(a_region_over_the_edge_of_the_frame_is_cut_for_others_only) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusRegion region = walker();
  region.x = -10.5;
  region.y = -100;
  region.width = 30;
  region.height = 20;
  fail_unless(cerberus_buffer_add_region(frame, &region));
  fail_unless_equals_int(roi(frame)->x, 0);
  fail_unless_equals_int(roi(frame)->w, 20);
  fail_unless_equals_int(roi(frame)->y, 0);
  fail_unless_equals_int(roi(frame)->h, 1);
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(frame);
  assert_same(at(regions, 0), region);
}
END_TEST

START_TEST(a_region_without_a_place_is_refused) {
  const double bad[] = {NAN, INFINITY, -INFINITY, 1e12, -1e12};
  for (double value : bad) {
    for (auto member :
         {&CerberusRegion::x, &CerberusRegion::y, &CerberusRegion::width, &CerberusRegion::height}) {
      g_autoptr(GstBuffer) frame = gst_buffer_new();
      CerberusRegion region = walker();
      region.*member = value;
      fail_if(cerberus_buffer_add_region(frame, &region));
      fail_unless_equals_int(count_rois(frame), 0);
    }
  }
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusRegion region = walker();
  region.width = -1;
  fail_if(cerberus_buffer_add_region(frame, &region));
  region = walker();
  region.kind = static_cast<CerberusRegionKind>(CERBERUS_REGION_KIND_THING + 1);
  fail_if(cerberus_buffer_add_region(frame, &region), "a kind that there is not");
}
END_TEST

#if CERBERUS_ANALYTICS
START_TEST(analytics_elements_find_a_detection_and_its_track) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  GST_BUFFER_PTS(frame) = 10 * GST_SECOND;
  const CerberusRegion region = walker();
  cerberus_buffer_add_region(frame, &region);
  GstAnalyticsRelationMeta* meta = gst_buffer_get_analytics_relation_meta(frame);
  fail_unless(meta);
  fail_unless_equals_int(gst_analytics_relation_get_length(meta), 2);

  gpointer state = nullptr;
  GstAnalyticsODMtd detection;
  fail_unless(
      gst_analytics_relation_meta_iterate(meta, &state, gst_analytics_od_mtd_get_mtd_type(), &detection));
  fail_unless_equals_string(g_quark_to_string(gst_analytics_od_mtd_get_obj_type(&detection)), "motion");
  int x = 0, y = 0, width = 0, height = 0;
  float confidence = 0;
  fail_unless(gst_analytics_od_mtd_get_location(&detection, &x, &y, &width, &height, &confidence));
  fail_unless(x == 8 && y == 16 && width == 16 && height == 24);
  fail_unless(std::abs(confidence - 0.9f) < 1e-6f);

  GstAnalyticsTrackingMtd track;
  fail_unless(gst_analytics_relation_meta_get_direct_related(
      meta, detection.id, GST_ANALYTICS_REL_TYPE_RELATE_TO, gst_analytics_tracking_mtd_get_mtd_type(),
      nullptr, &track));
  guint64 id = 0;
  GstClockTime first_seen = 0, last_seen = 0;
  gboolean lost = TRUE;
  fail_unless(gst_analytics_tracking_mtd_get_info(&track, &id, &first_seen, &last_seen, &lost));
  fail_unless_equals_uint64(id, 5);
  fail_unless_equals_uint64(first_seen, 7 * GST_SECOND);
  fail_unless_equals_uint64(last_seen, 10 * GST_SECOND);
  fail_if(lost);
}
END_TEST

START_TEST(detections_go_with_the_regions) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusRegion region = walker();
  region.tracked = FALSE;
  cerberus_buffer_add_region(frame, &region);
  cerberus_buffer_add_region(frame, &region);
  fail_unless_equals_int(gst_analytics_relation_get_length(gst_buffer_get_analytics_relation_meta(frame)), 2);
  cerberus_buffer_remove_regions(frame);
  fail_if(gst_buffer_get_analytics_relation_meta(frame));
  region.tracked = TRUE;
  cerberus_buffer_add_region(frame, &region);
  fail_unless_equals_int(gst_analytics_relation_get_length(gst_buffer_get_analytics_relation_meta(frame)), 2);
}
END_TEST

START_TEST(detections_of_other_elements_stay) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  GstAnalyticsRelationMeta* meta = gst_buffer_add_analytics_relation_meta(frame);
  GstAnalyticsODMtd dog;
  gst_analytics_relation_meta_add_od_mtd(meta, g_quark_from_string("dog"), 1, 2, 3, 4, 0.5f, &dog);
  CerberusRegion region = walker();
  region.tracked = FALSE;
  cerberus_buffer_add_region(frame,
                             &region);  // a tracker will replace it, and it could not be taken out again
  fail_unless_equals_int(gst_analytics_relation_get_length(meta), 1);
  region.tracked = TRUE;
  cerberus_buffer_add_region(frame, &region);
  fail_unless_equals_int(gst_analytics_relation_get_length(meta), 3);
  cerberus_buffer_remove_regions(frame);
  fail_unless(gst_buffer_get_analytics_relation_meta(frame) == meta);
}
END_TEST
#endif

START_TEST(nothing_crashes_on_null) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  EXPECT_CRITICAL(cerberus_region_init(nullptr));
  EXPECT_CRITICAL(cerberus_buffer_add_region(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_add_region(frame, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_get_regions(nullptr));
  EXPECT_CRITICAL(cerberus_buffer_remove_regions(nullptr));
}
END_TEST

static Suite* regions_suite(void) {
  watch_library_log();
  Suite* s = suite_create("regions");
  TCase* tc = tcase_create("buffers");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_region_reads_back_as_it_was_added);
  tcase_add_test(tc, regions_keep_their_order);
  tcase_add_test(tc, other_tools_find_a_region_of_interest);
  tcase_add_test(tc, scaling_scales_regions_and_keeps_what_others_read);
  tcase_add_test(tc, scaling_often_loses_nothing);
  tcase_add_test(tc, params_that_survive_scaling_are_brought_up_to_date);
  tcase_add_test(tc, converting_changes_nothing);
  tcase_add_test(tc, removing_regions_leaves_those_of_other_elements);
  tcase_add_test(tc, a_region_over_the_edge_of_the_frame_is_cut_for_others_only);
  tcase_add_test(tc, a_region_without_a_place_is_refused);
#if CERBERUS_ANALYTICS
  tcase_add_test(tc, analytics_elements_find_a_detection_and_its_track);
  tcase_add_test(tc, detections_go_with_the_regions);
  tcase_add_test(tc, detections_of_other_elements_stay);
#endif
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(regions)
