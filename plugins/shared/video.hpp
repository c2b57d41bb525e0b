// SPDX-License-Identifier: LGPL-2.1-or-later
// From GStreamer's video frames to what lib/ reads.
#pragma once

#include <gst/video/video.h>

#include <algorithm>
#include <cstdlib>

#include "vision/image/luma/luma.h"
#include "vision/persons/person_picture.h"

namespace cerberus {

// The error text when gst_video_info_from_caps() fails.
constexpr char kCapsIncomplete[] =
    "The video's caps are incomplete: they need a format, a width and a height.";

// Bytes that hold one sample of a component: 1, or 2 for more than 8 bits.
inline int sample_bytes(const GstVideoFormatInfo* format, guint component) {
  const auto bits =
      GST_VIDEO_FORMAT_INFO_DEPTH(format, component) + GST_VIDEO_FORMAT_INFO_SHIFT(format, component);
  return GST_VIDEO_FORMAT_INFO_DEPTH(format, component) > 8 ? static_cast<int>(bits + 7) / 8 : 1;
}

// First sample of a component. GStreamer 1.22 gives V of P010 and its kin an offset of one byte, not two.
inline guint8* component_data(const GstVideoFrame* frame, guint component) {
  const int offset = GST_VIDEO_FRAME_COMP_POFFSET(frame, component);
  return static_cast<guint8*>(GST_VIDEO_FRAME_COMP_DATA(frame, component)) +
         (sample_bytes(frame->info.finfo, component) == 2 ? offset % 2 : 0);
}

// A mapped frame, unmapped at the end of its life. False where the buffer cannot be mapped or is too small
// for its caps (truncated files). If a GstVideoCropMeta declares a part of the memory as the picture, as `videocrop`
// does for sinks that crop themselves, that part is the frame.
class VideoFrame {
 public:
  VideoFrame(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags flags) {
    // NO_REF: the caller holds the buffer longer than we do, and a reference would make it unwritable
    // meanwhile.
    const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
    if (meta && !describes(*meta, info)) return;
    mapped_ = gst_video_frame_map(
        &frame_, &info, buffer, static_cast<GstMapFlags>(int{flags} | int{GST_VIDEO_FRAME_MAP_FLAG_NO_REF}));
    if (!mapped_) return;
    const GstVideoCropMeta* crop = gst_buffer_get_video_crop_meta(buffer);
    const bool whole = !crop || move_to(*crop, info);
    GST_VIDEO_INFO_WIDTH(&frame_.info) = GST_VIDEO_INFO_WIDTH(&info);
    GST_VIDEO_INFO_HEIGHT(&frame_.info) = GST_VIDEO_INFO_HEIGHT(&info);
    if (!whole || !fits()) unmap();
  }
  ~VideoFrame() { unmap(); }
  VideoFrame(const VideoFrame&) = delete;
  VideoFrame& operator=(const VideoFrame&) = delete;

  explicit operator bool() const { return mapped_; }
  GstVideoFrame* get() { return &frame_; }
  const GstVideoFrame* get() const { return &frame_; }
  void unmap() {
    if (mapped_) gst_video_frame_unmap(&frame_);
    mapped_ = false;
  }

