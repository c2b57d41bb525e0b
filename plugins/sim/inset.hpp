// SPDX-License-Identifier: LGPL-2.1-or-later
// A small picture in the upper right corner of a frame, attached as an overlay composition: of virtualptz the whole scene.
// The frame's own pixels do not change, because motion is detected in them; motionoverlay draws the composition, and so
// does any sink that draws compositions.
#pragma once

#include <gst/video/video.h>

#include <memory>

#include "overlay/inset.h"
#include "vision/geometry/window.h"

namespace cerberus::plugin {

// Attaches a picture of `size` to a frame that is `width` pixels wide. words: of GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB.
void attach_inset(GstBuffer* words, vision::Size size, int width, GstBuffer* frame);

class Inset {
 public:
  // Of frames of `scene`, for windows of `window`. Nothing is attached where there is no room for it.
  void begin(const GstVideoInfo& scene, const GstVideoInfo& window);
  // `geometry` and `place`: where the window lies in the scene.
  void attach(GstVideoFrame* scene, const vision::WindowGeometry& geometry,
              const vision::WindowGeometry::Place& place, GstBuffer* window);

 private:
  struct Free {
    void operator()(GstVideoConverter* c) const { gst_video_converter_free(c); }
  };
  using Converter = std::unique_ptr<GstVideoConverter, Free>;
  Converter scale_, color_;  // the scene's planes made small; then to the words of a composition
  GstVideoInfo small_, words_;
  vision::Size scene_, window_;
};

}  // namespace cerberus::plugin
