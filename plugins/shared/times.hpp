// SPDX-License-Identifier: LGPL-2.1-or-later
// How long frames last in running time.
#pragma once

#include <gst/video/video.h>

#include <algorithm>
#include <cmath>

#include "motion/head_limits.h"
#include "shared/clock_times.hpp"

namespace cerberus::plugin {

// Returns the running time that a frame or a gap of `duration` (none: from the frame rate) lasts; 0: unknown. The
// element that waits for a head and the one that drives it use the same values.
inline motion::Time running_length(GstClockTime duration, const GstVideoInfo& info,
                                   const GstSegment& segment) {
  if (!GST_CLOCK_TIME_IS_VALID(duration))
    duration = info.fps_n > 0 ? gst_util_uint64_scale_int(GST_SECOND, info.fps_d, info.fps_n) : 0;
  const double length = std::ceil(static_cast<double>(duration) / std::abs(segment.rate));
  return time_of(static_cast<GstClockTime>(std::min(length, 0x1p61)));
}

}  // namespace cerberus::plugin