 private:
  // gst_video_frame_map() answers a video meta of another format or a smaller size with a critical, which ends
  // programs that make criticals fatal. A larger size is a decoder's: the picture is the top left part of it.
  static bool describes(const GstVideoMeta& meta, const GstVideoInfo& info) {
    return meta.format == GST_VIDEO_INFO_FORMAT(&info) && meta.n_planes == GST_VIDEO_INFO_N_PLANES(&info) &&
           meta.width >= static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)) &&
           meta.height >= static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info));
  }
  // The first sample of every plane becomes that of the crop, rounded down to whole chroma samples and groups of
  // packed ones, as `videocrop` does where it copies. False where the crop lies outside the frame in memory, or is
  // smaller than the caps.
  bool move_to(const GstVideoCropMeta& crop, const GstVideoInfo& info) {
    const GstVideoFormatInfo* format = info.finfo;
    const auto within = [](guint from, guint length, gint needed, gint all) {
      return length >= static_cast<guint>(needed) && guint64{from} + length <= static_cast<guint64>(all);
    };
    if (!within(crop.x, crop.width, GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_WIDTH(&frame_.info)) ||
        !within(crop.y, crop.height, GST_VIDEO_INFO_HEIGHT(&info), GST_VIDEO_INFO_HEIGHT(&frame_.info)))
      return false;
    for (guint p = 0; p < GST_VIDEO_FRAME_N_PLANES(&frame_); ++p) {
      gint c[GST_VIDEO_MAX_COMPONENTS];  // of the plane, ended by -1
      gst_video_format_info_component(format, p, c);
      guint x = crop.x;
      for (const gint* each = c; each != c + GST_VIDEO_MAX_COMPONENTS && *each >= 0; ++each)
        x = x >> GST_VIDEO_FORMAT_INFO_W_SUB(format, *each) << GST_VIDEO_FORMAT_INFO_W_SUB(format, *each);
      const auto first = static_cast<guint>(c[0]);
      auto* data = static_cast<guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&frame_, p));
      data += gssize{static_cast<gint>(crop.y >> GST_VIDEO_FORMAT_INFO_H_SUB(format, first))} *
              GST_VIDEO_FRAME_PLANE_STRIDE(&frame_, p);
      data += gssize{static_cast<gint>(x >> GST_VIDEO_FORMAT_INFO_W_SUB(format, first))} *
              GST_VIDEO_FRAME_COMP_PSTRIDE(&frame_, first);
      frame_.data[p] = data;
    }
    return true;
  }
  // It never compares the strides and offsets of a meta with the memory behind them: every sample of every
  // component must lie inside.
  bool fits() const {
    for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&frame_); ++c) {
      const GstMapInfo& map = frame_.map[frame_.meta ? GST_VIDEO_FRAME_COMP_PLANE(&frame_, c) : 0];
      const gint64 rows = GST_VIDEO_FRAME_COMP_HEIGHT(&frame_, c);
      const gint64 row =
          gint64{GST_VIDEO_FRAME_COMP_WIDTH(&frame_, c) - 1} * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame_, c) +
          sample_bytes(frame_.info.finfo, c);
      const gint64 last = (rows - 1) * GST_VIDEO_FRAME_COMP_STRIDE(&frame_, c);  // negative: bottom-up
      const gint64 first = component_data(&frame_, c) - map.data;
      if (rows > 1 && std::abs(last) < (rows - 1) * row) return false;  // rows that lie over one another
      if (first + std::min<gint64>(0, last) < 0) return false;
      if (first + std::max<gint64>(0, last) + row > static_cast<gint64>(map.size)) return false;
    }
    return true;
  }

  GstVideoFrame frame_;
  bool mapped_ = false;
};

// Whether samples of 16 bits have the other byte order than this machine.
inline bool is_swapped(const GstVideoFormatInfo* format) {
  return GST_VIDEO_FORMAT_INFO_IS_LE(format) != (G_BYTE_ORDER == G_LITTLE_ENDIAN);
}

// Where the brightness of a mapped frame is: any of CERBERUS_VIDEO_FORMATS, any stride (also negative).
inline vision::LumaSource luma_source(const GstVideoFrame& frame) {
  vision::LumaSource source;
  source.width = GST_VIDEO_FRAME_WIDTH(&frame);
  source.height = GST_VIDEO_FRAME_HEIGHT(&frame);
  source.stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0);
  source.pixel_stride = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0);
  source.rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(frame.info.finfo);
  if (source.rgb) {
    source.data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
    source.r = GST_VIDEO_FRAME_COMP_POFFSET(&frame, GST_VIDEO_COMP_R);
    source.g = GST_VIDEO_FRAME_COMP_POFFSET(&frame, GST_VIDEO_COMP_G);
    source.b = GST_VIDEO_FRAME_COMP_POFFSET(&frame, GST_VIDEO_COMP_B);
  } else {
    const GstVideoFormatInfo* format = frame.info.finfo;
    source.data = GST_VIDEO_FRAME_COMP_DATA(&frame, GST_VIDEO_COMP_Y);
    if (sample_bytes(format, GST_VIDEO_COMP_Y) == 2) {
      source.word_shift = GST_VIDEO_FORMAT_INFO_SHIFT(format, GST_VIDEO_COMP_Y) +
                          GST_VIDEO_FORMAT_INFO_DEPTH(format, GST_VIDEO_COMP_Y) - 8;
      source.swapped = is_swapped(format);
    }
  }
  return source;
}

// The same with the colours, where the frame has any.
inline vision::PictureSource picture_source(const GstVideoFrame& frame) {
  vision::PictureSource source;
  source.luma = luma_source(frame);
  const GstVideoFormatInfo* format = frame.info.finfo;
  if (GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format) < 3) return source;
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(format);
  const auto plane = [&](guint component) {
    vision::LumaSource found = source.luma;
    found.rgb = false;
    found.data = component_data(&frame, component);
    found.width = GST_VIDEO_FRAME_COMP_WIDTH(&frame, component);
    found.height = GST_VIDEO_FRAME_COMP_HEIGHT(&frame, component);
    found.stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame, component);
    found.pixel_stride = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component);
    return found;
  };
  source.blue = plane(rgb ? GST_VIDEO_COMP_B : GST_VIDEO_COMP_U);
  source.red = plane(rgb ? GST_VIDEO_COMP_R : GST_VIDEO_COMP_V);
  source.planes = rgb ? vision::ColourPlanes::blue_red
                  : frame.info.colorimetry.range == GST_VIDEO_COLOR_RANGE_0_255
                      ? vision::ColourPlanes::difference_full
                      : vision::ColourPlanes::difference_video;
  return source;
}

}  // namespace cerberus
