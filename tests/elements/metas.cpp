// SPDX-License-Identifier: LGPL-2.1-or-later
// What is attached to a frame arrives where it must, dies where it must, and is right where it arrives.
// C++ first: check's macros (fail) bite standard headers.
#include "records.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstring>
#include <string>

#include "annotated.h"
#include "support.h"

namespace {

using annotated::kHeight, annotated::kWidth;
using cerberus::plugin::ThresholdFacts;
using records::mask_of, records::record_of, records::set_record, records::threshold_facts_of;
const std::string kI420 = annotated::kI420;

struct Passage {
  const char* launch;
  const char* out_caps;  // nullptr: anything
  bool motion, threshold, plane, region;
};

// In 1.22 videoflip copies every meta unchanged, whatever its tags: all but the threshold is wrong behind it, as is
// documented. In 1.26 it drops them, which is right (1.24 was not tried).
const bool kFlipCopies = [] {
  guint major, minor, micro, nano;
  gst_version(&major, &minor, &micro, &nano);
  return minor < 26;
}();
const Passage kPassages[] = {
    {"identity", nullptr, true, true, true, true},
    {"queue", nullptr, true, true, true, true},
    {"tee ! queue", nullptr, true, true, true, true},
    {"videorate", "video/x-raw,format=I420,framerate=25/1,width=64,height=48", true, true, true, true},
    {"videoconvert", "video/x-raw,format=I420,framerate=25/1,width=64,height=48", true, true, true, true},
    {"videoconvert", "video/x-raw,format=RGB,framerate=25/1,width=64,height=48", true, true, false, true},
    {"videoscale", "video/x-raw,format=I420,framerate=25/1,width=256,height=24", true, true, false, true},
    {"videocrop left=8 top=8", nullptr, false, true, false, false},
    {"videoflip method=horizontal-flip", nullptr, kFlipCopies, true, kFlipCopies, kFlipCopies},
    {"x264enc tune=zerolatency", nullptr, true, true, false, true},
};

GstBuffer* pass(const Passage& passage) {
  GstHarness* h = gst_harness_new_parse(passage.launch);
  gst_harness_set_src_caps_str(h, kI420.c_str());
  if (passage.out_caps) gst_harness_set_sink_caps_str(h, passage.out_caps);
  fail_unless_equals_int(gst_harness_push(h, annotated::frame_with_everything()), GST_FLOW_OK);
  fail_unless(gst_harness_push_event(h, gst_event_new_eos()));
  GstBuffer* out = gst_harness_pull(h);
  fail_unless(out, "nothing came out of %s", passage.launch);
  gst_harness_teardown(h);
  return out;
}

guint count_ours(GstBuffer* frame) {
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(frame);
  return regions->len;
}

const Passage& passage_named(const char* launch) {
  for (const Passage& p : kPassages)
    if (g_str_equal(p.launch, launch)) return p;
  ck_abort_msg("no such passage");
}

}  // namespace

START_TEST(every_element_keeps_what_it_should) {
  const Passage& p = kPassages[_i];
  const std::string name(p.launch, std::string(p.launch).find_first_of(" !") == std::string::npos
                                       ? std::string(p.launch).size()
                                       : std::string(p.launch).find_first_of(" !"));
  g_autoptr(GstElementFactory) factory = gst_element_factory_find(name.c_str());
  if (!factory) {
    g_printerr("skipped: element %s is not installed\n", name.c_str());
    return;
  }
  g_autoptr(GstBuffer) out = pass(p);
  g_autoptr(CerberusCameraMotion) motion = cerberus_buffer_get_camera_motion(out);
  const ThresholdFacts* threshold = threshold_facts_of(out);
  fail_unless_equals_int(motion != nullptr, p.motion);
  fail_unless_equals_int(threshold != nullptr, p.threshold);
  fail_unless_equals_int(!mask_of(out).empty(), p.plane);
  fail_unless_equals_int(count_ours(out), p.region);
  fail_unless_equals_int(cerberus_buffer_regions_known(out), p.region);
  if (motion) {
    fail_unless_equals_uint64(motion->from, 40 * GST_MSECOND);
    fail_unless_equals_float(motion->confidence, 0.75);
    fail_unless_equals_int(motion->scene_age, 7);
  }
  if (threshold) {
    fail_unless_equals_int(threshold->result.threshold, 12);
    fail_unless_equals_int(threshold->result.fuzzy_threshold, 30);
    fail_unless_equals_float(threshold->result.sigma, 1.5);
    fail_unless(threshold->result.ready);
    fail_unless_equals_int(threshold->chosen_with.order, 3);
  }
}
END_TEST

