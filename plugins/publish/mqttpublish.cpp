// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-mqttpublish
 * @title: mqttpublish
 * @short_description: publishes what was found by MQTT, and takes orders for the head
 * @see_also: motionjson, onvifmeta, pantiltsink
 *
 * Publishes what the elements upstream attached to the video frames to an MQTT broker, as JSON. Frames pass through
 * untouched, and never wait for the broker. Topics, below `topic-prefix`/`camera-name`:
 *
 * - `status`: `online`, and as last will `offline`; `mode`: the property `mode`, where it is set;
 * - `state`: `motion` (boolean), `objects` (the number of tracks); `pir`: `sensors` (0 nothing, 1 detection, 2 invalid);
 *   `pantilt`: `pan`, `tilt` (degrees), `moving`, twice a second while the head moves; `rule`: `rule`, `name`, `action`,
 *   `target` of `pirfusion`; each retained, and at every change. Where no frame comes for 2 s and twice their distance, and
 *   at the end of the stream, nothing moves any more: `motion` and `moving` become false, sensors invalid, `rule` null;
 * - `track`: `event` (`appeared`, `updated` once a second, `left` 2 s after the last sight), `utc` (of the frame,
 *   where it is known) and the object as `motionjson` has it; not retained;
 * - `command/NAME`: an order, where `commands` lists NAME: `move-to`, `move-by` (payload: pan and tilt in degrees,
 *   `10 -5`), `stop`, `home`, `auto`, `follow` (the number of a track), which `pantiltsink` of the same pipeline and
 *   name (`head`) gets as its action signal, and `arm`, `disarm`, `privacy`, `picture`, which are for the application
 *   alone. Angles are from -360 to 360. Set `manual-timeout` of `pantiltsink` so that a move ends that is not repeated.
 *   Retained orders are ignored;
 * - `refused`: `command` (NAME) and `error` (string), where an order is refused or the head does not take it; not
 *   retained.
 *
 * The action signal `publish` (name, bytes, retain) publishes what the application adds: `cerberusd` its topics `event`
 * and `picture`. It returns whether the element has been started.
 *
 * With `discovery-prefix` (`homeassistant`) Home Assistant finds the camera by itself.
 *
 * The connection is made in a thread of its own, and tried again once a second for ever: a warning reports its
 * loss once. Retained topics are sent anew at every connection, `track` only while there is one.
 *
 * Posts element messages `cerberus-command` with `name` (string), `done` (boolean: the head took the order) for every
 * order that was allowed, and `cerberus-publish` with `topic` and `payload` (strings) for every message whose topic is
 * in `post-topics`, also without a broker (`host=""`). Of refused orders ten at once and then one a second are
 * reported.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! motiondetect ! \
 *     mqttpublish host=127.0.0.1 camera-name=front ! fakesink
 * ]|
 *
 * Since: 0.1
 */
#include <cerberus/cerberus.h>
#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "cerberus/private/element.hpp"
#include "mqtt_client.hpp"
#include "publish/burst_limit.h"
#include "publish/mqtt_report.h"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/properties.hpp"
#include "shared/settings_query.hpp"
#include "shared/stamps.hpp"
#include "text/file.h"
#include "text/json_line.h"
#include "threads/in_order.h"

namespace {

using namespace cerberus;

GST_DEBUG_CATEGORY_STATIC(mqttpublish_debug);
#define GST_CAT_DEFAULT mqttpublish_debug

GstStaticPadTemplate sink_template =
    GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));
GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw(ANY)"));

struct Settings {
  std::string host = "127.0.0.1";
  int port = 1883;
  std::string user, password_file, ca_file;
  std::string prefix = "cerberus";
  std::string camera_name;
  std::string discovery;
  std::string commands;
  std::string head = "head";
  std::string mode;
  bool recorder = false;
  std::string post_topics;
};

