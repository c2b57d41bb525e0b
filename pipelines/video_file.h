// SPDX-License-Identifier: LGPL-2.1-or-later
// A look at a video file before the work begins: how large its picture is, and whether there is one at all.
#pragma once

#include <gst/gst.h>

#include <string>

#include "vision/image/image.h"

namespace cerberus::demo {

struct VideoFile {
  vision::Size size;                            // as it is shown: a turned phone's turned back
  GstClockTime duration = GST_CLOCK_TIME_NONE;  // as the file says
  std::string error;                            // why it cannot be used, for its user; empty if it can
};

VideoFile look_at(const std::string& path);

// Before anything is decoded in it: GStreamer 1.26's libav decoders end the process now and then where rows are padded
// (H.264 of a width that is no multiple of 16), unless they do not draw straight into the buffers.
void decode_with_care(GstElement* pipeline);

// Begins what is said about a file that is no good.
std::string not_a_video(const std::string& path);

}  // namespace cerberus::demo
