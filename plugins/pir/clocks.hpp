// SPDX-License-Identifier: LGPL-2.1-or-later
// The two clocks of a live source of a device's readings: the
// pipeline's, and CLOCK_MONOTONIC, which the kernel stamps with.
#pragma once

#include <gst/gst.h>

#include <chrono>

namespace cerberus::plugin {

using Time = std::chrono::nanoseconds;

Time monotonic_now();
// Running time; 0 before there is a clock.
GstClockTime running_now(GstElement* element);
// The running time of something that happened at `monotonic`; 0 if that was before it began.
GstClockTime running_time_of(GstElement* element, Time monotonic);

}  // namespace cerberus::plugin
