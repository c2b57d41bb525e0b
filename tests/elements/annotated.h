// SPDX-License-Identifier: LGPL-2.1-or-later
// What tests of metas and regions put on frames.
#pragma once

#include <cmath>
#include <initializer_list>

#include "records.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/video/video.h>

namespace annotated {

inline constexpr int kWidth = 64, kHeight = 48;
inline constexpr char kI420[] = "video/x-raw,format=I420,framerate=25/1,width=64,height=48";

// A grey frame, I420 unless it has other `bytes`.
inline GstBuffer* plain_frame(gsize bytes = kWidth * kHeight * 3 / 2) {
  GstBuffer* frame = gst_buffer_new_allocate(nullptr, bytes, nullptr);
  gst_buffer_memset(frame, 0, 128, bytes);
  GST_BUFFER_PTS(frame) = 0;
  GST_BUFFER_DURATION(frame) = GST_SECOND / 25;
  return frame;
}

// A track with every field set, whose edges are nearest to the pixels 8, 16, 24 and 40.
inline CerberusRegion walker() {
  CerberusRegion region;
  cerberus_region_init(&region);
  region.id = 5;
  region.tracked = TRUE;
  region.x = 8.25;
  region.y = 16;
  region.width = 15.5;
  region.height = 24;
  region.confidence = 0.9;
  region.vx = 10;
  region.vy = -5;
  region.age = 3 * GST_SECOND;
  region.state = CERBERUS_REGION_COASTED;
  region.bearing = -12.5;
  region.motion = FALSE;
  return region;
}

inline void assert_same(const CerberusRegion& a, const CerberusRegion& b) {
  fail_unless_equals_int(a.id, b.id);
  fail_unless_equals_int(a.tracked, b.tracked);
  fail_unless_equals_int(a.person, b.person);
  fail_unless_equals_int(a.motion, b.motion);
  fail_unless_equals_int(a.state, b.state);
  fail_unless_equals_uint64(a.age, b.age);
  const double pairs[][2] = {{a.x, b.x},
                             {a.y, b.y},
                             {a.width, b.width},
                             {a.height, b.height},
                             {a.confidence, b.confidence},
                             {a.vx, b.vx},
                             {a.vy, b.vy},
                             {a.bearing, b.bearing},
                             {a.distance, b.distance}};
  for (const auto& p : pairs) fail_unless(p[0] == p[1] || (std::isnan(p[0]) && std::isnan(p[1])));
}

inline const CerberusRegion& at(GPtrArray* regions, guint i) {
  return *static_cast<CerberusRegion*>(g_ptr_array_index(regions, i));
}

// A frame with one annotation of each kind, and a region of interest of another element.
inline GstBuffer* frame_with_everything(gsize bytes = kWidth * kHeight * 3 / 2) {
  GstBuffer* frame = plain_frame(bytes);

  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[2] = 3;
  motion.matrix[5] = -2;
  motion.from = 40 * GST_MSECOND;
  motion.confidence = 0.75;
  motion.residual = 0.5;
  motion.scene_age = 7;
  motion.path_id = 4;
  motion.path[2] = 21;
  motion.path[5] = -14;
  cerberus_buffer_set_camera_motion(frame, &motion);

  cerberus::plugin::ThresholdFacts facts;
  facts.result = {12, 30, 1.5, true};
  facts.chosen_with.order = 3;
  cerberus::plugin::set_threshold_facts(frame, facts);

  records::on(frame, {kWidth, kHeight})->regions.write().mask =
      records::picture<guint8>({8, 6}, [](int, int) { return 255; });

  gst_buffer_add_video_region_of_interest_meta(frame, "motion", 1, 2, 3, 4);  // of another element

  const CerberusRegion region = walker();
  cerberus_buffer_add_region(frame, &region);
  return frame;
}

}  // namespace annotated
