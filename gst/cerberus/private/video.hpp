// SPDX-License-Identifier: LGPL-2.1-or-later
// From GStreamer's video frames to what lib/ reads.
#pragma once

#include <gst/video/video.h>

#include "vision/luma.h"

namespace cerberus {

// A mapped frame, unmapped at the end of its life. False where the buffer cannot be mapped or is too small
// for its caps (truncated files).
class VideoFrame {
 public:
  VideoFrame(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags flags) {
    // NO_REF: the caller holds the buffer longer than we do, and a reference would make it unwritable
    // meanwhile.
    mapped_ = gst_video_frame_map(
        &frame_, &info, buffer, static_cast<GstMapFlags>(int{flags} | int{GST_VIDEO_FRAME_MAP_FLAG_NO_REF}));
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
  GstVideoFrame frame_;
  bool mapped_ = false;
};

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
    source.data = GST_VIDEO_FRAME_COMP_DATA(&frame, GST_VIDEO_COMP_Y);
  }
  return source;
}

}  // namespace cerberus
