// SPDX-License-Identifier: LGPL-2.1-or-later
// Findings that another process reads: unixfdsink here, unixfdsrc in a forked process (GStreamer 1.24).
// C++ first: check's macros (fail) bite standard headers.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "../support/temporary_folder.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/video/video.h>

#include "annotated.h"
#include "cerberus/private/compat.hpp"
#include "support.h"

#if CERBERUS_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

namespace {

constexpr GstClockTime kBefore = 20 * GST_MSECOND;

// By the frame's number: one region, none found, not analysed.
enum { kRegion, kNothing, kUnknown, kKinds };

GstPadProbeReturn annotate(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstBuffer* frame = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = frame;
  const GstClockTime now = GST_BUFFER_PTS(frame), before = now - MIN(now, kBefore);
  const guint64 kind = GST_BUFFER_OFFSET(frame) % kKinds;
  g_autoptr(GPtrArray) regions = g_ptr_array_new();
  CerberusRegion walker = annotated::walker();
  if (kind == kRegion) g_ptr_array_add(regions, &walker);
  if (kind != kUnknown) cerberus_buffer_set_regions(frame, regions);

  CerberusPose pose;
  cerberus_pose_init(&pose);
  cerberus_pose_set_head(&pose, "mast");
  pose.source = CERBERUS_POSE_MEASURED;
  pose.pan = 12.5;
  pose.pan_speed = -30;
  pose.valid_from = before;
  cerberus_buffer_set_pose(frame, &pose);
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[2] = 3.25;
  motion.path[5] = -7;
  motion.from = before;
  motion.scene_age = 9;
  cerberus_buffer_set_camera_motion(frame, &motion);
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.rule = 2;
  fusion.rule_name = g_intern_static_string("turn left");
  fusion.action = CERBERUS_FUSION_TURN_LEFT;
  fusion.n_sensors = 3;
  fusion.sensors[1] = 1;
  fusion.bearings[2] = 120;
  fusion.decided = now;
  cerberus_buffer_set_fusion(frame, &fusion);
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = 4.5;
  cerberus_buffer_set_base(frame, &base);
  CerberusStamp stamp;
  cerberus_stamp_init(&stamp);
  stamp.running_time = now;
  stamp.utc = 1'700'000'000 * GST_SECOND;
  cerberus_stamp_set_camera_name(&stamp, "yard");
  cerberus_buffer_set_stamp(frame, &stamp);
  return GST_PAD_PROBE_OK;
}

// In the process that receives: what is wrong with the frame; nullptr: nothing.
#define EXPECT(condition) \
  if (!(condition)) return #condition
const char* fault_of_region(GstBuffer* frame) {
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(frame);
  EXPECT(regions->len == 1);
  const CerberusRegion& region = annotated::at(regions, 0);
  const CerberusRegion sent = annotated::walker();
  EXPECT(region.id == sent.id && region.tracked && region.state == sent.state && region.age == sent.age);
  EXPECT(region.x == sent.x && region.y == sent.y && region.width == sent.width &&
         region.height == sent.height);
  EXPECT(region.vx == sent.vx && region.vy == sent.vy && region.bearing == sent.bearing);
  EXPECT(region.confidence == sent.confidence && std::isnan(region.distance));
  GstVideoRegionOfInterestMeta* roi = gst_buffer_get_video_region_of_interest_meta_id(frame, 5);
  EXPECT(roi && roi->x == 8 && roi->y == 16 && roi->w == 16 && roi->h == 24);
  EXPECT(roi->roi_type == g_quark_from_static_string("motion"));
  EXPECT(gst_video_region_of_interest_meta_get_param(roi, "object_id"));
  EXPECT(gst_buffer_get_n_meta(frame, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE) == 1);
#if CERBERUS_ANALYTICS
  GstAnalyticsRelationMeta* relations = gst_buffer_get_analytics_relation_meta(frame);
  EXPECT(relations && gst_analytics_relation_get_length(relations) == 2);  // a detection and its track
#endif
  return nullptr;
}

const char* fault_of(GstBuffer* frame) {
  const GstClockTime now = GST_BUFFER_PTS(frame);
  const guint64 kind = GST_BUFFER_OFFSET(frame) % kKinds;
  EXPECT(cerberus_buffer_regions_known(frame) == (kind != kUnknown));
  if (kind == kRegion)
    if (const char* fault = fault_of_region(frame)) return fault;
  const CerberusPose* pose = cerberus_buffer_peek_pose(frame);
  EXPECT(pose && g_str_equal(pose->head, "mast") && pose->source == CERBERUS_POSE_MEASURED);
  EXPECT(pose->pan == 12.5 && pose->pan_speed == -30 && pose->valid_until == GST_CLOCK_TIME_NONE &&
         pose->settled);
  const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(frame);
  EXPECT(motion && motion->matrix[2] == 3.25 && motion->path[5] == -7 && motion->scene_age == 9);
  const CerberusFusion* fusion = cerberus_buffer_peek_fusion(frame);
  EXPECT(fusion && fusion->rule == 2 && g_str_equal(fusion->rule_name, "turn left") && !fusion->head);
  EXPECT(fusion->action == CERBERUS_FUSION_TURN_LEFT && fusion->n_sensors == 3 && fusion->sensors[1] == 1);
  EXPECT(fusion->bearings[2] == 120 && fusion->decided == now);
  const CerberusBase* base = cerberus_buffer_peek_base(frame);
  EXPECT(base && base->yaw_rate == 4.5 && base->valid_from == GST_CLOCK_TIME_NONE);
  const CerberusStamp* stamp = cerberus_buffer_peek_stamp(frame);
  EXPECT(stamp && stamp->running_time == now && stamp->utc == 1'700'000'000 * GST_SECOND);
  EXPECT(g_str_equal(stamp->camera_name, "yard"));
  // A frame of before this pipeline's zero has the time 0, and so has what was before that.
  EXPECT(now < kBefore || (pose->valid_from == now - kBefore && motion->from == now - kBefore));
  return nullptr;
}

struct Received {
  int frames[kKinds] = {};
  bool late = false;  // a frame whose times are all above 0
  const char* fault = nullptr;
  GMainLoop* loop = g_main_loop_new(nullptr, FALSE);
};

GstPadProbeReturn receive(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto& received = *static_cast<Received*>(data);
  GstBuffer* frame = GST_PAD_PROBE_INFO_BUFFER(info);
  if (!received.fault) received.fault = fault_of(frame);
  ++received.frames[GST_BUFFER_OFFSET(frame) % kKinds];
  received.late = received.late || GST_BUFFER_PTS(frame) >= kBefore;
  bool enough = received.late;
  for (const int n : received.frames) enough = enough && n > 0;
  if (received.fault || enough) g_main_loop_quit(received.loop);
  return GST_PAD_PROBE_OK;
}

gboolean on_error(GstBus*, GstMessage* message, gpointer data) {
  auto& received = *static_cast<Received*>(data);
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) return G_SOURCE_CONTINUE;
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  received.fault = g_intern_string(error->message);
  g_main_loop_quit(received.loop);
  return G_SOURCE_REMOVE;
}

// The receiving process. Nothing of the library is used before the data comes, but `registering`.
int run_receiver(const std::string& socket, const char* registering) {
  if (!registering) cerberus_init();
  GstElement* element = registering ? gst_element_factory_make(registering, nullptr) : nullptr;
  if (registering && !element) return 3;
  gst_clear_object(&element);
  Received received;
  GstElement* pipeline = gst_parse_launch(
      ("unixfdsrc socket-path=" + socket + " ! fakesink name=sink sync=false").c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_bus_add_watch(bus, on_error, &received);
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, receive, &received, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_main_loop_run(received.loop);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  if (received.fault) std::fprintf(stderr, "receiver: an error, or not true: %s\n", received.fault);
  return received.fault ? 1 : 0;
}

const char* const kRegistering[] = {nullptr, "onvifmeta", "pirsrc",
                                    "virtualptz"};  // cerberus_init(), or any element

GST_START_TEST(another_process_reads_what_was_found) {
  g_autoptr(GstElementFactory) factory = gst_element_factory_find("unixfdsink");
  guint major = 0, minor = 0, micro = 0, nano = 0;
  gst_version(&major, &minor, &micro, &nano);
  fail_unless(factory || minor < 24, "unixfdsink is missing: it is in GStreamer's plugins-bad");
  if (!factory) {
    std::printf("skipped: GStreamer sends no metadata to other processes (needs 1.24, unixfdsink)\n");
    return;
  }
  const TemporaryFolder folder;
  const std::string socket = folder.path + "/frames";
  int ready[2];
  fail_unless_equals_int(pipe(ready), 0);
  const pid_t receiver = fork();  // no thread runs yet
  if (receiver == 0) {
    char byte = 0;
    close(ready[1]);  // so that the sender's end ends the wait
    _exit(read(ready[0], &byte, 1) == 1 ? run_receiver(socket, kRegistering[__i__]) : 2);
  }
  GstElement* pipeline =
      gst_parse_launch(("videotestsrc is-live=true ! video/x-raw,format=I420,width=64,height=48,"
                        "framerate=25/1 ! identity name=frames ! unixfdsink sync=false socket-path=" +
                        socket)
                           .c_str(),
                       nullptr);
  g_autoptr(GstElement) frames = gst_bin_get_by_name(GST_BIN(pipeline), "frames");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(frames, "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, annotate, nullptr, nullptr);
  fail_if(gst_element_set_state(pipeline, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
  fail_unless_equals_int(write(ready[1], "", 1), 1);
  int status = -1;
  fail_unless_equals_int(waitpid(receiver, &status, 0), receiver);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  fail_unless(WIFEXITED(status) && WEXITSTATUS(status) == 0, "the receiver's status is %d", status);
  close(ready[0]);
  close(ready[1]);
}
GST_END_TEST;

Suite* across_processes_suite() {
  Suite* s = suite_create("across_processes");
  TCase* tc = tcase_create("unixfd");
  tcase_set_timeout(tc, 100);
  suite_add_tcase(s, tc);
  tcase_add_loop_test(tc, another_process_reads_what_was_found, 0, G_N_ELEMENTS(kRegistering));
  return s;
}

}  // namespace

GST_CHECK_MAIN(across_processes)
