// SPDX-License-Identifier: LGPL-2.1-or-later
#include "composition.hpp"

#include "shared/video.hpp"

namespace cerberus::plugin {

FrameComponents::FrameComponents(GstVideoFrame* frame) {
  const GstVideoFormatInfo* format = frame->info.finfo;
  gint offset[GST_VIDEO_MAX_COMPONENTS], scale[GST_VIDEO_MAX_COMPONENTS];
  gst_video_color_range_offsets(frame->info.colorimetry.range, format, offset, scale);
  double kr = 0.299, kb = 0.114;
  if (!gst_video_color_matrix_get_Kr_Kb(frame->info.colorimetry.matrix, &kr, &kb)) kr = 0.299, kb = 0.114;
  const double luma[3] = {kr, 1 - kr - kb, kb};
  count_ = GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format);
  const int n = static_cast<int>(count_);
  for (int i = 0; i < n; ++i) {
    double weights[3] = {0, 0, 0};
    const bool alpha = i == GST_VIDEO_COMP_A;
    if (!alpha && GST_VIDEO_FORMAT_INFO_IS_RGB(format)) {
      weights[i] = 1;
    } else if (!alpha) {
      // Cb = (B - Y) / (2 (1 - Kb)), Cr likewise.
      const int own = i == GST_VIDEO_COMP_U ? 2 : 0;
      for (int j = 0; j < 3; ++j)
        weights[j] = i == GST_VIDEO_COMP_Y ? luma[j] : ((j == own) - luma[j]) / (2 * (1 - luma[own]));
    }
    auto& c = all_[i];
    c.data = cerberus::component_data(frame, i);
    c.pixel =
        static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(frame, GST_VIDEO_FORMAT_INFO_PLANE(format, i)));
    c.stride = GST_VIDEO_FRAME_COMP_STRIDE(frame, i);
    c.step = GST_VIDEO_FRAME_COMP_PSTRIDE(frame, i);
    c.shift_x = GST_VIDEO_FORMAT_INFO_W_SUB(format, i);
    c.shift_y = GST_VIDEO_FORMAT_INFO_H_SUB(format, i);
    c.red = weights[0] * scale[i] / 255, c.green = weights[1] * scale[i] / 255,
    c.blue = weights[2] * scale[i] / 255;
    c.offset = alpha ? 255 : offset[i];
    c.bits = GST_VIDEO_FORMAT_INFO_DEPTH(format, i);
    c.word_shift = GST_VIDEO_FORMAT_INFO_SHIFT(format, i);
    c.swapped = c.bits > 8 && cerberus::is_swapped(format);
  }
}

namespace {

GstVideoOverlayRectangle* rectangle_of(const overlay::Patch& patch) {
  // The buffer holds the picture: no copy.
  using Holder = std::shared_ptr<const overlay::Picture>;
  const overlay::Picture& picture = *patch.pixels;
  const gsize size = sizeof(std::uint32_t) * static_cast<gsize>(picture.stride()) * picture.height;
  GstBuffer* pixels = gst_buffer_new_wrapped_full(
      GST_MEMORY_FLAG_READONLY, const_cast<std::uint32_t*>(picture.words.data()), size, 0, size,
      new Holder(patch.pixels), [](gpointer data) { delete static_cast<Holder*>(data); });
  gst_buffer_add_video_meta(pixels, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB,
                            static_cast<guint>(picture.width), static_cast<guint>(picture.height));
  GstVideoOverlayRectangle* rectangle = gst_video_overlay_rectangle_new_raw(
      pixels, patch.area.x, patch.area.y, static_cast<guint>(patch.area.width),
      static_cast<guint>(patch.area.height), GST_VIDEO_OVERLAY_FORMAT_FLAG_PREMULTIPLIED_ALPHA);
  gst_buffer_unref(pixels);
  return rectangle;
}

}  // namespace

CompositionPtr Composer::compose(std::span<const overlay::Patch> patches,
                                 const GstVideoOverlayComposition* before) {
  CompositionPtr composition(gst_video_overlay_composition_new(nullptr));
  std::swap(last_, next_);
  next_.clear();
  std::size_t at = 0;  // patches keep their order: the search for one goes on behind the one before
  for (const overlay::Patch& patch : patches) {
    RectanglePtr rectangle;
    for (std::size_t i = at; i < last_.size() && !rectangle; ++i)
      if (last_[i].rectangle && last_[i].patch.pixels == patch.pixels && last_[i].patch.area == patch.area) {
        rectangle = std::move(last_[i].rectangle);
        at = i + 1;
      }
    if (!rectangle) rectangle.reset(rectangle_of(patch));
    gst_video_overlay_composition_add_rectangle(composition.get(), rectangle.get());
    next_.push_back({patch, std::move(rectangle)});
  }
  auto* others = const_cast<GstVideoOverlayComposition*>(before);
  for (guint i = 0; others && i < gst_video_overlay_composition_n_rectangles(others); ++i)
    gst_video_overlay_composition_add_rectangle(composition.get(),
                                                gst_video_overlay_composition_get_rectangle(others, i));
  return composition;
}

void blend(std::span<const overlay::Patch> patches, GstVideoFrame* frame) {
  const FrameComponents components(frame);
  for (const overlay::Patch& patch : patches)
    overlay::blend(patch.pixels->view(), patch.area.x, patch.area.y, components.all());
}

}  // namespace cerberus::plugin
