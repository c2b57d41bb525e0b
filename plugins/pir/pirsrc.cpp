// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-pirsrc
 *
 * Readings of passive infrared sensors as a stream: one byte a sensor, 0 = nothing, 1 = detection, 2 = invalid (warm-up,
 * stuck, chattering, or not open yet). A buffer comes at once at the start and at every change, and every
 * `heartbeat` when nothing changes; a detection begins `min-pulse` after its line's edge. The caps contain the sensors' bearings, which `pirfusion` reads,
 * and their `range` where it is known.
 *
 * Where volts are measured, downstream may take those instead, with the caps `application/x-pir,format=level`: a 32-bit
 * float a sensor in this machine's byte order, at every sample,
 * NaN before the first one. An element that accepts both receives presence.
 *
 * Drivers (`driver`):
 * - `gpio`: lines of a GPIO chip, edges with the kernel's time stamps; LEDs on output lines (`leds-red` while a sensor
 *   detects, `leds-blue` while it does not). Live.
 * - `iio`: channels of an A/D converter, compared with `threshold`. Live.
 * - `evdev`: keys or switches of an input device (`device`, `codes`), as PIR receivers have them that the kernel shows
 *   so. A device that vanishes is a warning, its readings are invalid, and it is used again when it returns. Live.
 * - `external`: a program (`command`) or a microcontroller at a serial port or FIFO (`device`) that sends a line at each
 *   change (docs/manual/sensor-protocol.md). One that ends, vanishes or is silent is a warning, its readings are
 *   invalid, and it is used again when it returns. Live.
 * - `replay`: a file of `seconds,level,level,...` lines or of JSON lines with `time` (or `pts`) and `pir`, as
 *   `motionjson` writes them; ends with the file. What was measured is written with its unit, `seconds,0.1V,3.2V,...`
 *   (in JSON: `volts` in place of `pir`), and compared with `threshold`. Not live unless `is-live`.
 * - `scripted`: the same in the property `script`, lines separated by `;`. Not live unless `is-live`.
 *
 * A recording that is not live can be sought in: readings continue with those of that time. A seek backwards in
 * time (a negative rate) is refused. A last line without its line feed counts if it is complete in itself.
 *
 * Lines of all drivers go through the same model: `active-low`, `min-pulse`, `debounce`, `hold`, `block-time`,
 * `warm-up`; `preset` sets them for a module. A program that sends a detection as a pulse without length needs
 * `min-pulse=0`. At every change the element posts an element message `cerberus-pir` (see cerberus_message_parse_pir();
 * its field `doubtful` has a bit for each sensor whose detection the robot's own motion may have caused, according to the
 * upstream event `cerberus-base`). A sensor that is stuck or chatters is named in a warning message. When a driver fails, a last
 * reading is invalid for all sensors; then comes the error.
 *
 * A driver's calls are made on a thread of its own: one that blocks delays no change of state by more than 100 ms.
 * While it is still being opened a live source sends invalid readings (2), and one that is not live waits for it.
 * That it cannot be opened is an error, however late.
 *
 * ## Examples
 * |[
 * gst-launch-1.0 -m pirsrc driver=scripted script="0,0,0,0; 1,1,0,0; 3,0,0,0" ! fakesink
 * gst-launch-1.0 pirsrc script="0,0.1V,0V,0V; 1,3.2V,0V,0V; 2,0V,0V,0V" ! application/x-pir,format=level ! fakesink
 * gst-launch-1.0 pirsrc driver=external command="python3 pipelines/sensors/example.py" ! fakesink
 * gst-launch-1.0 pirsrc driver=external device=serial:/dev/ttyUSB0 ! fakesink
 * gst-launch-1.0 pirsrc driver=evdev device="PIR receiver" codes=BTN_0,BTN_1,BTN_2 ! fakesink
 * gst-launch-1.0 pirsrc driver=gpio chip=gpiochip0 lines=17,27,22 leds-red=5,6,13 preset=am312 ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// lib/drivers reads the sensors, sensing::PirModel models each, drivers::SensorArray decides which reading is published
// when.
// Live, the element sleeps on the sensors' fd until the next thing that can happen (an edge, a deadline of a model, a
// heartbeat). A device's stamps are monotonic time: the distance from the stamp to now is taken off the clock's now.
// Not live, the stream is made as fast as it is taken, from the recording alone.
#include <cerberus/base.h>
#include <cerberus/pir.h>
#include <gst/base/gstpushsrc.h>
#include <cerberus/private/element.hpp>
#include "shared/settings_query.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <span>

#include "clocks.hpp"
#include "device_wait.hpp"
#include "drivers/sensor/sensor_array.h"
#include "pir_settings.hpp"
#include "sensing/base_rates.h"
#include "shared/pir_reports.hpp"
#include "shared/stamps.hpp"

GST_DEBUG_CATEGORY_STATIC(pirsrc_debug);
#define GST_CAT_DEFAULT pirsrc_debug

namespace cerberus::plugin {
namespace {

using drivers::SensorArray;
using sensing::Time;

constexpr Time kLeastHeartbeat = std::chrono::milliseconds(1);
// A change of state waits for a driver so long, then plays while that is still being opened. 100 ms is promised, and
// one that fails behind it waits 30 ms more for the driver to end (see drivers::SensorRunner).
constexpr auto kOpenPatience = std::chrono::milliseconds(60);

GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CERBERUS_PIR_CAPS ", sensors = (int) [ 1, 16 ]"));

struct Private {
  Adjustable<PirSettings> settings;
  DeviceWait device;

  std::mutex lock;
  PirChosen chosen;
  CerberusPirInfo info{};
  double range = 0;  // metres; 0: not known
  bool running = false;
  bool live = false;
  bool late = false;      // the sensors were still being opened when the source began
  bool reported = false;  // what they failed of
  int reporting = 0;      // number of threads that report a failure
  bool flushing = false;
  std::condition_variable news;  // of these two
  SensorArray sensors;
  sensing::BaseRates base_rates, base_speeds;  // radians and metres a second, on the sensors' clock
  GstClockTime last = 0;  // time stamp of the last buffer: running time, or of a recording its own
};

CERBERUS_DEFINE_TYPE(CerberusPirSrc, cerberus_pir_src, GstPushSrc, GST_TYPE_PUSH_SRC, Private)

// ---- time

// Returns the time of the sensors' clock; lock held.
Time sensors_now(CerberusPirSrc* self) {
  const Private& priv = *self->priv;
  if (!priv.live) return priv.sensors.due();
  return priv.sensors.recorded() ? time_of(running_now(GST_ELEMENT(self))) : monotonic_now();
}

// The running time of something that happened at `time` on the sensors' clock.
GstClockTime running_time(CerberusPirSrc* self, Time time) {
  if (self->priv->sensors.recorded()) return static_cast<GstClockTime>(time.count());
  return running_time_of(GST_ELEMENT(self), time);
}

// ---- the stream

// What the sensors failed of, once.
void report_failure(CerberusPirSrc* self) {
  Private& priv = *self->priv;
  std::unique_lock guard(priv.lock);
  if (!priv.running) return;  // start() posts the error itself, or the element was stopped
  const drivers::SensorError error = priv.sensors.error();
  if (!error || std::exchange(priv.reported, true)) return;
  ++priv.reporting;
  guard.unlock();
  report_error(GST_ELEMENT(self), error);
  guard.lock();
  --priv.reporting;
  priv.news.notify_all();
}

// Ends the stream after a failure was reported: an EOS before the error would look like a regular end.
GstFlowReturn end_of_failure(CerberusPirSrc* self) {
  report_failure(self);
  Private& priv = *self->priv;
  std::unique_lock guard(priv.lock);
  priv.news.wait(guard, [&] { return priv.flushing || priv.reporting == 0; });
  return priv.flushing ? GST_FLOW_FLUSHING : GST_FLOW_EOS;
}

// Reports the failure at once: in PAUSED a live source makes no buffer that could end in an error. It is done on a
// thread of GStreamer's, since posting a message may block.
void refused(CerberusPirSrc* self) {
  gst_element_call_async(
      GST_ELEMENT(self),
      [](GstElement* element, gpointer) {
        auto* self = cerberus_pir_src_self(element);
        guarded(self, [&] { report_failure(self); });
      },
      nullptr, nullptr);
}

// The driver that the settings name, and the arrangement of its sensors; nullptr: `error` has the reason.
std::unique_ptr<drivers::Sensor> arrange(const PirSettings& settings, CerberusPirInfo& info,
                                         drivers::SensorError& error) {
  if (const std::string why = pir_info(settings, info); !why.empty()) {
    error = {drivers::SensorFault::settings, "PIR sensors cannot be arranged so: " + why + ".", ""};
    return nullptr;
  }
  auto sensor = drivers::make_sensor(settings.driver);
  if (!sensor)
    error = {
        drivers::SensorFault::settings,
        "There is no PIR driver \"" + settings.driver + "\". Drivers: " + drivers::sensor_drivers() + ".",
        ""};
  return sensor;
}

// A recording is opened: that takes nothing from anybody.
std::string settings_fault(GstElement* element) {
  const PirSettings settings = cerberus_pir_src_self(element)->priv->settings.snapshot();
  CerberusPirInfo info;
  drivers::SensorError error;
  const auto sensor = arrange(settings, info, error);
  if (!sensor) return error.text;
  const drivers::SensorSetup setup = sensor_setup(settings, info.sensors);
  error = drivers::is_device(settings.driver) ? sensor->check(setup) : sensor->open(setup);
  return error.text;
}

bool open_sensors(CerberusPirSrc* self) {
  Private& priv = *self->priv;
  const PirSettings settings = priv.settings.snapshot();
  CerberusPirInfo info;
  drivers::SensorError refused_so;
  auto sensor = arrange(settings, info, refused_so);
  if (!sensor) {
    report_error(GST_ELEMENT(self), refused_so);
    return false;
  }
  const Time heartbeat = std::max(time_of(settings.heartbeat), kLeastHeartbeat);
  std::unique_lock guard(priv.lock);
  const drivers::SensorError error =
      priv.sensors.open(std::move(sensor), sensor_setup(settings, info.sensors), pir_options(settings),
                        heartbeat, kOpenPatience, [self] { refused(self); });
  if (error) {
    guard.unlock();
    report_error(GST_ELEMENT(self), error);
    return false;
  }
  priv.info = info;
  priv.range = settings.range;
  priv.live = gst_base_src_is_live(GST_BASE_SRC(self));
  priv.last = 0;
  priv.base_rates.clear();
  priv.base_speeds.clear();
  priv.late = !priv.sensors.opened();
  priv.reported = false;
  priv.device.watch(priv.sensors.fd());
  priv.running = true;
  guard.unlock();
  if (settings.driver == "scripted" && settings.script.empty())
    CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS,
                             ("driver=scripted without a script has no readings. Set driver to gpio, iio, "
                              "evdev, external or replay."),
                             (nullptr));
  return true;
}

