// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames as lib/ reads them, in every format and layout; planes from the pool.
// The C++ library comes first: gst-check defines a macro `fail`.
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../../plugins/shared/video.hpp"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/video/video.h>

#include "support.h"

namespace {

using cerberus::VideoFrame;
using cerberus::vision::LumaSource;

const int kSizes[][2] = {{32, 32}, {33, 35}, {1, 1}, {640, 3}};

std::uint8_t sample(int x, int y, int channel) {
  return static_cast<std::uint8_t>(31 * x + 57 * y + 101 * channel + 7);
}

// Fills a mapped frame with GStreamer's own packers, the oracle for where samples are: Y or R, G, B = channels 0..2.
void fill(GstVideoFrame* frame) {
  const GstVideoFormatInfo* format = frame->info.finfo;
  const int width = GST_VIDEO_FRAME_WIDTH(frame), height = GST_VIDEO_FRAME_HEIGHT(frame);
  const bool words = GST_VIDEO_FORMAT_INFO_DEPTH(format, 0) > 8;  // packed from 16 bits: any low byte
  std::vector<std::uint8_t> line(4 * (width + 8) * 2);
  std::vector<std::uint16_t> wide(4 * (width + 8));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      line[4 * x] = 255;
      for (int c = 0; c < 3; ++c) line[4 * x + 1 + c] = sample(x, y, c);
      wide[4 * x] = 65535;
      for (int c = 0; c < 3; ++c)
        wide[4 * x + 1 + c] = static_cast<std::uint16_t>(sample(x, y, c) << 8 | sample(y, x, 5));
    }
    const gpointer packed = words ? static_cast<gpointer>(wide.data()) : line.data();
    format->pack_func(format, GST_VIDEO_PACK_FLAG_NONE, packed, 0, frame->data, frame->info.stride,
                      GST_VIDEO_CHROMA_SITE_UNKNOWN, y, width);
  }
}

void assert_found(const LumaSource& source, int width, int height, bool rgb, const char* what) {
  fail_unless_equals_int(source.width, width);
  fail_unless_equals_int(source.height, height);
  fail_unless_equals_int(source.rgb, rgb);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* pixel = source.data + y * source.stride + x * source.pixel_stride;
      int luma = pixel[0];
      if (source.word_shift > 0)
        luma = (source.swapped ? pixel[0] << 8 | pixel[1] : pixel[1] << 8 | pixel[0]) >> source.word_shift;
      const bool good = rgb ? pixel[source.r] == sample(x, y, 0) && pixel[source.g] == sample(x, y, 1) &&
                                  pixel[source.b] == sample(x, y, 2)
                            : luma == sample(x, y, 0);
      fail_unless(good, "%s %dx%d: wrong at %d, %d", what, width, height, x, y);
    }
  }
}

const char* format_name(int i) {
  return kFormats[i];
}

}  // namespace

START_TEST(the_brightness_of_every_format_is_found) {
  const GstVideoFormat format = gst_video_format_from_string(format_name(_i));
  fail_unless(cerberus_video_format_is_supported(format));
  for (const auto& size : kSizes) {
    GstVideoInfo info;
    gst_video_info_set_format(&info, format, size[0], size[1]);
    g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
    VideoFrame writing(info, buffer, GST_MAP_READWRITE);
    fill(writing.get());
    writing.unmap();
    VideoFrame frame(info, buffer, GST_MAP_READ);
    fail_unless(static_cast<bool>(frame));
    assert_found(cerberus::luma_source(*frame.get()), size[0], size[1], GST_VIDEO_INFO_IS_RGB(&info),
                 format_name(_i));
  }
}
END_TEST

namespace {

// Red in the left half, blue in the right one: Y, Cb, Cr from 16 to 235 and 240, or R, G, B.
void fill_red_and_blue(GstVideoFrame* frame) {
  const GstVideoFormatInfo* format = frame->info.finfo;
  const int width = GST_VIDEO_FRAME_WIDTH(frame);
  const bool words = GST_VIDEO_FORMAT_INFO_DEPTH(format, 0) > 8, rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(format);
  const std::uint8_t colours[2][2][3] = {{{81, 90, 240}, {41, 240, 110}}, {{255, 0, 0}, {0, 0, 255}}};
  std::vector<std::uint8_t> line(4 * (width + 8));
  std::vector<std::uint16_t> wide(4 * (width + 8));
  for (int x = 0; x < width; ++x) {
    line[4 * x] = 255, wide[4 * x] = 65535;
    for (int c = 0; c < 3; ++c) {
      line[4 * x + 1 + c] = colours[rgb][x >= width / 2][c];
      wide[4 * x + 1 + c] = static_cast<std::uint16_t>(line[4 * x + 1 + c] << 8);
    }
  }
  for (int y = 0; y < GST_VIDEO_FRAME_HEIGHT(frame); ++y)
    format->pack_func(format, GST_VIDEO_PACK_FLAG_NONE,
                      words ? static_cast<gpointer>(wide.data()) : line.data(), 0, frame->data,
                      frame->info.stride, GST_VIDEO_CHROMA_SITE_UNKNOWN, y, width);
}

void assert_colour(const cerberus::vision::PersonPicture& picture, double across, bool red,
                   const char* what) {
  const auto at = [&](const cerberus::vision::GrayView& plane) {
    return plane.at(static_cast<int>(across * plane.width), plane.height / 2);
  };
  const auto rgb =
      cerberus::vision::rgb_of(at(picture.luma), at(picture.blue), at(picture.red), picture.planes);
  fail_unless((red ? rgb[0] : rgb[2]) > 245 && rgb[1] < 10 && (red ? rgb[2] : rgb[0]) < 10,
              "%s: %d, %d, %d at %g", what, rgb[0], rgb[1], rgb[2], across);
}

}  // namespace