// Hand-computed: the picture becomes four times as wide and half as high, so a shift by (3, -2) is one by (12, -1), and
// lengths grow by sqrt(4 / 2) on average.
START_TEST(scaling_scales_the_camera_motion) {
  g_autoptr(GstBuffer) out = pass(passage_named("videoscale"));
  const CerberusCameraMotion* meta = cerberus_buffer_peek_camera_motion(out);
  const double expected[9] = {1, 0, 12, 0, 1, -1, 0, 0, 1};
  const double way[9] = {1, 0, 84, 0, 1, -7, 0, 0, 1};
  for (int i = 0; i < 9; ++i) {
    fail_unless(std::abs(meta->matrix[i] - expected[i]) < 1e-12);
    fail_unless(std::abs(meta->path[i] - way[i]) < 1e-12);
  }
  fail_unless_equals_int(meta->path_id, 4);
  fail_unless(std::abs(meta->residual - 0.5 * std::sqrt(2.0)) < 1e-12);
}
END_TEST

// A homography in both pictures maps the same place to the same place: (x + 0.5) * factor - 0.5 takes one to
// the other.
START_TEST(a_scaled_homography_maps_the_same_places) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  g_autoptr(CerberusCameraMotion) motion = cerberus_camera_motion_new();
  const double matrix[9] = {0.98, -0.1, 4, 0.12, 1.03, -3, 1e-4, -2e-4, 1};
  cerberus_camera_motion_set_matrix(motion, matrix);
  fail_unless(cerberus_buffer_set_camera_motion(frame, motion));

  GstVideoInfo in, out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_GRAY8, 320, 240);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_GRAY8, 1920, 1080);
  GstVideoMetaTransform scale{&in, &out};
  g_autoptr(GstBuffer) scaled = gst_buffer_new();
  GstMeta* meta = gst_buffer_get_meta(frame, CERBERUS_CAMERA_MOTION_META_API_TYPE);
  fail_unless(
      meta->info->transform_func(scaled, meta, frame, gst_video_meta_transform_scale_get_quark(), &scale));
  g_autoptr(CerberusCameraMotion) result = cerberus_buffer_get_camera_motion(scaled);

  const double fx = 6, fy = 4.5;
  const double points[][2] = {{0, 0}, {319, 0}, {0, 239}, {319, 239}, {100.5, 77}};
  for (const auto& p : points) {
    double x = 0, y = 0, big_x = 0, big_y = 0;
    fail_unless(cerberus_camera_motion_apply(motion, p[0], p[1], &x, &y));
    fail_unless(cerberus_camera_motion_apply(result, (p[0] + 0.5) * fx - 0.5, (p[1] + 0.5) * fy - 0.5, &big_x,
                                             &big_y));
    fail_unless(std::abs(big_x - ((x + 0.5) * fx - 0.5)) < 1e-6);
    fail_unless(std::abs(big_y - ((y + 0.5) * fy - 0.5)) < 1e-6);
  }
}
END_TEST

START_TEST(a_still_camera_stays_exactly_still_when_scaled) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  g_autoptr(CerberusCameraMotion) motion = cerberus_camera_motion_new();
  motion->still = TRUE;
  cerberus_buffer_set_camera_motion(frame, motion);
  GstVideoInfo in, out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_GRAY8, 333, 97);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_GRAY8, 100, 1000);
  GstVideoMetaTransform scale{&in, &out};
  g_autoptr(GstBuffer) scaled = gst_buffer_new();
  GstMeta* meta = gst_buffer_get_meta(frame, CERBERUS_CAMERA_MOTION_META_API_TYPE);
  fail_unless(
      meta->info->transform_func(scaled, meta, frame, gst_video_meta_transform_scale_get_quark(), &scale));
  const CerberusCameraMotion* result = cerberus_buffer_peek_camera_motion(scaled);
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int i = 0; i < 9; ++i) fail_unless(result->matrix[i] == identity[i]);
  fail_unless(result->still);
}
END_TEST

