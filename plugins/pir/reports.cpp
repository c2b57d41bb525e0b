// SPDX-License-Identifier: LGPL-2.1-or-later
#include "reports.hpp"

#include <cmath>

namespace cerberus::plugin {

using drivers::SensorFault;

void report_error(GstElement* element, const drivers::SensorError& error) {
  const char* detail = error.detail.c_str();
  const char* text = error.text.c_str();
  switch (error.fault) {
    case SensorFault::none:
      return;
    case SensorFault::settings:
    case SensorFault::missing:
      GST_ELEMENT_ERROR(element, RESOURCE, SETTINGS, ("%s", text), ("%s", detail));
      return;
    case SensorFault::not_found:
      GST_ELEMENT_ERROR(element, RESOURCE, NOT_FOUND, ("%s", text), ("%s", detail));
      return;
    case SensorFault::busy:
      GST_ELEMENT_ERROR(element, RESOURCE, BUSY, ("%s", text), ("%s", detail));
      return;
    case SensorFault::denied:
      GST_ELEMENT_ERROR(element, RESOURCE, NOT_AUTHORIZED, ("%s", text), ("%s", detail));
      return;
    case SensorFault::data:
      GST_ELEMENT_ERROR(element, STREAM, DECODE, ("%s", text), ("%s", detail));
      return;
    case SensorFault::gone:
      GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s", text), ("%s", detail));
      return;
  }
}

void report_fault(GstElement* element, int sensor, sensing::PirFault fault, double bearing,
                  const std::string& place) {
  const std::string name = "PIR sensor infer" + std::to_string(sensor + 1) + " (" + place + ", bearing " +
                           std::to_string(std::lround(bearing)) + ")";
  if (fault == sensing::PirFault::none) {
    GST_ELEMENT_INFO(element, RESOURCE, READ, ("%s works again.", name.c_str()), (nullptr));
    return;
  }
  const std::string what(sensing::describe(fault));
  GST_ELEMENT_WARNING(
      element, RESOURCE, READ,
      ("%s is %s: its readings do not count until it is well again. Check its cable and supply, "
       "and what is warm or moving before it.",
       name.c_str(), what.c_str()),
      (nullptr));
}

}  // namespace cerberus::plugin