// What the sensors can give, or while they are being opened may, presence first; lock held.
GstCaps* possible_caps(const Private& priv) {
  CerberusPirInfo info = priv.info;
  info.format = CERBERUS_PIR_PRESENCE;
  GstCaps* caps = cerberus_pir_info_to_caps(&info);
  info.format = CERBERUS_PIR_LEVEL;
  if (priv.late || priv.sensors.measures()) gst_caps_append(caps, cerberus_pir_info_to_caps(&info));
  if (priv.range > 0) gst_caps_set_simple(caps, "range", G_TYPE_DOUBLE, priv.range, nullptr);
  return caps;
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  Private& priv = *cerberus_pir_src_self(base)->priv;
  GstCaps* caps = nullptr;
  {
    const std::lock_guard guard(priv.lock);
    caps = priv.running ? possible_caps(priv) : gst_static_pad_template_get_caps(&src_template);
  }
  if (!filter) return caps;
  GstCaps* both = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return both;
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  Private& priv = *cerberus_pir_src_self(base)->priv;
  CerberusPirInfo info;
  if (!cerberus_pir_info_from_caps(&info, caps, nullptr)) return FALSE;
  const std::lock_guard guard(priv.lock);
  priv.info.format = info.format;
  priv.sensors.report_samples(info.format == CERBERUS_PIR_LEVEL);
  return TRUE;
}

