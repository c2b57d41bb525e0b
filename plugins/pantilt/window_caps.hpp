// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames a window over a picture can give, and which pictures can lie under a window.
#pragma once

#include <gst/gst.h>

#include "window_settings.hpp"

namespace cerberus::plugin {

// The other side of `caps`: everything but the size is the same, and the window's is as set. New caps.
GstCaps* window_caps(const GstCaps* caps, GstPadDirection direction, const WindowSettings& settings);
// Of `windows` (taken) the first kind, of a size as near as can be to half of that of `picture`.
GstCaps* near_half(const GstCaps* picture, GstCaps* windows);

}  // namespace cerberus::plugin
