// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames a window over a picture can give, and which pictures can lie under a window.
#pragma once

#include <gst/gst.h>

#include "window_settings.hpp"

namespace cerberus::plugin {

// What the other side can have where the pad of `direction` has `caps`: the same but for the size. A window (direction
// GST_PAD_SINK: `caps` are pictures) is as large as the settings say,
// or of any size; a picture under a window is of any size. New caps.
GstCaps* window_caps(const GstCaps* caps, GstPadDirection direction, const WindowSettings& settings);
// Which window it is, where `picture` is fixed and the settings leave a choice: of `windows` (which it takes, and
// returns changed) the first format, in the size that comes nearest to half the picture's.
GstCaps* near_half(const GstCaps* picture, GstCaps* windows);

}  // namespace cerberus::plugin