// Said before anything flows, if it is known: else all that a user would see is "not-negotiated".
bool fits_downstream(CerberusPirSrc* self) {
  g_autoptr(GstCaps) wanted = gst_pad_peer_query_caps(GST_BASE_SRC_PAD(self), nullptr);
  g_autoptr(GstCaps) given = get_caps(GST_BASE_SRC(self), nullptr);
  if (gst_caps_can_intersect(wanted, given)) return true;
  g_autofree gchar* wish = gst_caps_to_string(wanted);
  g_autofree gchar* gift = gst_caps_to_string(given);
  CERBERUS_ELEMENT_ERROR(self, CORE, NEGOTIATION,
                         ("The element downstream of pirsrc accepts %s, and the sensors give %s. Volts "
                          "(format=level) come from driver=iio, from driver=external with "
                          "device-options=volts and from recordings in volts only.",
                          wish, gift),
                         (nullptr));
  return false;
}

gboolean stop(GstBaseSrc* base) {
  Private& priv = *cerberus_pir_src_self(base)->priv;
  const std::lock_guard guard(priv.lock);
  priv.device.watch(-1);
  priv.sensors.close();
  priv.running = priv.late = false;
  return TRUE;
}

bool begin(CerberusPirSrc* self) {
  const PirSettings settings = self->priv->settings.snapshot();
  gst_base_src_set_live(GST_BASE_SRC(self), settings.is_live || drivers::is_device(settings.driver));
  return open_sensors(self) && fits_downstream(self);
}

