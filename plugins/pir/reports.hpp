// SPDX-License-Identifier: LGPL-2.1-or-later
// What is wrong with sensors, as messages of an element.
#pragma once

#include <gst/gst.h>

#include <string>

#include "drivers/sensor_setup.h"

namespace cerberus::plugin {

void report_error(GstElement* element, const drivers::SensorError& error);
// A warning that names the sensor (counted from 0) by its number and place; that it works again, for no fault.
void report_fault(GstElement* element, int sensor, sensing::PirFault fault, double bearing,
                  const std::string& place);

}  // namespace cerberus::plugin
