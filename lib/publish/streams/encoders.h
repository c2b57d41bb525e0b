// SPDX-License-Identifier: LGPL-2.1-or-later
// The encoders of encoders.list, which is also what pipelines/encoder reads.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cerberus::publish {

struct Encoder {
  std::string_view name;   // "x264"
  std::string_view codec;  // "h264", "vp8" or "jpeg"
  bool hardware = false;
  std::string_view element;  // "x264enc"
  std::string_view package;  // of Debian
  std::string_view line;     // with the words KBIT, BIT and GOP
};

// In the order of the list.
std::span<const Encoder> encoders();

// nullptr: no encoder has this element.
const Encoder* encoder_of(std::string_view element);

// The text for gst-launch-1.0: a keyframe every `gop` frames, `kbit` kilobits a second. JPEG has neither.
std::string encoder_line(const Encoder& encoder, int gop, int kbit);

}  // namespace cerberus::publish