// Not in start(): the base class would say a second time that it failed.
GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  auto* self = cerberus_pir_src_self(element);
  const bool begins = transition == GST_STATE_CHANGE_READY_TO_PAUSED;
  GstStateChangeReturn result = GST_STATE_CHANGE_FAILURE;
  if (!begins || guarded(self, false, [&] { return begin(self); }))
    result = GST_ELEMENT_CLASS(cerberus_pir_src_parent_class())->change_state(element, transition);
  if (begins && result == GST_STATE_CHANGE_FAILURE) stop(GST_BASE_SRC(self));
  return result;
}

// They turned out to be what they are after the caps had to be agreed upon.
GstFlowReturn agree_again(CerberusPirSrc* self) {
  if (!fits_downstream(self)) return GST_FLOW_EOS;
  if (gst_base_src_negotiate(GST_BASE_SRC(self))) return GST_FLOW_OK;
  return GST_PAD_IS_FLUSHING(GST_BASE_SRC_PAD(self)) ? GST_FLOW_FLUSHING : GST_FLOW_NOT_NEGOTIATED;
}

// Returns EOS after an error message was posted: for GST_FLOW_ERROR the base class would post another one.
GstFlowReturn next_buffer(CerberusPirSrc* self, GstBuffer** buffer) {
  Private& priv = *self->priv;
  for (;;) {
    News news;
    std::unique_lock guard(priv.lock);
    const bool open = priv.sensors.opened();
    priv.device.watch(priv.sensors.fd());
    if (!open && !priv.live) {  // its first word is not known yet
      guard.unlock();
      if (!priv.device.sleep(GST_CLOCK_TIME_NONE)) return GST_FLOW_FLUSHING;
      continue;
    }
    if (open && std::exchange(priv.late, false) && !priv.sensors.error()) {
      guard.unlock();
      if (const GstFlowReturn flow = agree_again(self); flow != GST_FLOW_OK) return flow;
      continue;
    }
    const Time now = sensors_now(self);
    const SensorArray::Step step = priv.sensors.next(now, news.reading);
    if (step == SensorArray::Step::ended) return GST_FLOW_EOS;
    if (step == SensorArray::Step::failed) {
      guard.unlock();
      return end_of_failure(self);
    }
    if (step == SensorArray::Step::reading) {
      news.time = priv.last = std::max(priv.last, running_time(self, news.reading.time));
      news.info = priv.info;
      news.outage = priv.sensors.outage_change();
      news.stamp = Stamps::now(GST_CLOCK_TIME_NONE, priv.live, priv.settings.snapshot().camera_name);
      for (int i = 0; i < priv.sensors.count(); ++i) {
        if (!(news.reading.faulty >> i & 1)) continue;
        news.faults[static_cast<std::size_t>(i)] = priv.sensors.fault(i);
        news.places[static_cast<std::size_t>(i)] = priv.sensors.place(i);
      }
      guard.unlock();
      *buffer = publish(GST_ELEMENT(self), GST_BASE_SRC(self)->segment, news);
      return GST_FLOW_OK;
    }
    const Time due = priv.sensors.due();
    guard.unlock();
    if (!priv.live) continue;
    const GstClockTime wait =
        due == sensing::kNever ? GST_CLOCK_TIME_NONE : static_cast<GstClockTime>((due - now).count());
    if (!priv.device.sleep(wait)) return GST_FLOW_FLUSHING;
  }
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto* self = cerberus_pir_src_self(push);
  return guarded(self, GST_FLOW_ERROR, [&] { return next_buffer(self, buffer); });
}

