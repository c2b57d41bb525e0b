// SPDX-License-Identifier: LGPL-2.1-or-later
// What sensors say and what is wrong with them, as buffers and messages of an element.
#pragma once

#include <cerberus/pir.h>
#include <gst/base/gstbasesrc.h>

#include <array>
#include <string>

#include "drivers/sensor/sensor_array.h"

namespace cerberus::plugin {

void report_error(GstElement* element, const drivers::SensorError& error);
// A warning that names the sensor (counted from 0) by its number and place; that it works again, for no fault.
void report_fault(GstElement* element, int sensor, sensing::PirFault fault, double bearing,
                  const std::string& place);

// What a step of the sensors left to be said, outside the lock.
struct News {
  drivers::SensorReading reading;
  GstClockTime time = 0;
  CerberusPirInfo info{};
  CerberusStamp stamp;  // of the reading; its running time is set when it is published
  std::array<sensing::PirFault, sensing::kMaxSensors> faults{};
  std::array<std::string, sensing::kMaxSensors> places;
};

// Posts it, and makes a buffer of it.
GstBuffer* publish(GstBaseSrc* source, const News& news);

}  // namespace cerberus::plugin
