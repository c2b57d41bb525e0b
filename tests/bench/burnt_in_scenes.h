// SPDX-License-Identifier: LGPL-2.1-or-later
// Cameras that write into their pictures: a clock or a logo in a corner, over real video, rendered with cairo as an
// encoder's on-screen display would.
#pragma once

#include <string>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::bench {

enum class Corner { top_left, top_right, bottom_left, bottom_right };
enum class Writing {
  sans_clock,       // h:mm:ss.mmm, white with a black outline, as GStreamer's timeoverlay
  monospace_clock,  // date and hh:mm:ss on a dark box
  blinking_logo,    // a disc and letters, on for half a second, off for half a second
};
const char* name_of(Corner corner);
const char* name_of(Writing writing);

// Writes into the luma plane of a frame that is shown `seconds` after the start; returns where.
vision::Box write_into(vision::MutableGrayView frame, Writing writing, Corner corner, double seconds);

}  // namespace cerberus::bench
