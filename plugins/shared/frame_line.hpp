// SPDX-License-Identifier: LGPL-2.1-or-later
// The line of JSON about one frame that motionjson gives out and eventrecorder writes beside its files.
#pragma once

#include <cerberus/stamp.h>

#include <string_view>

#include "text/json_line.h"

namespace cerberus::plugin {

struct FrameFacts {
  guint64 number;     // of the frame, from 0
  int width, height;  // pixels
};

// Writes what is attached to `buffer` into `line`, in place of its former content. Returns the text with its line feed,
// which is valid until `line` is written again. The fields are documented with motionjson.
std::string_view write_frame_line(text::JsonLine& line, GstBuffer* buffer, const CerberusStamp& stamp,
                                  const FrameFacts& frame);

}  // namespace cerberus::plugin
