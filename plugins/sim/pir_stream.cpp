// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pir_stream.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>

#include "cerberus/private/element.hpp"
#include "patrol_settings.hpp"
#include "sensing/sectors.h"
#include "shared/clock_times.hpp"
#include "shared/pir_reports.hpp"
#include "shared/stamps.hpp"

namespace cerberus::plugin {
namespace {

using sensing::Time;

// Edges as the simulation makes them, in the place of a device.
class SimulatedSensors : public drivers::Sensor {
 public:
  drivers::SensorError open(const drivers::SensorSetup&) override { return {}; }
  bool opens_at_once(const drivers::SensorSetup&) const override { return true; }
  void close() noexcept override {}
  void stop() noexcept override {}
  drivers::SensorError read(Time now, std::vector<drivers::SensorEdge>& to) override {
    const auto later = std::ranges::find_if(edges, [&](const auto& edge) { return edge.time > now; });
    to.insert(to.end(), edges.begin(), later);
    edges.erase(edges.begin(), later);
    return {};
  }
  std::string place(int sensor) const override { return "simulated sensor " + std::to_string(sensor + 1); }
  bool recorded() const override { return true; }
  Time next() const override { return edges.empty() ? sensing::kNever : edges.front().time; }

  std::vector<drivers::SensorEdge> edges;
};

sensing::Geometry geometry_of(const CerberusPirInfo& info) {
  std::array<double, CERBERUS_PIR_MAX_SENSORS> bearings{};
  const auto all = std::span(info.bearings).first(info.sensors);
  std::ranges::transform(all, bearings.begin(), sensing::radians);
  sensing::Geometry geometry;
  geometry.set(std::span(bearings).first(info.sensors), sensing::radians(info.field_of_view));
  return geometry;
}

GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PATROL_PIR_CAPS));

struct Private {
  std::shared_ptr<PirStream> stream;
};

CERBERUS_DEFINE_TYPE(CerberusPatrolPir, cerberus_patrol_pir, GstElement, GST_TYPE_ELEMENT, Private)

void cerberus_patrol_pir_init(CerberusPatrolPir* self) {
  GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SOURCE);
}

void cerberus_patrol_pir_class_init(CerberusPatrolPirClass* klass) {
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "PIR sensors of a simulated robot", "Source/Sensor",
                                        "PIR readings of patrolsimsrc", "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &src_template);
}

}  // namespace

GstElement* pir_source_new(std::shared_ptr<PirStream> stream) {
  auto* source =
      cerberus_patrol_pir_self(g_object_new(cerberus_patrol_pir_get_type(), "name", "pir", nullptr));
  stream->add_pad(GST_ELEMENT(source),
                  gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(source), "src"));
  source->priv->stream = std::move(stream);
  return GST_ELEMENT(source);
}

void PirStream::add_pad(GstElement* source, GstPadTemplate* pad_template) {
  pad_ = gst_pad_new_from_template(pad_template, "src");
  gst_pad_set_element_private(pad_, this);
  gst_pad_set_activatemode_function(pad_, activate);
  gst_pad_set_query_function(pad_, query);
  // Poses and the base's motion are the video's; the readings are made onwards only.
  gst_pad_set_event_function(pad_, [](GstPad*, GstObject*, GstEvent* event) -> gboolean {
    const bool taken = GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM;
    gst_event_unref(event);
    return taken;
  });
  gst_pad_use_fixed_caps(pad_);
  gst_element_add_pad(source, pad_);
}

gboolean PirStream::activate(GstPad* pad, GstObject*, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  auto& self = *static_cast<PirStream*>(gst_pad_get_element_private(pad));
  {
    const std::lock_guard guard(self.lock_);
    self.flushing_ = !active;
    if (!active) self.begun_ = false;
    self.news_.notify_all();
  }
  if (!active) return gst_pad_stop_task(pad);
  return gst_pad_start_task(
      pad, [](gpointer stream) { static_cast<PirStream*>(stream)->run(); }, &self, nullptr);
}

gboolean PirStream::query(GstPad* pad, GstObject* parent, GstQuery* query) {
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY) return gst_pad_query_default(pad, parent, query);
  gst_query_set_latency(query, FALSE, 0, GST_CLOCK_TIME_NONE);
  return TRUE;
}

