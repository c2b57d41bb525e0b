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

// Stands before every encoder: 8 bits and 4:2:0, which all players show, and an even size, which H.264 needs. An odd last
// column or row is scaled away; what is even and I420 passes as it is. Launch files have the same text, and rtsp_mount.c
// (tests/generic/house.py).
inline constexpr std::string_view kBeforeEncoder =
    "videoconvertscale ! video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2]";

// The text for gst-launch-1.0: a keyframe every `gop` frames, `kbit` kilobits a second. JPEG has neither.
std::string encoder_line(const Encoder& encoder, int gop, int kbit);

}  // namespace cerberus::publish
