// SPDX-License-Identifier: LGPL-2.1-or-later
// GStreamer's times and lib's.
#pragma once

#include <gst/gst.h>

#include <algorithm>
#include <optional>

#include "control/head_limits.h"

namespace cerberus::plugin {

constexpr GstClockTime clock_time(control::Time time) {
  return static_cast<GstClockTime>(time.count());
}
constexpr control::Time time_of(GstClockTime time) {
  return control::Time(static_cast<control::Time::rep>(std::min<GstClockTime>(time, G_MAXINT64 / 4)));
}

// Running time by the clock, while there is one.
inline std::optional<control::Time> clock_now(gpointer element) {
  const GstClockTime time = gst_element_get_current_running_time(GST_ELEMENT(element));
  if (!GST_CLOCK_TIME_IS_VALID(time)) return std::nullopt;
  return time_of(time);
}

}  // namespace cerberus::plugin
