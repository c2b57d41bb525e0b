// SPDX-License-Identifier: LGPL-2.1-or-later
// A crop that is not carried out but written on the frame (GstVideoCropMeta), because a sink downstream offers to crop:
// every element that reads or draws pixels gives what it gives where `videocrop` copies.
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

#include <gst/video/gstvideometa.h>

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

constexpr const char* kCropped[] = {"GRAY8", "I420", "NV12", "Y41B",      "Y42B", "YUY2",
                                    "UYVY",  "RGB",  "BGRx", "GRAY16_LE", "Y444", "I420_10BE"};
constexpr int kCroppedCount = G_N_ELEMENTS(kCropped);
constexpr int kTop = 21;  // odd, as far as possible: a sample of chroma stands for two pixels

// Whole groups of pixels that are packed together: between them `videocrop` moves luma alone, which needs a copy.
int left_of(const std::string& format) {
  return format == "YUY2" || format == "UYVY" ? 38 : 37;
}

// The elements behind a `videocrop`, in front of a sink that crops or of one that does not.
struct Cropping {
  Line line;
  Cropping(const std::string& elements, const char* format, bool offered)
      : line("videocrop left=" + std::to_string(left_of(format)) + " top=" + std::to_string(kTop) +
                 " right=6 ! " + elements,
             "") {
    if (offered) {
      gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_META_API_TYPE, nullptr);
      gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_CROP_META_API_TYPE, nullptr);
    }
    gst_harness_set_src_caps_str(line.harness, scene::caps(format, scene::kWidth, scene::kHeight).c_str());
  }
  GstBuffer* through(const char* format, int frame) {
    return line.through(
        scene::buffer(format, scene::kWidth, scene::kHeight, World{}.picture(frame), frame * scene::kStep));
  }
};

// All samples of the picture that the caps promise, of a buffer that may be cropped by meta.
std::vector<int> samples(GstHarness* harness, GstBuffer* buffer) {
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(harness->sinkpad);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  const GstVideoCropMeta* crop = gst_buffer_get_video_crop_meta(buffer);
  const int left = crop ? static_cast<int>(crop->x) : 0, top = crop ? static_cast<int>(crop->y) : 0;
  const int width = GST_VIDEO_INFO_WIDTH(&info), height = GST_VIDEO_INFO_HEIGHT(&info);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  std::vector<int> all;
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&frame); ++c) {
    const int sx = GST_VIDEO_FORMAT_INFO_W_SUB(info.finfo, c),
              sy = GST_VIDEO_FORMAT_INFO_H_SUB(info.finfo, c);
    for (int y = 0; y < height >> sy; ++y)
      for (int x = 0; x < width >> sx; ++x)
        all.push_back(sample_at(&frame, c, (left >> sx) + x, (top >> sy) + y));
  }
  gst_video_frame_unmap(&frame);
  return all;
}

// The same frames through both. `stays`: the crop meta is on what comes out, too.
void assert_same(const std::string& elements, const char* format, bool stays) {
  Cropping copied(elements, format, false), offered(elements, format, true);
  std::string found;
  for (int k = 0; k < 20; ++k) {
    GstBuffer* should = copied.through(format, k);
    GstBuffer* is = offered.through(format, k);
    fail_unless_equals_int(gst_buffer_get_video_crop_meta(is) != nullptr, stays);
    fail_if(gst_buffer_get_video_crop_meta(should));
    const std::string regions = Regions(is).text(), expected = Regions(should).text();
    ck_assert_str_eq(regions.c_str(), expected.c_str());
    fail_unless(samples(offered.line.harness, is) == samples(copied.line.harness, should), "%s, %s, frame %d",
                elements.c_str(), format, k);
    found += expected;
    gst_buffer_unref(should);
    gst_buffer_unref(is);
  }
  fail_unless(!found.empty() || elements.find("motiondetect") == std::string::npos,
              "nothing was found at all");
  fail_unless(offered.line.messages(GST_MESSAGE_WARNING).empty());
}

GST_START_TEST(regions_are_those_of_the_cropped_picture) {
  assert_same("motiondetect confirm-time=0", kCropped[__i__], true);
}
GST_END_TEST

GST_START_TEST(boxes_are_drawn_on_the_cropped_picture) {
  assert_same("motiondetect confirm-time=0 ! motionoverlay", kCropped[__i__], true);
}
GST_END_TEST

GST_START_TEST(a_view_of_a_cropped_picture_is_whole) {
  assert_same("motionview stage=luma", kCropped[__i__], false);
}
GST_END_TEST

GST_START_TEST(a_window_moves_over_the_cropped_picture) {
  if (__i__ < kCroppedCount &&
      GST_VIDEO_FORMAT_INFO_DEPTH(gst_video_format_get_info(gst_video_format_from_string(kCropped[__i__])),
                                  0) == 8)
    assert_same("virtualptz lockstep=off width=160 height=120", kCropped[__i__], false);
}
GST_END_TEST