void PirStream::begin(const CerberusPirInfo& info, double range, const sensing::PirOptions& options,
                      Time heartbeat, const std::string& camera_name) {
  const std::lock_guard guard(lock_);
  steps_.clear();
  begun_ = true;
  ended_ = announced_ = unwanted_ = false;
  until_ = {};
  info_ = info;
  range_ = range;
  camera_name_ = camera_name;
  gst_segment_init(&segment_, GST_FORMAT_TIME);
  auto sensors = std::make_unique<SimulatedSensors>();
  edges_ = &sensors->edges;
  drivers::SensorSetup setup;
  setup.sensors = static_cast<int>(info.sensors);
  for (int i = 0; i < setup.sensors; ++i) edges_->push_back({Time{}, i, options.active_low});
  sensors_.open(std::move(sensors), setup, options, heartbeat);
  news_.notify_all();
}

void PirStream::advance(Step step) {
  const std::lock_guard guard(lock_);
  if (begun_) steps_.push_back(std::move(step));
  news_.notify_all();
}

void PirStream::end() {
  const std::lock_guard guard(lock_);
  ended_ = true;
  news_.notify_all();
}

// One step of the task.
void PirStream::run() {
  std::unique_lock guard(lock_);
  news_.wait(guard, [&] { return flushing_ || (begun_ && (ended_ || !steps_.empty())); });
  bool goes_on = !flushing_;
  if (goes_on && !steps_.empty()) {
    const Step step = std::move(steps_.front());
    steps_.pop_front();
    guard.unlock();
    goes_on = guarded(element_, false, [&] { return take(step); });
  } else if (goes_on) {
    guard.unlock();
    announce();
    gst_pad_push_event(pad_, gst_event_new_eos());
    goes_on = false;
  }
  if (!goes_on) gst_pad_pause_task(pad_);
}

// What goes before the first reading.
void PirStream::announce() {
  if (std::exchange(announced_, true)) return;
  g_autofree gchar* id = gst_pad_create_stream_id(pad_, GST_PAD_PARENT(pad_), nullptr);
  g_autoptr(GstCaps) caps = cerberus_pir_info_to_caps(&info_);
  gst_caps_set_simple(caps, "range", G_TYPE_DOUBLE, range_, nullptr);
  gst_pad_push_event(pad_, gst_event_new_stream_start(id));
  gst_pad_push_event(pad_, gst_event_new_caps(caps));
  gst_pad_push_event(pad_, gst_event_new_segment(&segment_));
}

bool PirStream::take(const Step& step) {
  announce();
  edges_->insert(edges_->end(), step.edges.begin(), step.edges.end());
  sensors_.base(until_, geometry_of(info_), step.motion);
  until_ = step.until;
  drivers::SensorReading reading;
  while (sensors_.next(step.until, reading) == drivers::SensorArray::Step::reading)
    if (!push(reading)) return false;
  if (!unwanted_) gst_pad_push_event(pad_, gst_event_new_gap(clock_time(step.until), 1));
  return true;
}

// False: the thread ends.
bool PirStream::push(const drivers::SensorReading& reading) {
  News news;
  news.reading = reading;
  news.time = clock_time(reading.time);
  news.info = info_;
  news.stamp = Stamps::now(GST_CLOCK_TIME_NONE, false, camera_name_);
  for (int i = 0; i < sensors_.count(); ++i) {
    if (!(reading.faulty >> i & 1)) continue;
    news.faults[static_cast<std::size_t>(i)] = sensors_.fault(i);
    news.places[static_cast<std::size_t>(i)] = sensors_.place(i);
  }
  GstBuffer* buffer = publish(element_, segment_, news);
  if (unwanted_) {
    gst_buffer_unref(buffer);
    return true;
  }
  const GstFlowReturn flow = gst_pad_push(pad_, buffer);
  if (flow == GST_FLOW_FLUSHING) return false;
  if (flow == GST_FLOW_EOS) unwanted_ = true;
  if (flow != GST_FLOW_NOT_LINKED && flow < GST_FLOW_EOS) {
    GST_ELEMENT_FLOW_ERROR(element_, flow);
    return false;
  }
  return true;
}

}  // namespace cerberus::plugin