using plugin::property;
const plugin::Property<Settings> kProperties[] = {
    property("host", &Settings::host, "Name or address of the broker; empty = none").read_at_start(),
    property("port", &Settings::port, 1, 65535, "Port of the broker: 1883, with TLS 8883").read_at_start(),
    property("username", &Settings::user, "Name for the broker; empty = none").read_at_start(),
    property("password-file", &Settings::password_file,
             "File whose first line is the password for the broker")
        .read_at_start(),
    property("ca-file", &Settings::ca_file,
             "Certificates that the broker's is checked against; empty = no TLS")
        .read_at_start(),
    property("topic-prefix", &Settings::prefix, "First level of all topics").read_at_start(),
    property("camera-name", &Settings::camera_name, "Second level of all topics; empty = camera")
        .read_at_start(),
    property("discovery-prefix", &Settings::discovery,
             "Where Home Assistant looks for devices, as homeassistant; empty = nothing is published there")
        .read_at_start(),
    property("commands", &Settings::commands,
             "Orders that are taken, parted by blanks or commas, of move-to move-by stop home auto follow "
             "arm disarm privacy picture; empty = none")
        .read_at_start(),
    property("head", &Settings::head, "Name of the head that orders are for"),
    property("mode", &Settings::mode, "What the topic mode says; empty = nothing"),
    property("recorder", &Settings::recorder,
             "Whether the application publishes the topic recording, so that Home Assistant finds it; false "
             "= it does not"),
    property(
        "post-topics", &Settings::post_topics,
        "Topics whose messages are posted on the bus too, parted by blanks or commas, as track mode state; "
        "empty = none"),
};

struct Private {
  plugin::Adjustable<Settings> settings;
  plugin::MqttClient client;
  std::string mode_topic;        // object lock; empty: not started
  publish::BurstLimit refusals;  // client's thread
  std::mutex lock;               // of report
  std::optional<publish::MqttReport> report;
  threads::InOrder<std::vector<publish::MqttMessage>> messages;  // of report
  GstClockID ticker = nullptr;                                   // start() and stop()
  // Streaming thread, and start() and stop():
  plugin::Stamps stamps;
  std::vector<publish::MqttObject> objects;
  std::string discovery;
};

CERBERUS_DEFINE_TYPE(CerberusMqttPublish, cerberus_mqtt_publish, GstBaseTransform, GST_TYPE_BASE_TRANSFORM,
                     Private)

// Publishes a message, and posts it on the bus where its topic is in `post-topics`.
void publish_one(CerberusMqttPublish* self, publish::MqttMessage message) {
  const std::string topics = self->priv->settings.snapshot().post_topics;
  const std::size_t slash = message.topic.rfind('/');
  const std::string name = message.topic.substr(slash == message.topic.npos ? 0 : slash + 1);
  if (publish::is_listed(name, topics) &&
      g_utf8_validate_len(message.payload.data(), message.payload.size(), nullptr))
    gst_element_post_message(
        GST_ELEMENT(self),
        gst_message_new_element(
            GST_OBJECT(self), gst_structure_new("cerberus-publish", "topic", G_TYPE_STRING, name.c_str(),
                                                "payload", G_TYPE_STRING, message.payload.c_str(), nullptr)));
  self->priv->client.publish(std::move(message));
}

std::chrono::microseconds now() {
  return std::chrono::microseconds(g_get_monotonic_time());
}

// Publishes what ask(report) returns. Frames and the ticker come in threads of their own: what is published last is the
// newest.
template <typename Ask>
void publish_from(CerberusMqttPublish* self, Ask ask) {
  Private& p = *self->priv;
  {
    const std::lock_guard guard(p.lock);
    if (!p.report) return;
    std::vector<publish::MqttMessage> messages = ask(*p.report);
    if (messages.empty()) return;
    p.messages.put(std::move(messages));
  }
  p.messages.deliver([self](const std::vector<publish::MqttMessage>& messages) {
    for (const publish::MqttMessage& message : messages) publish_one(self, message);
  });
}

// Looks every second whether frames still come.
void start_ticker(CerberusMqttPublish* self) {
  g_autoptr(GstClock) clock = gst_system_clock_obtain();
  self->priv->ticker = gst_clock_new_periodic_id(clock, gst_clock_get_time(clock) + GST_SECOND, GST_SECOND);
  gst_clock_id_wait_async(
      self->priv->ticker,
      [](GstClock*, GstClockTime, GstClockID, gpointer data) -> gboolean {
        auto* element = static_cast<CerberusMqttPublish*>(data);
        guarded(element, [&] { publish_from(element, [](auto& report) { return report.check(now()); }); });
        return TRUE;
      },
      gst_object_ref(self), gst_object_unref);
}

void stop_ticker(CerberusMqttPublish* self) {
  GstClockID ticker = std::exchange(self->priv->ticker, nullptr);
  if (ticker == nullptr) return;
  gst_clock_id_unschedule(ticker);
  gst_clock_id_unref(ticker);
}

