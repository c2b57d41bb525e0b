// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clocks.hpp"

#include <algorithm>

#include "shared/clock_times.hpp"

namespace cerberus::plugin {

namespace {

// How far running time is ahead of monotonic time. The two cannot be read at once: of some tries the one that was
// interrupted least counts, or a busy machine would shift a reading by a time slice.
GstClockTimeDiff clock_distance(GstElement* element) {
  Time least = Time::max();
  GstClockTimeDiff distance = 0;
  for (int i = 0; i < 5 && least > std::chrono::microseconds(20); ++i) {
    const Time before = monotonic_now();
    const auto running = static_cast<GstClockTimeDiff>(running_now(element));
    const Time took = monotonic_now() - before;
    if (took >= least) continue;
    least = took;
    distance = running - (before + took / 2).count();
  }
  return distance;
}

}  // namespace

Time monotonic_now() {
  return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC, as the kernel stamps edges
}

GstClockTime running_now(GstElement* element) {
  return clock_time(clock_now(element).value_or(Time::zero()));
}

GstClockTime running_time_of(GstElement* element, Time monotonic) {
  const GstClockTimeDiff time = monotonic.count() + clock_distance(element);
  return static_cast<GstClockTime>(std::max<GstClockTimeDiff>(time, 0));
}

}  // namespace cerberus::plugin