START_TEST(the_colours_of_every_format_are_found) {
  const GstVideoFormat format = gst_video_format_from_string(format_name(_i));
  GstVideoInfo info;
  gst_video_info_set_format(&info, format, 66, 34);
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  VideoFrame writing(info, buffer, GST_MAP_READWRITE);
  fill_red_and_blue(writing.get());
  writing.unmap();
  VideoFrame frame(info, buffer, GST_MAP_READ);
  const auto source = cerberus::picture_source(*frame.get());
  cerberus::vision::PictureCopy copy;
  copy.take(source, 0, 0, {66, 34}, false);
  fail_unless(copy.view().planes == cerberus::vision::ColourPlanes::none && copy.view().luma.width == 66);
  copy.take(source, 0, 0, {66, 34}, true);
  if (GST_VIDEO_INFO_IS_GRAY(&info)) {
    fail_unless(copy.view().planes == cerberus::vision::ColourPlanes::none);
    return;
  }
  assert_colour(copy.view(), .2, true, format_name(_i));
  assert_colour(copy.view(), .8, false, format_name(_i));
  copy.take(source, 40, 5, {20, 25}, true);
  fail_unless(copy.view().luma.width == 20 && copy.view().luma.height == 25);
  for (const double across : {0., .5, .95}) assert_colour(copy.view(), across, false, format_name(_i));
}
END_TEST

START_TEST(the_colours_of_a_full_range_are_not_stretched) {
  using cerberus::vision::ColourPlanes;
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_I420, 8, 8);
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  VideoFrame video(info, buffer, GST_MAP_READ);
  fail_unless(cerberus::picture_source(*video.get()).planes == ColourPlanes::difference_video);
  video.unmap();
  info.colorimetry.range = GST_VIDEO_COLOR_RANGE_0_255;
  VideoFrame full(info, buffer, GST_MAP_READ);
  fail_unless(cerberus::picture_source(*full.get()).planes == ColourPlanes::difference_full);
  const auto red = cerberus::vision::rgb_of(76, 85, 255, ColourPlanes::difference_full);
  fail_unless(red[0] > 250 && red[1] < 4 && red[2] < 4);
}
END_TEST

// Strides far above the width, and borders around the picture, as video memory of cameras has them.
START_TEST(padding_around_the_picture_is_respected) {
  const GstVideoFormat format = gst_video_format_from_string(format_name(_i));
  GstVideoInfo info;
  gst_video_info_set_format(&info, format, 33, 35);
  GstVideoAlignment alignment;
  gst_video_alignment_reset(&alignment);
  alignment.padding_left = 16;
  alignment.padding_right = 200;
  alignment.padding_top = 4;
  alignment.padding_bottom = 6;
  GstVideoInfo padded = info;
  fail_unless(gst_video_info_align(&padded, &alignment));
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, padded.size, nullptr);
  gst_buffer_memset(buffer, 0, 0xAA, padded.size);
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, format, 33, 35,
                                 GST_VIDEO_INFO_N_PLANES(&padded), padded.offset, padded.stride);
  VideoFrame writing(info, buffer, GST_MAP_READWRITE);
  fill(writing.get());
  writing.unmap();
  VideoFrame frame(info, buffer, GST_MAP_READ);
  const LumaSource source = cerberus::luma_source(*frame.get());
  fail_unless(source.stride >= 33 + 200);
  assert_found(source, 33, 35, GST_VIDEO_INFO_IS_RGB(&info), format_name(_i));
}
END_TEST