// Action signal `publish`.
gboolean cerberus_mqtt_publish_publish(CerberusMqttPublish* self, const gchar* name, GBytes* bytes,
                                       gboolean retain) {
  return guarded(self, FALSE, [&]() -> gboolean {
    GST_OBJECT_LOCK(self);
    const std::string mode_topic = self->priv->mode_topic;
    GST_OBJECT_UNLOCK(self);
    if (mode_topic.empty() || name == nullptr || bytes == nullptr || !publish::is_topic_level(name))
      return FALSE;
    gsize size = 0;
    const auto* data = static_cast<const char*>(g_bytes_get_data(bytes, &size));
    publish_one(self, {mode_topic.substr(0, mode_topic.rfind('/') + 1) + name,
                       std::string(data ? data : "", size), retain != FALSE});
    return TRUE;
  });
}

// The head of this name in the same pipeline; the caller unrefs.
GstElement* find_head(GstElement* self, const std::string& name) {
  GstObject* top = GST_OBJECT(gst_object_ref(self));
  while (GstObject* parent = gst_object_get_parent(top)) {
    gst_object_unref(top);
    top = parent;
  }
  GstElement* found = nullptr;
  if (GST_IS_BIN(top)) {
    GstIterator* heads = gst_bin_iterate_all_by_element_factory_name(GST_BIN(top), "pantiltsink");
    GValue item = G_VALUE_INIT;
    while (!found && gst_iterator_next(heads, &item) == GST_ITERATOR_OK) {
      g_autofree gchar* head = nullptr;
      g_object_get(g_value_get_object(&item), "head", &head, nullptr);
      if (head && name == head) found = GST_ELEMENT(g_value_dup_object(&item));
      g_value_unset(&item);
    }
    gst_iterator_free(heads);
  }
  gst_object_unref(top);
  return found;
}

// Why an order was not carried out, for its sender.
void answer(CerberusMqttPublish* self, const std::string& name, const std::string& error) {
  text::JsonLine line;
  line.open('{').key("command").text(name).key("error").text(error).close('}');
  std::string payload(line.finish());
  payload.pop_back();  // the newline
  GST_OBJECT_LOCK(self);
  const std::string mode_topic = self->priv->mode_topic;
  GST_OBJECT_UNLOCK(self);
  if (!mode_topic.empty())
    publish_one(self,
                {mode_topic.substr(0, mode_topic.rfind('/') + 1) + "refused", std::move(payload), false});
}

// In the client's thread.
void obey(CerberusMqttPublish* self, const std::string& name, const std::string& payload) {
  const Settings settings = self->priv->settings.snapshot();
  std::string error;
  const auto command = publish::parse_mqtt_command(name, payload, settings.commands, error);
  if (!command) {
    if (!self->priv->refusals.take(now())) return;
    answer(self, name, error);
    CERBERUS_ELEMENT_WARNING(self, RESOURCE, SETTINGS,
                             ("The MQTT command \"%s\" is refused: %s.", name.c_str(), error.c_str()),
                             (nullptr));
    return;
  }
  gboolean done = FALSE;
  GstElement* head = find_head(GST_ELEMENT(self), settings.head);
  if (head) {
    const char* signal = command->name.c_str();
    if (command->name == "follow")
      g_signal_emit_by_name(head, signal, static_cast<guint>(command->first), &done);
    else if (publish::arguments_of(name) == 2)
      g_signal_emit_by_name(head, signal, command->first, command->second, &done);
    else if (g_signal_lookup(signal, G_OBJECT_TYPE(head)) != 0)
      g_signal_emit_by_name(head, signal, &done);
    const bool is_for_head = g_signal_lookup(signal, G_OBJECT_TYPE(head)) != 0;
    gst_object_unref(head);
    if (is_for_head && !done && self->priv->refusals.take(now()))
      answer(self, name, "the head does not take it now");
  }
  gst_element_post_message(
      GST_ELEMENT(self),
      gst_message_new_element(
          GST_OBJECT(self), gst_structure_new("cerberus-command", "name", G_TYPE_STRING, name.c_str(), "done",
                                              G_TYPE_BOOLEAN, done, nullptr)));
}

