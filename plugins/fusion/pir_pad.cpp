// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pir_pad.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "sensing/angles.h"
#include "settings.hpp"

namespace cerberus::plugin {
namespace {

CERBERUS_DEFINE_TYPE(CerberusPirPad, cerberus_pir_pad, GstPad, GST_TYPE_PAD, PirPad)
void cerberus_pir_pad_init(CerberusPirPad*) {}
void cerberus_pir_pad_class_init(CerberusPirPadClass*) {}

std::shared_ptr<const fusion::SensorArray> sensor_array(const CerberusPirInfo& info) {
  auto array = std::make_shared<fusion::SensorArray>();
  array->count = static_cast<int>(info.sensors);
  array->field_of_view = sensing::radians(info.field_of_view);
  for (guint i = 0; i < info.sensors; ++i) array->bearings[i] = sensing::radians(info.bearings[i]);
  return array;
}

// ---- caps and segment

// Posts the error once: unusable caps or segments come again with the next buffer.
bool refuse(GstElement* element, GstPad* pad, const std::string& fault) {
  if (!std::exchange(pir_pad(pad).refused, true))
    CERBERUS_ELEMENT_ERROR(element, CORE, NEGOTIATION, ("Pad %s: %s", GST_PAD_NAME(pad), fault.c_str()),
                           (nullptr));
  return false;
}

// Resets the model of sensors that send volts: their state is unknown.
void begin_levels(PirPad& pir) {
  pir.levels.begin(pir.info.format == CERBERUS_PIR_LEVEL ? pir.info.sensors : 0, pir.level);
  pir.faults.fill(sensing::PirFault::none);
}

// Takes over what the caps say; else the reason why they cannot be fused.
std::string take_caps(GstElement* element, PirPad& pir, const GstCaps* caps) {
  CerberusPirInfo info;
  g_autoptr(GError) error = nullptr;
  if (!cerberus_pir_info_from_caps(&info, caps, &error)) return error->message;
  g_object_get(element, "level-threshold", &pir.level.threshold, "level-hysteresis", &pir.level.hysteresis,
               nullptr);
  const auto count = static_cast<int>(info.sensors);
  const std::lock_guard guard(pir.inputs->lock());
  const int others = pir.inputs->places_besides(pir);
  if (others + count > sensing::kMaxSensors)
    return std::to_string(count) + " PIR sensors are too many besides the other pads' " +
           std::to_string(others) + ": " + std::to_string(sensing::kMaxSensors) + " in all can be fused.";
  pir.sensors = count;
  pir.history.set_array(sensor_array(info));
  pir.info = info;
  begin_levels(pir);
  return {};
}

bool caps_event(GstElement* element, GstPad* pad, GstEvent* event) {
  PirPad& pir = pir_pad(pad);
  GstCaps* caps;
  gst_event_parse_caps(event, &caps);
  const std::string fault = take_caps(element, pir, caps);
  if (fault.empty()) {
    pir.refused = false;
    return true;
  }
  pir.info.sensors = 0;
  return refuse(element, pad, fault);
}

bool segment_event(GstElement* element, GstPad* pad, GstEvent* event) {
  const GstSegment* segment;
  gst_event_parse_segment(event, &segment);
  if (segment->format != GST_FORMAT_TIME)
    return refuse(element, pad, "PIR readings need times, and their stream has none.");
  PirPad& pir = pir_pad(pad);
  gst_segment_copy_into(segment, &pir.segment);
  const std::lock_guard guard(pir.inputs->lock());
  pir.live.reset();
  begin_levels(pir);
  return true;
}

// ---- what covers time without a reading

// Returns the later of `time` and the clock's time: a source that sends is alive now, however old its data is.
Time now_or(GstElement* element, Time time) {
  return std::max(time, clock_now(element).value_or(time));
}

void gap_event(GstElement* element, PirPad& pir, GstEvent* event) {
  GstClockTime begin, length;
  gst_event_parse_gap(event, &begin, &length);
  const auto from = running_time(pir.segment, begin);
  if (!from) return;
  const bool has_length = GST_CLOCK_TIME_IS_VALID(length) && length > 0;
  const Time until = *from + (has_length ? time_of(length) : Time(1));
  const Time spoken = now_or(element, until);
  const std::lock_guard guard(pir.inputs->lock());
  pir.history.cover(until);
  pir.inputs->add_reading(pir, spoken);
}

void end(PirPad& pir) {
  const std::lock_guard guard(pir.inputs->lock());
  pir.inputs->end(pir);
}

void begin_again(PirPad& pir) {
  const std::lock_guard guard(pir.inputs->lock());
  pir.history.clear();
  pir.spoken.reset();
  pir.flushing = pir.refused = false;
  gst_segment_init(&pir.segment, GST_FORMAT_UNDEFINED);
  begin_levels(pir);
}

gboolean event_function(GstPad* pad, GstObject* parent, GstEvent* event) {
  GstElement* element = GST_ELEMENT(parent);
  PirPad& pir = pir_pad(pad);
  const bool good = guarded(element, false, [&] {
    switch (GST_EVENT_TYPE(event)) {
      case GST_EVENT_STREAM_START:
        pir.refused = false;
        return true;
      case GST_EVENT_CAPS:
        return caps_event(element, pad, event);
      case GST_EVENT_SEGMENT:
        return segment_event(element, pad, event);
      case GST_EVENT_GAP:
        gap_event(element, pir, event);
        return true;
      case GST_EVENT_SEGMENT_DONE:
      case GST_EVENT_EOS:
        end(pir);
        return true;
      case GST_EVENT_FLUSH_START:
        pir.inputs->set(pir.flushing, true);
        return true;
      case GST_EVENT_FLUSH_STOP:
        begin_again(pir);
        return true;
      default:
        return true;
    }
  });
  gst_event_unref(event);
  return good;
}

// ---- readings

// One of presence or volts, as the caps say; what is missing is invalid.
struct Sample {
  std::array<std::uint8_t, sensing::kMaxSensors> presence;
  std::array<float, sensing::kMaxSensors> volts;
};

Sample sample_of(GstElement* element, GstPad* pad, GstBuffer* buffer) {
  PirPad& pir = pir_pad(pad);
  Sample sample;
  sample.presence.fill(fusion::kInvalid);
  sample.volts.fill(std::numeric_limits<float>::quiet_NaN());
  const gsize size = gst_buffer_get_size(buffer);
  const bool volts = pir.info.format == CERBERUS_PIR_LEVEL;
  if (size == cerberus_pir_info_buffer_size(&pir.info))
    gst_buffer_extract(
        buffer, 0,
        volts ? static_cast<void*>(sample.volts.data()) : static_cast<void*>(sample.presence.data()), size);
  else if (!std::exchange(pir.complained, true))
    CERBERUS_ELEMENT_WARNING(element, STREAM, FORMAT,
                             ("Pad %s: a PIR reading of %" G_GSIZE_FORMAT " bytes for %u sensors is invalid.",
                              GST_PAD_NAME(pad), size, pir.info.sensors),
                             (nullptr));
  return sample;
}

// What volts measured at `time` mean, with all that became of the sensors until then; the lock is held.
void append_levels(PirPad& pir, Time time, std::span<const float> volts) {
  const auto append = [&](Time at) {
    std::array<std::uint8_t, sensing::kMaxSensors> values{};
    std::ranges::transform(pir.levels.presence(), values.begin(),
                           [](sensing::Presence presence) { return static_cast<std::uint8_t>(presence); });
    pir.history.append(at, std::span(values).first(pir.info.sensors));
  };
  for (Time due = pir.levels.deadline(); due < time; due = pir.levels.deadline()) {
    pir.levels.poll(due);
    append(due);
  }
  pir.levels.measure(time, volts);
  append(time);
}

// Reports faults of sensors that send volts, as pirsrc does for its own.
void report_faults(GstElement* element, GstPad* pad) {
  PirPad& pir = pir_pad(pad);
  for (std::size_t i = 0; i < pir.levels.presence().size(); ++i) {
    const sensing::PirFault fault = pir.levels.fault(i);
    if (std::exchange(pir.faults[i], fault) == fault) continue;
    const auto number = static_cast<unsigned>(i + 1);
    const auto bearing = std::lround(pir.info.bearings[i]);
    if (fault == sensing::PirFault::none)
      CERBERUS_ELEMENT_INFO(
          element, RESOURCE, READ,
          ("PIR sensor infer%u (pad %s, bearing %ld) works again.", number, GST_PAD_NAME(pad), bearing),
          (nullptr));
    else
      CERBERUS_ELEMENT_WARNING(
          element, RESOURCE, READ,
          ("PIR sensor infer%u (pad %s, bearing %ld) is %s: its readings do not count until it is well "
           "again. "
           "Check level-threshold, the sensor's cable and supply, and what is warm or moving before it.",
           number, GST_PAD_NAME(pad), bearing, std::string(sensing::describe(fault)).c_str()),
          (nullptr));
  }
}

GstFlowReturn take_reading(GstElement* element, GstPad* pad, GstBuffer* buffer) {
  PirPad& pir = pir_pad(pad);
  if (pir.info.sensors == 0) return GST_FLOW_NOT_NEGOTIATED;
  const Sample sample = sample_of(element, pad, buffer);
  const std::optional<bool> live = pir.live ? pir.live : is_live(pad);
  const Time now = now_or(element, Time::zero());
  {
    std::unique_lock guard(pir.inputs->lock());
    pir.live = live;
    // A reading without a time is as late as the one before.
    const Time time = running_time(pir.segment, GST_BUFFER_PTS(buffer)).value_or(pir.history.newest());
    const bool wanted = pir.live.value_or(true) || pir.inputs->wait_for_video(guard, pir, time);
    if (pir.flushing) return GST_FLOW_FLUSHING;
    if (!wanted) return GST_FLOW_EOS;
    if (pir.info.format == CERBERUS_PIR_LEVEL)
      append_levels(pir, time, std::span(sample.volts).first(pir.info.sensors));
    else
      pir.history.append(time, std::span(sample.presence).first(pir.info.sensors));
    pir.inputs->add_reading(pir, std::max(time, now));
  }
  if (pir.live.value_or(true) && pir.inputs->on_reading) pir.inputs->on_reading();
  report_faults(element, pad);
  return GST_FLOW_OK;
}

GstFlowReturn chain_function(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  GstElement* element = GST_ELEMENT(parent);
  const GstFlowReturn flow =
      guarded(element, GST_FLOW_ERROR, [&] { return take_reading(element, pad, buffer); });
  gst_buffer_unref(buffer);
  return flow;
}

// ---- links and activation

// Links come with the pad's lock held: nothing but our own flag here.
// A pad without a parent was released, and its element may be gone.
GstPadLinkReturn link_function(GstPad* pad, GstObject* parent, GstPad*) {
  if (parent) pir_pad(pad).inputs->set(pir_pad(pad).linked, true);
  return GST_PAD_LINK_OK;
}
void unlink_function(GstPad* pad, GstObject* parent) {
  if (parent) pir_pad(pad).inputs->set(pir_pad(pad).linked, false);
}

gboolean activate_function(GstPad* pad, GstObject* parent, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  if (parent) pir_pad(pad).inputs->set(pir_pad(pad).flushing, !active);
  return TRUE;
}

GstIterator* no_internal_links(GstPad*, GstObject*) {
  return nullptr;
}

}  // namespace

void PirPad::reset() {
  forget();
  complained = refused = false;
  gst_segment_init(&segment, GST_FORMAT_UNDEFINED);
  cerberus_pir_info_init(&info);
  info.sensors = 0;
}

GstPad* pir_pad_new(unsigned number, GstPadTemplate* pad_template, Inputs* inputs) {
  const std::string name = "pir_" + std::to_string(number);
  auto* pad = GST_PAD(g_object_new(cerberus_pir_pad_get_type(), "name", name.c_str(), "direction",
                                   GST_PAD_SINK, "template", pad_template, nullptr));
  pir_pad(pad).inputs = inputs;
  pir_pad(pad).pad = pad;
  pir_pad(pad).name = name;
  pir_pad(pad).index = number;
  gst_pad_set_chain_function(pad, chain_function);
  gst_pad_set_event_function(pad, event_function);
  gst_pad_set_link_function(pad, link_function);
  gst_pad_set_unlink_function(pad, unlink_function);
  gst_pad_set_activatemode_function(pad, activate_function);
  gst_pad_set_iterate_internal_links_function(pad, no_internal_links);
  return pad;
}

std::optional<Time> running_time(const GstSegment& segment, GstClockTime position) {
  if (segment.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(position)) return std::nullopt;
  guint64 time = 0;
  const gint sign = gst_segment_to_running_time_full(&segment, GST_FORMAT_TIME, position, &time);
  if (sign == 0) return std::nullopt;
  return sign < 0 ? Time::zero() : time_of(time);
}

}  // namespace cerberus::plugin
