// SPDX-License-Identifier: LGPL-2.1-or-later
// Publishes the readings and the faults of sensors as buffers and messages of an element.
#pragma once

#include <cerberus/pir.h>
#include <gst/gst.h>

#include <array>
#include <optional>
#include <string>

#include "drivers/sensor/sensor_array.h"

namespace cerberus::plugin {

void report_error(GstElement* element, const drivers::SensorError& error);
// Posts a warning that names the sensor (index from 0) by its number and place; without a fault, that it works again.
void report_fault(GstElement* element, int sensor, sensing::PirFault fault, double bearing,
                  const std::string& place);
// Posts a warning that says why nothing is known of the sensors, or, where it says nothing, that they work again.
void report_outage(GstElement* element, const std::string& outage);

// The results of one step of the sensors, to be published without the lock.
struct News {
  drivers::SensorReading reading;
  GstClockTime time = 0;
  CerberusPirInfo info{};
  CerberusStamp stamp;  // of the reading; its running time is set when it is published
  std::array<sensing::PirFault, sensing::kMaxSensors> faults{};
  std::array<std::string, sensing::kMaxSensors> places;
  std::optional<std::string> outage;  // if it changed
};

// Posts it, and makes a buffer of it.
GstBuffer* publish(GstElement* element, const GstSegment& segment, const News& news);

}  // namespace cerberus::plugin