// What is wrong with the settings, for a user; empty: nothing, and `password` is the broker's.
std::string settings_fault(const Settings& settings, std::string& password) {
  const std::string camera = settings.camera_name.empty() ? "camera" : settings.camera_name;
  if (!publish::is_topic_level(settings.prefix) || !publish::is_topic_level(camera))
    return "topic-prefix and camera-name must be levels of a topic, without / + #.";
  if (!settings.discovery.empty() && !publish::is_topic(settings.discovery))
    return "\"" + settings.discovery +
           "\" (discovery-prefix) is no topic: levels with / between them, without + #.";
  if (settings.discovery == settings.prefix)
    return "\"" + settings.prefix +
           "\" is topic-prefix and discovery-prefix: Home Assistant would take states for descriptions. "
           "Give topic-prefix another.";
  if (!settings.ca_file.empty()) {
    constexpr std::size_t kMostCertificates = 1 << 20;  // bytes; a system's whole list has a fifth of it
    const text::File file = text::read_file(settings.ca_file, kMostCertificates);
    if (file.fault != text::File::Fault::none || file.text.find("-----BEGIN ") == file.text.npos)
      return "\"" + settings.ca_file + "\" (ca-file) is no file with certificates in PEM.";
  }
  if (settings.password_file.empty()) return {};
  constexpr std::size_t kMostBytes = 4096;
  const text::File file = text::read_file(settings.password_file, kMostBytes);
  password = file.text.substr(0, file.text.find_first_of("\r\n"));
  if (file.fault == text::File::Fault::none && !password.empty()) return {};
  return "\"" + settings.password_file + "\" (password-file) is no file whose first line is a password.";
}

std::string settings_fault(GstElement* element) {
  std::string password;
  return settings_fault(cerberus_mqtt_publish_self(element)->priv->settings.snapshot(), password);
}

gboolean cerberus_mqtt_publish_start(GstBaseTransform* transform) {
  auto* self = cerberus_mqtt_publish_self(transform);
  return guarded(self, FALSE, [&]() -> gboolean {
    Private& p = *self->priv;
    const Settings settings = p.settings.snapshot();
    const std::string camera = settings.camera_name.empty() ? "camera" : settings.camera_name;
    plugin::MqttServer server{.host = settings.host,
                              .port = settings.port,
                              .user = settings.user,
                              .password = {},
                              .ca_file = settings.ca_file,
                              .client = {},
                              .status = {},
                              .commands = {},
                              .topics = {}};
    if (const std::string wrong = settings_fault(settings, server.password); !wrong.empty()) {
      CERBERUS_ELEMENT_ERROR(self, RESOURCE, SETTINGS, (wrong), (nullptr));
      return FALSE;
    }
    p.stamps.reset();
    p.discovery = settings.discovery;
    const publish::MqttReport report(settings.prefix, camera);
    server.status = report.topic("status");
    // What is not allowed is refused with a warning, where anything is; else nothing is subscribed.
    if (!settings.commands.empty()) server.commands = report.topic("command/");
    GST_OBJECT_LOCK(self);
    p.mode_topic = report.topic("mode");
    GST_OBJECT_UNLOCK(self);
    if (!settings.host.empty())
      p.client.start(server,
                     {.on_command = [self](const std::string& name,
                                           const std::string& payload) { obey(self, name, payload); },
                      .on_message = {},
                      .on_fault =
                          [self](const std::string& fault) {
                            CERBERUS_ELEMENT_WARNING(
                                self, RESOURCE, OPEN_WRITE,
                                ("The MQTT broker cannot be reached; it is tried again: %s.", fault.c_str()),
                                (nullptr));
                          }});
    if (!settings.mode.empty()) publish_one(self, {report.topic("mode"), settings.mode, true});
    {
      const std::lock_guard guard(p.lock);
      p.report.emplace(report);
    }
    publish_from(self, [](auto& each) { return each.begin(); });
    start_ticker(self);
    return TRUE;
  });
}

gboolean cerberus_mqtt_publish_stop(GstBaseTransform* transform) {
  auto* self = cerberus_mqtt_publish_self(transform);
  Private& p = *self->priv;
  GST_OBJECT_LOCK(transform);
  p.mode_topic.clear();
  GST_OBJECT_UNLOCK(transform);
  stop_ticker(self);
  guarded(self, [&] { publish_from(self, [](auto& report) { return report.end(); }); });
  {
    const std::lock_guard guard(p.lock);
    p.report.reset();
  }
  p.client.stop();
  return TRUE;
}

publish::MqttObject object_of(const CerberusRegion& region) {
  return {.id = region.id,
          .type = region.person ? "person" : "motion",
          .kind = cerberus_region_kind_get_nick(region.kind),
          .state = cerberus_region_state_get_nick(region.state),
          .x = region.x,
          .y = region.y,
          .width = region.width,
          .height = region.height,
          .confidence = region.confidence,
          .bearing = region.bearing,
          .distance = region.distance,
          .motion = region.motion != FALSE,
          .person = region.person != FALSE};
}

