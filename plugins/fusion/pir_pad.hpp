// SPDX-License-Identifier: LGPL-2.1-or-later
// A request pad of pirfusion: reads caps, segment and buffers of PIR readings, and knows what it heard.
#pragma once

#include <cerberus/cerberus.h>
#include <gst/gst.h>

#include <optional>

#include "cerberus/private/element.hpp"
#include "sensor_history.hpp"

namespace cerberus::plugin {

struct PirPad {
  // Guarded by the element's lock.
  SensorHistory history;
  guint index = 0;  // of its name: sensors are counted in this order
  int sensors = 0;  // of its caps
  bool linked = false;
  bool flushing = true;   // also while it is not active
  bool given_up = false;  // silent for max-wait; nobody waits for it until it speaks

  // Of the pad's own streaming thread.
  GstSegment segment;
  CerberusPirInfo info;
  std::optional<bool> live;  // of what it is linked to; nothing: not asked yet
  bool complained = false;   // of buffers of the wrong size
  bool refused = false;      // its caps: they come again with the next buffer

  PirPad() { reset(); }
  void reset();  // READY
};

GstPad* pir_pad_new(const char* name, GstPadTemplate* pad_template);  // floating
// Of a pad that pir_pad_new() made.
inline PirPad& pir_pad(GstPad* pad) {
  return *reinterpret_cast<detail::Instance<GstPad, PirPad>*>(pad)->priv;
}

// Running time of a position; nothing without one. Before the segment's start it is its start.
std::optional<Time> running_time(const GstSegment& segment, GstClockTime position);

// The caps' sensors as the library wants them.
std::shared_ptr<const SensorArray> sensor_array(const CerberusPirInfo& info);

// Whether a source upstream of a sink pad is live; false where nobody answers.
bool is_live(GstPad* sinkpad);

}  // namespace cerberus::plugin