// Bottom-up pictures (some Windows and DIB sources): the first row is the last in memory.
START_TEST(a_negative_stride_reads_upwards) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_BGRx, 8, 5);
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 8; ++x)
      for (int c = 0; c < 3; ++c) map.data[(4 - y) * 32 + 4 * x + 2 - c] = sample(x, y, c);
  gst_buffer_unmap(buffer, &map);
  gsize offset[GST_VIDEO_MAX_PLANES] = {4 * 32};
  gint stride[GST_VIDEO_MAX_PLANES] = {-32};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_BGRx, 8, 5, 1, offset,
                                 stride);
  VideoFrame frame(info, buffer, GST_MAP_READ);
  fail_unless(static_cast<bool>(frame));
  assert_found(cerberus::luma_source(*frame.get()), 8, 5, true, "bottom-up BGRx");
}
END_TEST

START_TEST(the_caps_name_exactly_the_supported_formats) {
  g_autoptr(GstCaps) caps = gst_caps_from_string(CERBERUS_VIDEO_CAPS);
  const GValue* formats = gst_structure_get_value(gst_caps_get_structure(caps, 0), "format");
  int listed = 0, supported = 0;
  guint known = 0;
  const GstVideoFormat* all = gst_video_formats_raw(&known);
  for (guint f = 0; f < known; ++f) {
    const GstVideoFormat format = all[f];
    bool in_list = false;
    for (guint i = 0; i < gst_value_list_get_size(formats); ++i)
      in_list |= g_str_equal(g_value_get_string(gst_value_list_get_value(formats, i)),
                             gst_video_format_to_string(format));
    fail_unless_equals_int(in_list, cerberus_video_format_is_supported(format));
    listed += in_list;
    supported += cerberus_video_format_is_supported(format);
    if (f > 1000) break;
  }
  fail_unless_equals_int(listed, G_N_ELEMENTS(kFormats));
  fail_unless_equals_int(gst_value_list_get_size(formats), G_N_ELEMENTS(kFormats));
}
END_TEST

START_TEST(a_truncated_frame_is_refused) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_I420, 64, 48);
  for (const gsize bytes : {gsize{0}, gsize{1}, info.size - 1}) {
    g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, bytes, nullptr);
    VideoFrame frame(info, buffer, GST_MAP_READ);
    fail_if(static_cast<bool>(frame));
  }
}
END_TEST

// A video meta that lies about where the samples are, or about what they are: refused, and no critical either.
START_TEST(a_frame_outside_its_memory_is_refused) {
  struct {
    GstVideoFormat format;
    guint width, height;
    gsize offset;
    gint stride;
    bool good;
  } const cases[] = {
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 0, 64, true},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 0, 65, false},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 1, 64, false},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 47 * 64, -64, true},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 0, -64, false},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 46 * 64, -64, false},
      {GST_VIDEO_FORMAT_GRAY8, 64, 48, 48 * 64, 64, false},
      {GST_VIDEO_FORMAT_GRAY8, 32, 48, 0, 64, false},
      {GST_VIDEO_FORMAT_GRAY8, 64, 47, 0, 64, false},
      {GST_VIDEO_FORMAT_GRAY16_LE, 64, 48, 0, 64, false},
  };
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, 64, 48);
  for (const auto& c : cases) {
    g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, 64 * 48, nullptr);
    gsize offset[GST_VIDEO_MAX_PLANES] = {c.offset};
    gint stride[GST_VIDEO_MAX_PLANES] = {c.stride};
    gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, c.format, c.width, c.height, 1, offset,
                                   stride);
    VideoFrame frame(info, buffer, GST_MAP_READ);
    fail_unless_equals_int(static_cast<bool>(frame), c.good);
  }
}
END_TEST

// A reference held by the mapping would make the buffer unwritable: an element maps and annotates the same buffer.
START_TEST(a_mapped_frame_can_still_be_annotated) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_GRAY8, 64, 48);
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  VideoFrame frame(info, buffer, GST_MAP_READ);
  fail_unless(cerberus_buffer_set_regions(buffer, nullptr));
}
END_TEST

static Suite* frames_suite(void) {
  watch_library_log();
  Suite* s = suite_create("frames");
  TCase* tc = tcase_create("video");
  suite_add_tcase(s, tc);
  tcase_add_loop_test(tc, the_brightness_of_every_format_is_found, 0, G_N_ELEMENTS(kFormats));
  tcase_add_loop_test(tc, the_colours_of_every_format_are_found, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tc, the_colours_of_a_full_range_are_not_stretched);
  tcase_add_loop_test(tc, padding_around_the_picture_is_respected, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tc, a_negative_stride_reads_upwards);
  tcase_add_test(tc, the_caps_name_exactly_the_supported_formats);
  tcase_add_test(tc, a_truncated_frame_is_refused);
  tcase_add_test(tc, a_frame_outside_its_memory_is_refused);
  tcase_add_test(tc, a_mapped_frame_can_still_be_annotated);
  tc = tcase_create("planes");
  suite_add_tcase(s, tc);
  return s;
}

GST_CHECK_MAIN(frames)
