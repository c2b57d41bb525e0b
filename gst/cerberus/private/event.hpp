// SPDX-License-Identifier: LGPL-2.1-or-later
// What the events that travel upstream share.
#pragma once

#include <gst/gst.h>

namespace cerberus {

// Nothing turns further (many turns of cable) or faster; what claims to is garbage.
constexpr double kMostDegrees = 1e6;

inline bool is_custom_upstream(GstEvent* event, const char* name) {
  return GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM && gst_event_has_name(event, name);
}

}  // namespace cerberus