START_TEST(a_point_on_the_horizon_has_no_place) {
  g_autoptr(CerberusCameraMotion) motion = cerberus_camera_motion_new();
  const double matrix[9] = {1, 0, 0, 0, 1, 0, 1, 0, -10};  // w = x - 10
  cerberus_camera_motion_set_matrix(motion, matrix);
  double x = -1, y = -1;
  fail_if(cerberus_camera_motion_apply(motion, 10, 5, &x, &y));
  fail_unless_equals_float(x, -1);
  fail_unless(cerberus_camera_motion_apply(motion, 12, 5, &x, &y));  // w = 2
  fail_unless_equals_float(x, 6);
  fail_unless_equals_float(y, 2.5);
  fail_unless(cerberus_camera_motion_apply(motion, 12, 5, nullptr, nullptr));
}
END_TEST

START_TEST(copies_carry_everything_and_share_the_planes) {
  g_autoptr(GstBuffer) frame = annotated::frame_with_everything();
  g_autoptr(GstBuffer) shallow = gst_buffer_copy(frame);
  g_autoptr(GstBuffer) deep = gst_buffer_copy_deep(frame);
  for (GstBuffer* copy : {shallow, deep}) {
    fail_unless(cerberus_buffer_peek_camera_motion(copy));
    fail_unless(threshold_facts_of(copy));
    fail_unless_equals_int(count_ours(copy), 1);
    fail_if(mask_of(copy).empty());
    fail_unless(mask_of(copy).data == mask_of(frame).data);
  }
}
END_TEST

START_TEST(a_part_of_a_frame_has_no_planes) {
  g_autoptr(GstBuffer) frame = annotated::frame_with_everything();
  g_autoptr(GstBuffer) part = gst_buffer_copy_region(frame, GST_BUFFER_COPY_ALL, 0, 100);
  fail_unless(mask_of(part).empty());
  fail_unless(threshold_facts_of(part));

  // GStreamer transforms metas of the tag `memory` only where everything is copied; for any other request:
  GstMeta* meta = gst_buffer_get_meta(frame, gst_meta_get_info("CerberusRecordMeta")->api);
  GstMetaTransformCopy copy = {TRUE, 0, 100};
  fail_if(meta->info->transform_func(part, meta, frame, _gst_meta_transform_copy, &copy));
  fail_unless(mask_of(part).empty());
}
END_TEST

// Two branches of a tee share one buffer until one writes: what it takes off its copy stays on the other's.
START_TEST(branches_of_a_tee_do_not_disturb_each_other) {
  GstElement* tee = gst_element_factory_make("tee", nullptr);
  GstHarness* one = gst_harness_new_with_element(tee, "sink", "src_%u");
  GstHarness* two = gst_harness_new_with_element(tee, nullptr, "src_%u");
  gst_harness_set_src_caps_str(one, kI420.c_str());
  fail_unless_equals_int(gst_harness_push(one, annotated::frame_with_everything()), GST_FLOW_OK);
  g_autoptr(GstBuffer) changed = gst_harness_pull(one);
  g_autoptr(GstBuffer) kept = gst_harness_pull(two);
  changed = gst_buffer_make_writable(changed);
  fail_unless(changed != kept);
  set_record(changed, {});
  cerberus_buffer_remove_regions(changed);
  cerberus_buffer_set_camera_motion(changed, nullptr);
  fail_unless(mask_of(changed).empty());
  fail_if(cerberus_buffer_peek_camera_motion(changed));
  fail_unless_equals_int(count_ours(changed), 0);
  fail_if(mask_of(kept).empty());
  fail_unless(cerberus_buffer_peek_camera_motion(kept));
  fail_unless(threshold_facts_of(kept));
  fail_unless_equals_int(count_ours(kept), 1);
  gst_harness_teardown(two);
  gst_harness_teardown(one);
  gst_object_unref(tee);
}
END_TEST

START_TEST(a_frame_has_one_of_each_and_the_last_one_counts) {
  g_autoptr(GstBuffer) frame = annotated::frame_with_everything();
  ThresholdFacts facts;
  facts.result.threshold = 99;
  cerberus::plugin::set_threshold_facts(frame, facts);
  g_autoptr(CerberusCameraMotion) motion = cerberus_camera_motion_new();
  motion->scene_age = 8;
  fail_unless(cerberus_buffer_set_camera_motion(frame, motion));
  g_autoptr(GstBuffer) other = gst_buffer_new();
  set_record(frame, records::on(other, {2, 2}));

  fail_unless_equals_int(gst_buffer_get_n_meta(frame, gst_meta_get_info("CerberusThresholdMeta")->api), 1);
  fail_unless_equals_int(gst_buffer_get_n_meta(frame, CERBERUS_CAMERA_MOTION_META_API_TYPE), 1);
  fail_unless_equals_int(gst_buffer_get_n_meta(frame, gst_meta_get_info("CerberusRecordMeta")->api), 1);
  fail_unless_equals_int(threshold_facts_of(frame)->result.threshold, 99);
  fail_unless_equals_int(cerberus_buffer_peek_camera_motion(frame)->scene_age, 8);
  fail_unless(record_of(frame)->frame == (cerberus::vision::Size{2, 2}));
}
END_TEST

