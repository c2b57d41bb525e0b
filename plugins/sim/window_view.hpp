// SPDX-License-Identifier: LGPL-2.1-or-later
// What virtualptz shows of a wide picture, frame by frame.
#pragma once

#include <gst/video/video.h>

#include <string>

#include "inset.hpp"
#include "vision/geometry/window.h"
#include "window_settings.hpp"

namespace cerberus::plugin {

class WindowView {
 public:
  using Place = vision::WindowGeometry::Place;

  WindowView();
  // A window of this size into a picture of that one. Returns what is wrong, for people; empty: nothing.
  std::string begin(const GstVideoInfo& picture, const GstVideoInfo& window, const WindowSettings& settings);
  // Other angles. Where something is wrong the old ones stay.
  std::string set_angles(const WindowSettings& settings);

  const GstVideoInfo& picture() const { return picture_; }
  const vision::WindowGeometry& geometry() const { return geometry_; }
  // False: a buffer does not hold the picture that its caps promise.
  bool draw(GstBuffer* picture, const Place& place, bool with_inset, GstBuffer* window);

 private:
  void draw_components(GstVideoFrame& picture, GstVideoFrame& window, const Place& place);

  GstVideoInfo picture_, window_;
  vision::WindowGeometry geometry_;
  vision::WindowResampler resampler_;
  Inset inset_;
};

}  // namespace cerberus::plugin