void read_frame(Private& p, GstBuffer* buffer, const CerberusStamp& stamp, publish::MqttFrame& frame) {
  p.objects.clear();
  frame.analysed = cerberus_buffer_regions_known(buffer) != FALSE;
  if (frame.analysed) {
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < regions->len; ++i) {
      const auto& region = *static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
      if (region.tracked) p.objects.push_back(object_of(region));
    }
  }
  frame.objects = p.objects;
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(buffer))
    if (const auto look = plugin::look_of(*pose, stamp.running_time))
      frame.head = {sensing::degrees(look->pan), sensing::degrees(look->tilt), pose->moving != FALSE};
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer)) {
    frame.decision = {fusion->rule, fusion->rule_name ? fusion->rule_name : "",
                      cerberus_fusion_action_get_nick(fusion->action), fusion->target};
    frame.sensors = {fusion->sensors, std::min<std::size_t>(fusion->n_sensors, CERBERUS_PIR_MAX_SENSORS)};
  }
}

GstFlowReturn cerberus_mqtt_publish_transform_ip(GstBaseTransform* transform, GstBuffer* buffer) {
  auto* self = cerberus_mqtt_publish_self(transform);
  return guarded(self, GST_FLOW_ERROR, [&] {
    Private& p = *self->priv;
    const GstClockTime time = plugin::running_time_of(transform->segment, buffer);
    const CerberusStamp stamp = p.stamps.frame(GST_BASE_TRANSFORM_SINK_PAD(transform), buffer, time, {});
    publish::MqttFrame frame;
    if (GST_CLOCK_TIME_IS_VALID(time)) frame.time = plugin::time_of(time);
    frame.utc = plugin::known_time(stamp.utc);
    frame.arrival = now();
    read_frame(p, buffer, stamp, frame);
    if (!p.discovery.empty()) {
      const bool recorder = p.settings.snapshot().recorder;
      publish_from(self, [&](auto& report) { return report.discovery_of(frame, p.discovery, recorder); });
    }
    publish_from(self, [&](auto& report) { return report.update(frame); });
    return GST_FLOW_OK;
  });
}

gboolean cerberus_mqtt_publish_sink_event(GstBaseTransform* transform, GstEvent* event) {
  auto* self = cerberus_mqtt_publish_self(transform);
  if (GST_EVENT_TYPE(event) == GST_EVENT_EOS)
    guarded(self, [&] { publish_from(self, [](auto& report) { return report.end(); }); });
  return GST_BASE_TRANSFORM_CLASS(cerberus_mqtt_publish_parent_class())->sink_event(transform, event);
}

void cerberus_mqtt_publish_init(CerberusMqttPublish* self) {
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_qos_enabled(GST_BASE_TRANSFORM(self), FALSE);
}

// The mode is published at once: in privacy no frame may come.
void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  auto* self = cerberus_mqtt_publish_self(object);
  self->priv->settings.set(kProperties, id, value);
  if (g_strcmp0(spec->name, "mode") != 0) return;
  GST_OBJECT_LOCK(self);
  const std::string topic = self->priv->mode_topic;
  GST_OBJECT_UNLOCK(self);
  const gchar* mode = g_value_get_string(value);
  if (!topic.empty() && mode) publish_one(self, {topic, mode, true});
}

void cerberus_mqtt_publish_class_init(CerberusMqttPublishClass* klass) {
  plugin::install_properties<CerberusMqttPublish, kProperties>(G_OBJECT_CLASS(klass));
  G_OBJECT_CLASS(klass)->set_property = set_property;
  g_signal_new_class_handler("publish", G_TYPE_FROM_CLASS(klass),
                             static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION),
                             G_CALLBACK(cerberus_mqtt_publish_publish), nullptr, nullptr, nullptr,
                             G_TYPE_BOOLEAN, 3, G_TYPE_STRING, G_TYPE_BYTES, G_TYPE_BOOLEAN);
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, "MQTT publisher", "Filter/Network/Video",
                                        "Publishes what was found by MQTT, and takes orders for the head",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &sink_template);
  gst_element_class_add_static_pad_template(element, &src_template);
  element->query = settings_query<cerberus_mqtt_publish_parent_class, settings_fault>;
  GstBaseTransformClass* transform = GST_BASE_TRANSFORM_CLASS(klass);
  transform->start = cerberus_mqtt_publish_start;
  transform->stop = cerberus_mqtt_publish_stop;
  transform->sink_event = cerberus_mqtt_publish_sink_event;
  transform->transform_ip = cerberus_mqtt_publish_transform_ip;
}

}  // namespace

CERBERUS_REGISTER_ELEMENT(mqttpublish, GST_RANK_NONE, cerberus_mqtt_publish, mqttpublish_debug,
                          "publishes by MQTT")
