// SPDX-License-Identifier: LGPL-2.1-or-later
// Real frames for the benches: decoded once through GStreamer, kept in memory, pushed in a loop.
#pragma once

#include <gst/gst.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::bench {

// Raw frames of one format and size, each in its own tightly described buffer as GStreamer lays it out.
struct Frames {
  std::string caps;  // video/x-raw, ... without a frame rate
  int width = 0, height = 0;
  std::vector<std::vector<std::uint8_t>> data;
  // Index of the n-th frame of an endless forward-and-back loop, so that looping is never a cut.
  std::size_t loop(std::size_t n) const;
  // A frame of format GRAY8.
  vision::GrayView grey(std::size_t n) const {
    return {data[n].data(), width, height, static_cast<std::ptrdiff_t>(data[n].size()) / height};
  }
};

// `source`: a launch line that ends in decoded video. Takes at most `count` frames at width x height (0: as
// it is). Prints what went wrong and returns nothing on failure.
std::optional<Frames> load_frames(const std::string& source, const char* format, int width, int height,
                                  int count);

// CPU seconds that the calling thread has used.
double thread_seconds();
double median(std::vector<double> values);

}  // namespace cerberus::bench
