/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* The library from plain C: every public header by itself and strictly, the boxed types' automatic cleanup, and a round
 * trip through each family of functions. */
#include <cerberus/cerberus.h>

#include <math.h>
#include <string.h>

#define CHECK(condition)                                         \
  do {                                                           \
    if (!(condition)) {                                          \
      g_printerr("%s:%d: %s\n", __FILE__, __LINE__, #condition); \
      return 1;                                                  \
    }                                                            \
  } while (0)

static int boxed_types_copy_and_compare(void) {
  const GType types[] = {CERBERUS_TYPE_CAMERA_MOTION, CERBERUS_TYPE_REGION, CERBERUS_TYPE_POSE,
                         CERBERUS_TYPE_FUSION,        CERBERUS_TYPE_BASE,   CERBERUS_TYPE_PIR,
                         CERBERUS_TYPE_PANTILT,       CERBERUS_TYPE_MOTION, CERBERUS_TYPE_TRACK,
                         CERBERUS_TYPE_STAMP};
  guint i;

  for (i = 0; i < G_N_ELEMENTS(types); ++i) CHECK(G_TYPE_IS_BOXED(types[i]));
  CHECK(G_TYPE_IS_ENUM(CERBERUS_TYPE_REGION_STATE) && G_TYPE_IS_ENUM(CERBERUS_TYPE_REGION_KIND));
  CHECK(G_TYPE_IS_ENUM(CERBERUS_TYPE_UTC_SOURCE) && G_TYPE_IS_ENUM(CERBERUS_TYPE_PANTILT_STATE));
  CHECK(G_TYPE_IS_ENUM(CERBERUS_TYPE_MOTION_STATE) && G_TYPE_IS_ENUM(CERBERUS_TYPE_TRACK_STATE));
  CHECK(G_TYPE_IS_ENUM(CERBERUS_TYPE_BASE_SOURCE));
  CHECK(G_TYPE_IS_ENUM(CERBERUS_TYPE_POSE_SOURCE) && G_TYPE_IS_ENUM(CERBERUS_TYPE_FUSION_ACTION));
  {
    g_autoptr(CerberusRegion) region = cerberus_region_new();
    g_autoptr(CerberusRegion) copy = NULL;

    CHECK(isnan(region->bearing) && isnan(region->distance) && !region->tracked);
    region->id = 3;
    copy = (CerberusRegion*)g_boxed_copy(CERBERUS_TYPE_REGION, region);
    CHECK(copy != region && copy->id == 3);
  }
  return 0;
}

static int a_buffer_carries_it_all(void) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  g_autoptr(CerberusCameraMotion) motion_back = NULL;
  g_autoptr(GPtrArray) regions = NULL;
  CerberusCameraMotion motion;
  CerberusRegion region;

  cerberus_camera_motion_init(&motion);
  CHECK(motion.matrix[0] == 1 && motion.from == GST_CLOCK_TIME_NONE);
  CHECK(cerberus_buffer_set_camera_motion(buffer, &motion));
  cerberus_region_init(&region);
  region.width = region.height = 10;
  CHECK(!cerberus_buffer_regions_known(buffer));
  CHECK(cerberus_buffer_add_region(buffer, &region) && cerberus_buffer_regions_known(buffer));

  motion_back = cerberus_buffer_get_camera_motion(buffer);
  regions = cerberus_buffer_get_regions(buffer);
  CHECK(motion_back != NULL && memcmp(motion_back->matrix, motion.matrix, sizeof motion.matrix) == 0);
  CHECK(regions->len == 1);
  return 0;
}

static int a_head_and_its_sensors_are_published(void) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();
  g_autoptr(CerberusPose) pose = cerberus_pose_new();
  g_autoptr(CerberusPose) received = NULL;
  g_autoptr(CerberusFusion) fusion = cerberus_fusion_new();
  g_autoptr(GstEvent) event = NULL;
  g_autoptr(GstCaps) caps = NULL;
  CerberusPirInfo info;

  pose->pan = 30;
  event = cerberus_event_new_pose(pose);
  received = cerberus_event_parse_pose(event);
  CHECK(received != NULL && received->pan == 30);
  CHECK(cerberus_buffer_set_pose(buffer, pose) && cerberus_buffer_peek_pose(buffer)->pan == 30);
  fusion->action = CERBERUS_FUSION_TURN_LEFT;
  CHECK(cerberus_buffer_set_fusion(buffer, fusion));
  CHECK(strcmp(cerberus_fusion_action_get_nick(cerberus_buffer_peek_fusion(buffer)->action), "turn-left") ==
        0);
  cerberus_pir_info_init(&info);
  caps = cerberus_pir_info_to_caps(&info);
  CHECK(caps != NULL && cerberus_pir_info_from_caps(&info, caps, NULL) && info.sensors == 3);
  return 0;
}

static int a_message_carries_a_track_and_its_stamp(void) {
  g_autoptr(CerberusTrack) track = cerberus_track_new();
  g_autoptr(CerberusTrack) back = NULL;
  g_autoptr(CerberusStamp) stamp = cerberus_stamp_new();
  g_autoptr(CerberusStamp) stamp_back = NULL;
  g_autoptr(GstMessage) message = NULL;

  CHECK(stamp->running_time == GST_CLOCK_TIME_NONE && stamp->utc == GST_CLOCK_TIME_NONE);
  stamp->running_time = 5;
  stamp->utc = G_GUINT64_CONSTANT(1700000000123456789);
  stamp->utc_source = CERBERUS_UTC_CLOCK;
  cerberus_stamp_set_camera_name(stamp, "yard");
  track->state = CERBERUS_TRACK_LEFT;
  track->region.id = 7;
  track->last = 4;
  message = cerberus_message_new_track(NULL, stamp, track);
  CHECK(cerberus_message_is_track(message) && !cerberus_message_is_motion(message));
  back = cerberus_message_parse_track(message);
  CHECK(back != NULL && back->state == CERBERUS_TRACK_LEFT && back->region.id == 7);
  CHECK(back->first == GST_CLOCK_TIME_NONE && back->last == 4);
  stamp_back = cerberus_message_parse_stamp(message);
  CHECK(stamp_back != NULL && stamp_back->running_time == 5 && stamp_back->utc == stamp->utc);
  CHECK(stamp_back->utc_source == CERBERUS_UTC_CLOCK && strcmp(stamp_back->camera_name, "yard") == 0);
  return 0;
}

static int versions_agree(void) {
  guint major, minor, micro;

  cerberus_version(&major, &minor, &micro);
  CHECK(major == CERBERUS_VERSION_MAJOR && minor == CERBERUS_VERSION_MINOR &&
        micro == CERBERUS_VERSION_MICRO);
  CHECK(CERBERUS_CHECK_VERSION(CERBERUS_VERSION_MAJOR, CERBERUS_VERSION_MINOR, CERBERUS_VERSION_MICRO));
  CHECK(!CERBERUS_CHECK_VERSION(CERBERUS_VERSION_MAJOR + 1, 0, 0));
  CHECK(!CERBERUS_CHECK_VERSION(CERBERUS_VERSION_MAJOR, CERBERUS_VERSION_MINOR + 1, 0));
  cerberus_version(NULL, NULL, NULL);
  return 0;
}

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  return boxed_types_copy_and_compare() + a_buffer_carries_it_all() + a_head_and_its_sensors_are_published() +
         a_message_carries_a_track_and_its_stamp() + versions_agree();
}
