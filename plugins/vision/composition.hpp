// SPDX-License-Identifier: LGPL-2.1-or-later
// From patches to GStreamer: attached as a composition, or blended into a frame.
#pragma once

#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

#include <memory>
#include <span>

#include "drawing.hpp"

namespace cerberus::draw {

struct CompositionDeleter {
  void operator()(GstVideoOverlayComposition* c) const { gst_video_overlay_composition_unref(c); }
};
using CompositionPtr = std::unique_ptr<GstVideoOverlayComposition, CompositionDeleter>;

// The patches as rectangles over those of `before` (may be null), which is not changed. Pixels are not copied.
CompositionPtr compose(std::span<const Patch> patches, const GstVideoOverlayComposition* before);

// Draws the patches into a frame mapped for reading and writing. False, and nothing drawn, for a format that is not
// one of CERBERUS_VIDEO_FORMATS: gst_video_overlay_composition_blend() knows all of them, at the price of converting
// every row that a rectangle touches over the frame's whole width (measured: six times slower on 768x576 I420).
bool blend(std::span<const Patch> patches, GstVideoFrame* frame);

}  // namespace cerberus::draw
