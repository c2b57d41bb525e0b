// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pir_reports.hpp"

#include <algorithm>
#include <cerberus/private/messages.hpp>
#include <cmath>
#include <iterator>

namespace cerberus::plugin {

void report_error(GstElement* element, const drivers::SensorError& error) {
  constexpr int kCodes[] = {0,  // in the order of SensorFault
                            GST_RESOURCE_ERROR_SETTINGS,
                            GST_RESOURCE_ERROR_NOT_FOUND,
                            GST_RESOURCE_ERROR_BUSY,
                            GST_RESOURCE_ERROR_NOT_AUTHORIZED,
                            GST_RESOURCE_ERROR_SETTINGS,
                            GST_STREAM_ERROR_DECODE,
                            GST_RESOURCE_ERROR_READ};
  static_assert(static_cast<std::size_t>(drivers::SensorFault::gone) + 1 == std::size(kCodes));
  if (!error) return;
  const GQuark domain = error.fault == drivers::SensorFault::data ? GST_STREAM_ERROR : GST_RESOURCE_ERROR;
  detail::post(element, GST_MESSAGE_ERROR, domain, kCodes[static_cast<int>(error.fault)],
               detail::words(error.text), detail::words(error.detail), nullptr,
               {GST_CAT_DEFAULT, __FILE__, GST_FUNCTION, __LINE__});
}

void report_fault(GstElement* element, int sensor, sensing::PirFault fault, double bearing,
                  const std::string& place) {
  const std::string name = "PIR sensor infer" + std::to_string(sensor + 1) + " (" + place + ", bearing " +
                           std::to_string(std::lround(bearing)) + ")";
  if (fault == sensing::PirFault::none) {
    CERBERUS_ELEMENT_INFO(element, RESOURCE, READ, (name + " works again."), (nullptr));
    return;
  }
  const std::string what(sensing::describe(fault));
  CERBERUS_ELEMENT_WARNING(
      element, RESOURCE, READ,
      ("%s is %s: its readings do not count until it is well again. Check its cable and supply, "
       "and what is warm or moving before it.",
       name.c_str(), what.c_str()),
      (nullptr));
}

void report_outage(GstElement* element, const std::string& outage) {
  if (outage.empty())
    CERBERUS_ELEMENT_INFO(element, RESOURCE, READ, ("The PIR sensors work again."), (nullptr));
  else
    CERBERUS_ELEMENT_WARNING(element, RESOURCE, READ, ("%s.", outage.c_str()), (nullptr));
}

GstBuffer* publish(GstElement* element, const GstSegment& segment, const News& news) {
  const drivers::SensorReading& reading = news.reading;
  const guint count = news.info.sensors;
  CerberusPir pir;
  cerberus_pir_init(&pir);
  pir.n_sensors = count;
  pir.doubtful = static_cast<guint>(reading.doubtful);
  std::copy_n(news.info.bearings, count, pir.bearings);
  for (guint i = 0; i < count; ++i) pir.sensors[i] = static_cast<guint8>(reading.presence[i]);
  for (guint i = 0; i < count; ++i)
    if (reading.faulty >> i & 1)
      report_fault(element, static_cast<int>(i), news.faults[i], news.info.bearings[i], news.places[i]);
  if (news.outage) report_outage(element, *news.outage);
  if (reading.changed) {
    CerberusStamp stamp = news.stamp;
    stamp.running_time = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, news.time);
    gst_element_post_message(element, cerberus_message_new_pir(GST_OBJECT(element), &stamp, &pir));
  }
  const gsize size = cerberus_pir_info_buffer_size(&news.info);
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  const bool volts = news.info.format == CERBERUS_PIR_LEVEL;
  gst_buffer_fill(buffer, 0, volts ? static_cast<const void*>(reading.volts.data()) : pir.sensors, size);
  GST_BUFFER_PTS(buffer) = news.time;
  return buffer;
}

}  // namespace cerberus::plugin
