// SPDX-License-Identifier: LGPL-2.1-or-later
// A request pad of pirfusion: receives caps, segments and buffers of PIR readings and stores the readings. Nothing is
// passed on; unusable data is an error message of the element, which names the pad.
#pragma once

#include <cerberus/cerberus.h>
#include <gst/gst.h>

#include <optional>

#include "cerberus/private/element.hpp"
#include "inputs.hpp"
#include "sensing/levels.h"

namespace cerberus::plugin {

struct PirPad : fusion::SensorSource {  // guarded by the inputs' lock
  Inputs* inputs = nullptr;
  GstPad* pad = nullptr;

  // Of the pad's own streaming thread.
  GstSegment segment;
  CerberusPirInfo info;          // without sensors: no caps
  sensing::LevelSensors levels;  // what a stream of volts means
  sensing::LevelOptions level;
  std::array<sensing::PirFault, sensing::kMaxSensors> faults{};  // of those sensors, as last reported
  bool complained = false;                                       // of buffers of the wrong size
  bool refused = false;  // its caps or segment: they come again with the next buffer

  PirPad() { reset(); }
  void reset();  // READY
};

GstPad* pir_pad_new(unsigned number, GstPadTemplate* pad_template, Inputs* inputs);  // floating
// Of a pad that pir_pad_new() made.
inline PirPad& pir_pad(GstPad* pad) {
  return *reinterpret_cast<detail::Instance<GstPad, PirPad>*>(pad)->priv;
}

// Running time of a position; nothing without one. What lies before the segment is as old as can be.
std::optional<Time> running_time(const GstSegment& segment, GstClockTime position);

}  // namespace cerberus::plugin