START_TEST(a_shared_frame_cannot_be_annotated) {
  g_autoptr(GstBuffer) frame = annotated::frame_with_everything();
  g_autoptr(GstBuffer) other = gst_buffer_ref(frame);
  g_autoptr(CerberusCameraMotion) motion = cerberus_camera_motion_new();
  g_autoptr(CerberusRegion) region = cerberus_region_new();
  fail_if(cerberus_buffer_set_camera_motion(frame, motion));
  fail_if(cerberus_buffer_add_region(frame, region));
  EXPECT_CRITICAL(cerberus_buffer_remove_regions(frame));
}
END_TEST

// An application in C may leave any number in an enumeration.
START_TEST(a_foreign_number_in_an_enumeration_is_the_default) {
  const int foreign = 77;
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  CerberusPose pose;
  cerberus_pose_init(&pose);
  std::memcpy(&pose.source, &foreign, sizeof foreign);
  fail_unless(cerberus_buffer_set_pose(frame, &pose));
  fail_unless_equals_int(cerberus_buffer_peek_pose(frame)->source, CERBERUS_POSE_COMMANDED);
  CerberusBase base;
  cerberus_base_init(&base);
  std::memcpy(&base.source, &foreign, sizeof foreign);
  fail_unless(cerberus_buffer_set_base(frame, &base));
  fail_unless_equals_int(cerberus_buffer_peek_base(frame)->source, CERBERUS_BASE_ESTIMATED);
  CerberusStamp stamp;
  cerberus_stamp_init(&stamp);
  std::memcpy(&stamp.utc_source, &foreign, sizeof foreign);
  fail_unless(cerberus_buffer_set_stamp(frame, &stamp));
  fail_unless_equals_int(cerberus_buffer_peek_stamp(frame)->utc_source, CERBERUS_UTC_UNKNOWN);
}
END_TEST

START_TEST(nothing_crashes_on_null) {
  fail_if(cerberus_camera_motion_copy(nullptr));
  fail_if(cerberus_region_copy(nullptr));
  cerberus_camera_motion_free(nullptr);
  cerberus_region_free(nullptr);
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  EXPECT_CRITICAL(cerberus_camera_motion_init(nullptr));
  EXPECT_CRITICAL(cerberus_camera_motion_apply(nullptr, 0, 0, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_camera_motion_set_matrix(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_get_camera_motion(nullptr));
  EXPECT_CRITICAL(cerberus_buffer_set_camera_motion(nullptr, nullptr));
  fail_unless(cerberus_buffer_set_camera_motion(frame, nullptr), "nothing is removed");
}
END_TEST

static Suite* metas_suite(void) {
  watch_library_log();
  Suite* s = suite_create("metas");
  TCase* tc = tcase_create("survival");
  suite_add_tcase(s, tc);
  tcase_add_loop_test(tc, every_element_keeps_what_it_should, 0, G_N_ELEMENTS(kPassages));
  tcase_add_test(tc, copies_carry_everything_and_share_the_planes);
  tcase_add_test(tc, a_part_of_a_frame_has_no_planes);
  tcase_add_test(tc, branches_of_a_tee_do_not_disturb_each_other);
  tc = tcase_create("meaning");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, scaling_scales_the_camera_motion);
  tcase_add_test(tc, a_scaled_homography_maps_the_same_places);
  tcase_add_test(tc, a_still_camera_stays_exactly_still_when_scaled);
  tcase_add_test(tc, a_point_on_the_horizon_has_no_place);
  tcase_add_test(tc, a_frame_has_one_of_each_and_the_last_one_counts);
  tc = tcase_create("bad input");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_shared_frame_cannot_be_annotated);
  tcase_add_test(tc, a_foreign_number_in_an_enumeration_is_the_default);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(metas)
