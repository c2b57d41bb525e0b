// SPDX-License-Identifier: LGPL-2.1-or-later
// Draws virtualptz's window over a wide picture, frame by frame.
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
  // A window of this size into a picture of that one. Returns an error text for the user; empty: none.
  std::string begin(const GstVideoInfo& picture, const GstVideoInfo& window, const WindowSettings& settings);
  // Sets other angles. On an error the old ones stay in force.
  std::string set_angles(const WindowSettings& settings);

  // The window sees so much from now on, as far as the picture reaches (radians over its width; 0: as the settings say).
  void look_through(double field_of_view);

  const GstVideoInfo& picture() const { return picture_; }
  const vision::WindowGeometry& geometry() const { return geometry_; }
  // Returns false if a buffer does not hold the picture of its caps.
  bool draw(GstBuffer* picture, const Place& place, bool with_inset, GstBuffer* window);

 private:
  void draw_components(GstVideoFrame& picture, GstVideoFrame& window, const Place& place);

  GstVideoInfo picture_, window_;
  vision::WindowGeometry geometry_, unzoomed_;
  double wide_fov_ = 0, zoom_ = 0;  // radians
  vision::WindowResampler resampler_;
  Inset inset_;
};

}  // namespace cerberus::plugin