// ---- seeking in a recording

gboolean is_seekable(GstBaseSrc* base) {
  Private& priv = *cerberus_pir_src_self(base)->priv;
  const std::lock_guard guard(priv.lock);
  return priv.running && !priv.live && priv.sensors.recorded();
}

gboolean do_seek(GstBaseSrc* base, GstSegment* segment) {
  if (!is_seekable(base)) return GST_BASE_SRC_CLASS(cerberus_pir_src_parent_class())->do_seek(base, segment);
  Private& priv = *cerberus_pir_src_self(base)->priv;
  const std::lock_guard guard(priv.lock);
  const Time start = time_of(segment->start);
  priv.sensors.seek(start);
  if (!priv.sensors.error()) priv.reported = false;  // it may fail again
  priv.last = static_cast<GstClockTime>(start.count());
  segment->time = segment->start;
  return TRUE;
}

// Readings are made onwards only. The base class would ask do_seek() behind the flush, which takes the segment away:
// what is refused there goes on without one.
bool is_backwards(GstEvent* event) {
  if (GST_EVENT_TYPE(event) != GST_EVENT_SEEK) return false;
  gdouble rate = 1;
  gst_event_parse_seek(event, &rate, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr);
  return rate < 0;
}

gboolean send_event(GstElement* element, GstEvent* event) {
  if (!is_backwards(event))
    return GST_ELEMENT_CLASS(cerberus_pir_src_parent_class())->send_event(element, event);
  gst_event_unref(event);
  return FALSE;
}

void flush(GstBaseSrc* base, bool flushing) {
  Private& priv = *cerberus_pir_src_self(base)->priv;
  priv.device.set_flushing(flushing);
  const std::lock_guard guard(priv.lock);
  priv.flushing = flushing;
  priv.news.notify_all();
}

gboolean unlock(GstBaseSrc* base) {
  flush(base, true);
  return TRUE;
}

gboolean unlock_stop(GstBaseSrc* base) {
  flush(base, false);
  return TRUE;
}

