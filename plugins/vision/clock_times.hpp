// SPDX-License-Identifier: LGPL-2.1-or-later
// GStreamer's times and lib's.
#pragma once

#include <gst/gst.h>

#include <algorithm>
#include <chrono>

namespace cerberus::plugin {

constexpr GstClockTime clock_time(std::chrono::nanoseconds time) {
  return static_cast<GstClockTime>(time.count());
}
// At most a quarter of what fits, 73 years: sums of some times stay times.
constexpr std::chrono::nanoseconds time_of(GstClockTime time) {
  return std::chrono::nanoseconds(static_cast<gint64>(std::min<GstClockTime>(time, G_MAXINT64 / 4)));
}

}  // namespace cerberus::plugin
