// SPDX-License-Identifier: LGPL-2.1-or-later
#include "window_caps.hpp"

#include <algorithm>

namespace cerberus::plugin {

GstCaps* window_caps(const GstCaps* caps, GstPadDirection direction, const WindowSettings& settings) {
  GstCaps* others = gst_caps_copy(caps);
  for (guint i = 0; i < gst_caps_get_size(others); ++i) {
    GstStructure* structure = gst_caps_get_structure(others, i);
    const auto size = [&](const char* field, int fixed) {
      if (fixed > 0 && direction == GST_PAD_SINK)
        gst_structure_set(structure, field, G_TYPE_INT, fixed, nullptr);
      else
        gst_structure_set(structure, field, GST_TYPE_INT_RANGE, 1, G_MAXINT, nullptr);
    };
    size("width", settings.width);
    size("height", settings.height);
  }
  return others;
}

GstCaps* near_half(const GstCaps* picture, GstCaps* windows) {
  int width = 0, height = 0;
  const GstStructure* structure = gst_caps_get_structure(picture, 0);
  if (!gst_structure_get_int(structure, "width", &width) ||
      !gst_structure_get_int(structure, "height", &height))
    return windows;
  windows = gst_caps_make_writable(gst_caps_truncate(windows));
  GstStructure* window = gst_caps_get_structure(windows, 0);
  gst_structure_fixate_field_nearest_int(window, "width", std::max(1, width / 2));
  gst_structure_fixate_field_nearest_int(window, "height", std::max(1, height / 2));
  return windows;
}

}  // namespace cerberus::plugin