// Turn and speed may come by different events; lock held.
void move_base(CerberusPirSrc* self, const CerberusBase& base) {
  Private& priv = *self->priv;
  const Time now = priv.live ? sensors_now(self) : time_of(priv.last);
  if (std::isfinite(base.yaw_rate)) priv.base_rates.add(now, sensing::radians(base.yaw_rate));
  if (std::isfinite(base.speed)) priv.base_speeds.add(now, base.speed);
  std::array<double, CERBERUS_PIR_MAX_SENSORS> bearings{};
  std::ranges::transform(std::span(priv.info.bearings).first(priv.info.sensors), bearings.begin(),
                         sensing::radians);
  sensing::Geometry geometry;
  geometry.set(std::span(bearings).first(priv.info.sensors), sensing::radians(priv.info.field_of_view));
  priv.sensors.base(now, geometry,
                    {priv.base_rates.at(now).value_or(0), priv.base_speeds.at(now).value_or(0)});
  priv.base_rates.forget_before(now);
  priv.base_speeds.forget_before(now);
}

gboolean event(GstBaseSrc* source, GstEvent* event) {
  auto* self = cerberus_pir_src_self(source);
  Private& priv = *self->priv;
  if (is_backwards(event)) return FALSE;
  if (g_autoptr(CerberusBase) base = cerberus_event_parse_base(event)) {
    const std::lock_guard guard(priv.lock);
    if (priv.running) move_base(self, *base);
    priv.device.wake();
    return TRUE;
  }
  return GST_BASE_SRC_CLASS(cerberus_pir_src_parent_class())->event(source, event);
}

gboolean query(GstBaseSrc* base, GstQuery* query) {
  // A reading is pushed when it is made (latency 0); elements that wait for slower streams may queue any number.
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY) {
    gst_query_set_latency(query, gst_base_src_is_live(base), 0, GST_CLOCK_TIME_NONE);
    return TRUE;
  }
  return GST_BASE_SRC_CLASS(cerberus_pir_src_parent_class())->query(base, query);
}

// ---- properties

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  Private& priv = *cerberus_pir_src_self(object)->priv;
  priv.settings.set(pir_properties(), id, value);
  PirChosen chosen;
  {
    const std::lock_guard guard(priv.lock);
    priv.chosen.set(id);
    chosen = priv.chosen;
  }
  if (is_preset_property(id))
    priv.settings.adjust([&](PirSettings& settings) { apply_preset(settings, chosen); });
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_pir_src_self(object)->priv->settings.get(pir_properties(), id, value);
}

void cerberus_pir_src_init(CerberusPirSrc* self) {
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

void cerberus_pir_src_class_init(CerberusPirSrcClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<PirSettings>::install(object, pir_properties(), GParamFlags(GST_PARAM_MUTABLE_READY));
  GST_ELEMENT_CLASS(klass)->change_state = change_state;
  GST_ELEMENT_CLASS(klass)->query = settings_query<cerberus_pir_src_parent_class, settings_fault>;
  GST_ELEMENT_CLASS(klass)->send_event = send_event;
  auto* src = GST_BASE_SRC_CLASS(klass);
  src->stop = stop;
  src->is_seekable = is_seekable;
  src->do_seek = do_seek;
  src->get_caps = get_caps;
  src->set_caps = set_caps;
  src->unlock = unlock;
  src->unlock_stop = unlock_stop;
  src->event = event;
  src->query = query;
  GST_PUSH_SRC_CLASS(klass)->create = create;
  gst_element_class_add_static_pad_template(GST_ELEMENT_CLASS(klass), &src_template);
  gst_element_class_set_static_metadata(GST_ELEMENT_CLASS(klass), "PIR sensors", "Source/Sensor",
                                        "Readings of passive infrared sensors from GPIO lines, an A/D "
                                        "converter, an input device, a program or a file",
                                        "The Cerberus developers");
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(pirsrc, GST_RANK_NONE, cerberus::plugin::cerberus_pir_src, pirsrc_debug,
                          "PIR sensors")
