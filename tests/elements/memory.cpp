// SPDX-License-Identifier: LGPL-2.1-or-later
// The budget: at most 24 bytes an analysis pixel a stream, planes included.
#include "../../plugins/vision/stages.hpp"

#include <set>

#include "scene.h"
#include "support.h"
#include "vision/camera_motion.h"

namespace {

using namespace cerberus;

GST_START_TEST(a_stream_needs_at_most_24_bytes_an_analysis_pixel) {
  static const struct {
    int width, height;
  } sizes[] = {{320, 240}, {640, 480}, {320, 180}};
  const bool labels = __i__ % 2;  // as with motionregions keep-planes=always
  scene::World world;
  world.width = sizes[__i__ / 2].width;
  world.height = sizes[__i__ / 2].height;
  world.pan = 1;
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, world.width, world.height);

  plugin::LumaStage luma;       // of cameramotion
  plugin::RegionStage regions;  // with all that comes before it
  vision::CameraMotion camera;
  luma.set_analysis_width(0);
  std::set<const GstMemory*> planes;
  std::size_t plane_bytes = 0;
  for (int k = 0; k < 60; ++k) {
    GstBuffer* buffer = scene::grey_buffer(world, k);
    plugin::Frame frame;
    frame.buffer = buffer;
    frame.info = &info;
    frame.number = k + 1;
    frame.fresh = k == 0;
    frame.seconds = k > 0 ? 0.04 : 0;
    {
      const MappedPlane picture = luma.make(frame);
      const vision::CameraMotionResult motion = camera.update(picture.view<std::uint8_t>());
      frame.motion = {motion.transform, motion.still};
    }
    fail_unless(regions.run(frame, labels));
    gpointer position = nullptr;
    while (GstMeta* meta =
               gst_buffer_iterate_meta_filtered(buffer, &position, CERBERUS_PLANE_META_API_TYPE)) {
      GstBuffer* plane = reinterpret_cast<CerberusPlaneMeta*>(meta)->buffer;
      if (planes.insert(gst_buffer_peek_memory(plane, 0)).second) plane_bytes += gst_buffer_get_size(plane);
    }
    cerberus_buffer_remove_plane_metas(buffer);
    gst_buffer_unref(buffer);
  }
  fail_unless_equals_int(planes.size(), labels ? 6 : 5);  // luma, two differences, histogram, mask
  const double pixels = static_cast<double>(world.width) * world.height;
  const double used = static_cast<double>(regions.bytes() + camera.bytes() + plane_bytes) / pixels;
  fail_unless(used > 10, "%.2f bytes an analysis pixel: somebody does not count", used);
  fail_unless(used <= 24, "%.2f bytes an analysis pixel at %d x %d", used, world.width, world.height);
  g_print("%d x %d%s: %.2f bytes an analysis pixel\n", world.width, world.height,
          labels ? ", labels kept" : "", used);
}
GST_END_TEST

Suite* memory_suite() {
  Suite* suite = suite_create("memory");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, a_stream_needs_at_most_24_bytes_an_analysis_pixel, 0, 6);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(memory);