// A crop in place behind the detector changes no memory and calls no transform function. What was found is of another
// picture then, as behind a crop that copies.
GST_START_TEST(a_crop_in_place_behind_the_detector_makes_its_result_unknown) {
  const bool offered = __i__ == 0;
  Line line("motiondetect confirm-time=0 ! videocrop left=100", "");
  if (offered) {
    gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_META_API_TYPE, nullptr);
    gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_CROP_META_API_TYPE, nullptr);
  }
  gst_harness_set_src_caps_str(line.harness, scene::caps("I420", scene::kWidth, scene::kHeight).c_str());
  for (int k = 0; k < 12; ++k) {
    GstBuffer* out = line.through(
        scene::buffer("I420", scene::kWidth, scene::kHeight, World{}.picture(k), k * scene::kStep));
    fail_unless_equals_int(gst_buffer_get_video_crop_meta(out) != nullptr, offered);
    fail_if(cerberus_buffer_regions_known(out));
    fail_unless_equals_int(Regions(out).size(), 0);
    fail_if(cerberus_buffer_peek_camera_motion(out));
    // A copy has the crop before the rest, or behind it: it knows no more.
    GstBuffer* copy = gst_buffer_copy(out);
    fail_if(cerberus_buffer_regions_known(copy));
    fail_if(cerberus_buffer_peek_camera_motion(copy));
    gst_buffer_unref(copy);
    // What is found afterwards is of the visible picture, and alone on the buffer.
    CerberusRegion region;
    cerberus_region_init(&region);
    region.x = 3, region.width = region.height = 20;
    fail_unless(cerberus_buffer_add_region(out, &region));
    fail_unless(cerberus_buffer_regions_known(out));
    fail_unless_equals_int(Regions(out).size(), 1);
    copy = gst_buffer_copy(out);
    fail_unless_equals_int(Regions(copy).size(), 1);
    gst_buffer_unref(copy);
    // So is a fact about the picture, also where one of the whole picture was there before.
    CerberusCameraMotion motion;
    cerberus_camera_motion_init(&motion);
    fail_unless(cerberus_buffer_set_camera_motion(out, &motion));
    copy = gst_buffer_copy(out);
    fail_unless(cerberus_buffer_peek_camera_motion(copy));
    gst_buffer_unref(copy);
    gst_buffer_unref(out);
  }
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// The stages behind the crop begin anew, on the visible picture.
GST_START_TEST(stages_behind_a_crop_in_place_see_the_visible_picture) {
  std::string found[2];
  for (const bool offered : {false, true}) {
    Line line("cameramotion ! videocrop left=100 ! motiontrack confirm-time=0", "");
    if (offered) {
      gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_META_API_TYPE, nullptr);
      gst_harness_add_propose_allocation_meta(line.harness, GST_VIDEO_CROP_META_API_TYPE, nullptr);
    }
    gst_harness_set_src_caps_str(line.harness, scene::caps("I420", scene::kWidth, scene::kHeight).c_str());
    World world;
    world.start = 110;
    for (int k = 0; k < 20; ++k) {
      GstBuffer* out = line.through(
          scene::buffer("I420", scene::kWidth, scene::kHeight, world.picture(k), k * scene::kStep));
      found[offered] += Regions(out).text() + "\n";
      gst_buffer_unref(out);
    }
  }
  fail_unless(found[0].find('|') != std::string::npos);
  ck_assert_str_eq(found[1].c_str(), found[0].c_str());
}
GST_END_TEST

// A crop that reaches beyond the memory, or is smaller than the caps: an unusable buffer, never a read outside.
GST_START_TEST(a_crop_that_does_not_fit_is_an_unusable_buffer) {
  const struct {
    guint x, y, width, height;
    bool good;
  } crops[] = {{0, 0, 320, 240, true},
               {8, 8, 312, 232, false},
               {1, 0, 320, 240, false},
               {0, 1, 320, 240, false},
               {0, 0, 319, 240, false},
               {G_MAXUINT, 0, 320, 240, false},
               {0, G_MAXUINT - 100, 320, 240, false}};
  for (const auto& crop : crops) {
    Line line("motiondetect ! identity");
    GstBuffer* in = scene::grey_buffer(World{}, 0);
    GstVideoCropMeta* meta = gst_buffer_add_video_crop_meta(in);
    meta->x = crop.x, meta->y = crop.y, meta->width = crop.width, meta->height = crop.height;
    GstBuffer* out = line.through(in);
    fail_unless_equals_int(!GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED), crop.good);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

Suite* crop_suite() {
  Suite* suite = suite_create("crop");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, regions_are_those_of_the_cropped_picture, 0, kCroppedCount);
  tcase_add_loop_test(tests, boxes_are_drawn_on_the_cropped_picture, 0, kCroppedCount);
  tcase_add_loop_test(tests, a_view_of_a_cropped_picture_is_whole, 0, kCroppedCount);
  tcase_add_loop_test(tests, a_window_moves_over_the_cropped_picture, 0, kCroppedCount);
  tcase_add_loop_test(tests, a_crop_in_place_behind_the_detector_makes_its_result_unknown, 0, 2);
  tcase_add_test(tests, stages_behind_a_crop_in_place_see_the_visible_picture);
  tcase_add_test(tests, a_crop_that_does_not_fit_is_an_unusable_buffer);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(crop);
