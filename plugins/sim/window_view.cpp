// SPDX-License-Identifier: LGPL-2.1-or-later
#include "window_view.hpp"

#include <cerberus/cerberus.h>

#include "sensing/angles.h"
#include "shared/video.hpp"
#include "vision/geometry/window_misfit.h"

namespace cerberus::plugin {

using sensing::radians;
using vision::Samples;

namespace {

vision::Size size_of(const GstVideoInfo& info) {
  return {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
}

Samples<guint8> samples(GstVideoFrame& frame, guint component, bool pixels) {
  const guint plane = GST_VIDEO_FRAME_COMP_PLANE(&frame, component);
  const int step = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component);
  // Bytes that lie together are drawn together: whole RGB pixels, pairs of U and V.
  auto* data = static_cast<guint8*>(pixels ? GST_VIDEO_FRAME_PLANE_DATA(&frame, plane)
                                           : GST_VIDEO_FRAME_COMP_DATA(&frame, component));
  return {data,
          GST_VIDEO_FRAME_COMP_WIDTH(&frame, component),
          GST_VIDEO_FRAME_COMP_HEIGHT(&frame, component),
          GST_VIDEO_FRAME_COMP_STRIDE(&frame, component),
          step,
          pixels ? step : 1};
}

}  // namespace

WindowView::WindowView() {
  gst_video_info_init(&picture_);
  gst_video_info_init(&window_);
}

std::string WindowView::begin(const GstVideoInfo& picture, const GstVideoInfo& window,
                              const WindowSettings& settings) {
  picture_ = picture;
  window_ = window;
  if (std::string wrong = set_angles(settings); !wrong.empty()) return wrong;
  inset_.begin(picture, window);
  return {};
}

std::string WindowView::set_angles(const WindowSettings& s) {
  const vision::WindowGeometry geometry(radians(s.wide_fov), size_of(picture_), size_of(window_),
                                        radians(s.horizontal_fov));
  if (!geometry.fits())
    return vision::window_misfit(size_of(picture_), s.wide_fov, size_of(window_), s.horizontal_fov);
  geometry_ = unzoomed_ = geometry;
  wide_fov_ = radians(s.wide_fov);
  zoom_ = 0;
  return {};
}

void WindowView::look_through(double field_of_view) {
  if (!(field_of_view > 0)) field_of_view = 0;  // a zoom of which nothing is known, too
  if (field_of_view == zoom_) return;
  zoom_ = field_of_view;
  const vision::WindowGeometry zoomed(wide_fov_, size_of(picture_), size_of(window_), field_of_view);
  geometry_ = zoom_ > 0 && zoomed.fits() ? zoomed : unzoomed_;
}

bool WindowView::draw(GstBuffer* picture, const Place& place, bool with_inset, GstBuffer* window) {
  VideoFrame source(picture_, picture, GST_MAP_READ), target(window_, window, GST_MAP_WRITE);
  if (!source || !target) return false;
  draw_components(*source.get(), *target.get(), place);
  if (with_inset) inset_.attach(source.get(), geometry_, place, window);
  return true;
}

void WindowView::draw_components(GstVideoFrame& picture, GstVideoFrame& window, const Place& place) {
  const GstVideoFormatInfo* format = picture.info.finfo;
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(format);
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&picture); ++c) {
    // U and V in one plane of their own, as NV12 has them.
    const bool pair = c > 0 && GST_VIDEO_FRAME_N_PLANES(&picture) == 2;
    if (c > 0 && (rgb || (pair && c > 1))) break;
    const auto from = samples(picture, c, rgb || pair);
    const double sub_x = 1 << GST_VIDEO_FORMAT_INFO_W_SUB(format, c),
                 sub_y = 1 << GST_VIDEO_FORMAT_INFO_H_SUB(format, c);
    resampler_.draw({from.data, from.width, from.height, from.stride, from.step, from.channels},
                    samples(window, c, rgb || pair),
                    {place.left / sub_x, place.top / sub_y, geometry_.scale(), geometry_.scale()});
  }
}

}  // namespace cerberus::plugin
