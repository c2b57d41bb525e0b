// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera.h"

#include <cerberus/cerberus.h>
#include <gst/app/gstappsink.h>
#include <unistd.h>

#include <cmath>
#include <utility>

#include "robot/events.h"
#include "text/numbers.h"

namespace cerberus::robot {

// What the streaming threads left for the main loop; lives as long as a callback may run.
struct Camera::Newest {
  ~Newest() { g_clear_pointer(&picture, g_bytes_unref); }

  std::mutex lock;
  Camera* camera = nullptr;  // nullptr: it is gone; main loop's thread
  GBytes* picture = nullptr;
  guint64 number = 0;
  std::string facts;
  bool show = false;       // else what arrives is dropped
  bool announced = false;  // a call of on_picture is on its way
};

namespace {

constexpr const char* kStates[] = {"off", "running", "parking", "ending", "closing", "waiting", "ended"};

constexpr double kParked = 1;  // degrees from zero: several steps of the coarsest motors

void say(const std::string& camera, const std::string& text) {
  g_printerr("cerberusd: %s: %s\n", camera.c_str(), text.c_str());
}

std::string seconds(Camera::Clock::duration duration) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(duration).count()) + " s";
}

// Time since a frame's capture, which its time stamp is, in ns; 0: it is not known.
gint64 age_of(GstPad* pad, GstBuffer* buffer) {
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  g_autoptr(GstElement) parent = gst_pad_get_parent_element(pad);
  if (!event || !parent) return 0;
  const GstSegment* segment = nullptr;
  gst_event_parse_segment(event, &segment);
  const GstClockTime time = gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer)),
                     now = gst_element_get_current_running_time(parent);
  return GST_CLOCK_TIME_IS_VALID(time) && GST_CLOCK_TIME_IS_VALID(now) ? GST_CLOCK_DIFF(time, now) : 0;
}

}  // namespace

const char* name(Camera::State state) {
  return kStates[static_cast<int>(state)];
}

Camera::Camera(const CameraSettings& settings, SharedSettings shared, RtspOutput& rtsp, OnOrder on_order)
    : settings_(settings),
      shared_(std::move(shared)),
      rtsp_(rtsp),
      on_order_(std::move(on_order)),
      newest_(std::make_shared<Newest>()) {
  newest_->camera = this;
}

Camera::~Camera() {
  rtsp_.forget(settings_.name, pipeline_);
  newest_->camera = nullptr;
  if (bus_watch_ != 0) g_source_remove(bus_watch_);
  if (pipeline_ == nullptr) return;
  gst_element_set_state(pipeline_, GST_STATE_NULL);
  g_clear_pointer(&head_, gst_object_unref);
  g_clear_pointer(&recorder_, gst_object_unref);
  gst_object_unref(pipeline_);
}

GstElement* Camera::element(const char* name) const {
  return gst_bin_get_by_name(GST_BIN(pipeline_), name);
}

// Drops the buffers that would enter a queue while `pass` is false.
void Camera::drop_frames(const char* queue, std::atomic<bool>& pass) {
  g_autoptr(GstElement) found = element(queue);
  if (found == nullptr) return;
  g_autoptr(GstPad) pad = gst_element_get_static_pad(found, "sink");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo*, gpointer flag) {
        return *static_cast<std::atomic<bool>*>(flag) ? GST_PAD_PROBE_OK : GST_PAD_PROBE_DROP;
      },
      &pass, nullptr);
}

void Camera::connect() {
  drop_frames("picture-queue", draw_);
  drop_frames("stage-queue", draw_stage_);
  drop_frames("record-queue", record_);
  drop_frames("analysis-queue", record_);
  g_autoptr(GstElement) detect = element("detect");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(detect, "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad* pad, GstPadProbeInfo* info, gpointer data) {
        auto& camera = *static_cast<Camera*>(data);
        ++camera.frames_;
        camera.latency_ = age_of(pad, GST_PAD_PROBE_INFO_BUFFER(info));
        const CerberusPose* pose = cerberus_buffer_peek_pose(GST_PAD_PROBE_INFO_BUFFER(info));
        camera.parked_ = pose != nullptr && !pose->moving && std::abs(pose->pan) < kParked &&
                         std::abs(pose->tilt) < kParked;
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);

  using Holder = std::shared_ptr<Newest>;
  const auto free_holder = [](gpointer holder) { delete static_cast<Holder*>(holder); };
  GstAppSinkCallbacks on_facts{};
  on_facts.new_sample = [](GstAppSink* sink, gpointer data) {
    g_autoptr(GstSample) sample = gst_app_sink_pull_sample(sink);
    GstBuffer* buffer = sample ? gst_sample_get_buffer(sample) : nullptr;
    GstMapInfo map;
    if (buffer == nullptr || !gst_buffer_map(buffer, &map, GST_MAP_READ)) return GST_FLOW_OK;
    Newest& newest = **static_cast<Holder*>(data);
    const std::size_t size = map.size > 0 && map.data[map.size - 1] == '\n' ? map.size - 1 : map.size;
    {
      const std::lock_guard lock(newest.lock);
      if (newest.show) newest.facts.assign(reinterpret_cast<const char*>(map.data), size);
    }
    gst_buffer_unmap(buffer, &map);
    return GST_FLOW_OK;
  };
  GstAppSinkCallbacks on_picture{};
  on_picture.new_sample = [](GstAppSink* sink, gpointer data) {
    g_autoptr(GstSample) sample = gst_app_sink_pull_sample(sink);
    GstBuffer* buffer = sample ? gst_sample_get_buffer(sample) : nullptr;
    gpointer bytes = nullptr;
    gsize size = 0;
    if (buffer == nullptr) return GST_FLOW_OK;
    gst_buffer_extract_dup(buffer, 0, static_cast<gsize>(-1), &bytes, &size);
    g_autoptr(GBytes) drawn = g_bytes_new_take(bytes, size);
    const Holder& holder = *static_cast<Holder*>(data);
    bool announce = false;
    {
      const std::lock_guard lock(holder->lock);
      if (!holder->show) return GST_FLOW_OK;
      std::swap(holder->picture, drawn);
      ++holder->number;
      announce = !std::exchange(holder->announced, true);
    }
    if (!announce) return GST_FLOW_OK;
    g_main_context_invoke_full(
        nullptr, G_PRIORITY_DEFAULT,
        [](gpointer data) {
          Newest& newest = **static_cast<Holder*>(data);
          {
            const std::lock_guard lock(newest.lock);
            newest.announced = false;
          }
          Camera* camera = newest.camera;
          if (camera == nullptr) return static_cast<gboolean>(G_SOURCE_REMOVE);
          camera->send_asked_picture();
          if (camera->on_picture_) camera->on_picture_(*camera);
          return static_cast<gboolean>(G_SOURCE_REMOVE);
        },
        new Holder(holder), [](gpointer data) { delete static_cast<Holder*>(data); });
    return GST_FLOW_OK;
  };
  g_autoptr(GstElement) facts = element("facts");
  if (facts) gst_app_sink_set_callbacks(GST_APP_SINK(facts), &on_facts, new Holder(newest_), free_holder);
  for (const char* name : {"picture", "stage-picture"}) {
    g_autoptr(GstElement) picture = element(name);
    if (picture)
      gst_app_sink_set_callbacks(GST_APP_SINK(picture), &on_picture, new Holder(newest_), free_holder);
  }
}

bool Camera::publish(const char* topic, GBytes* payload, bool retain) {
  if (!shared_.mqtt || pipeline_ == nullptr) return false;
  g_autoptr(GstElement) mqtt = element("mqtt");
  gboolean done = FALSE;
  if (mqtt) g_signal_emit_by_name(mqtt, "publish", topic, payload, static_cast<gboolean>(retain), &done);
  return done;
}

void Camera::publish_event() {
  if (!shared_.mqtt || !settings_.recorder) return;
  std::string fault;
  const std::string text = Events(settings_.recorder->folder).newest(settings_.name, fault);
  if (!fault.empty()) return;  // the page says so where it is asked for
  g_autoptr(GBytes) payload = g_bytes_new(text.data(), text.size());
  publish("event", payload, true);
}

// Asks for a picture that is drawn from now on: while nobody looks there is none, or an old one.
void Camera::publish_picture() {
  const std::lock_guard lock(newest_->lock);
  if (!newest_->show) return;
  picture_asked_after_ = std::max<guint64>(newest_->number, 1);
  update_draw();
}

void Camera::start() {
  again_ = stale_ = false;
  since_ = last_frame_ = Clock::now();
  const PipelineText text = pipeline_text(settings_, shared_, parts_);
  GST_DEBUG("%s: %s", settings_.name.c_str(), text.line.c_str());
  g_autoptr(GError) error = nullptr;
  pipeline_ = gst_parse_launch_full(text.line.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error);
  std::string wrong = error ? error->message : "";
  if (pipeline_ == nullptr) {
    state_ = State::waiting;
    fail("camera", "a part of GStreamer is missing: " + wrong);
    return;
  }
  head_ = element("head");
  recorder_ = element("recorder");
  state_ = State::running;
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
  bus_watch_ = gst_bus_add_watch(
      bus,
      [](GstBus*, GstMessage* message, gpointer camera) {
        static_cast<Camera*>(camera)->on_message(message);
        return static_cast<gboolean>(G_SOURCE_CONTINUE);
      },
      this);
  if (!wrong.empty() || !apply(text, wrong) || !apply_secrets(wrong)) {
    fail("camera", wrong);
    return;
  }
  connect();
  stage_ = "picture";
  set_triggers();
  publish_mode();
  record_ = true;
  set_show(true);
  // What refuses to start posts an error on the bus.
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  publish_event();
}

// The part of the camera that an element belongs to.
std::string Camera::part_of(GstObject* source) const {
  for (GstObject* object = source; object != nullptr; object = GST_OBJECT_PARENT(object)) {
    if (object == GST_OBJECT(head_)) return "head";
    if (object == GST_OBJECT(recorder_)) return "recorder";
  }
  return "camera";
}

void Camera::fail(const std::string& part, const std::string& text) {
  if (state_ != State::running && state_ != State::waiting) return;
  const Clock::time_point now = Clock::now();
  Clock::duration wait{};
  // A world cannot be without its head.
  if (part == "head" && settings_.source.kind != SourceKind::world) {
    wait = head_backoff_.failed(now);
    parts_.head = false;
    again_ = true;
  } else if (part == "recorder") {
    wait = recorder_backoff_.failed(now);
    parts_.recorder = false;
    again_ = true;
  } else {
    wait = camera_backoff_.failed(now);
  }
  fault_ = part + ": " + text;
  say(settings_.name, fault_ + "; it is tried again in " + seconds(wait));
  close();
}

void Camera::on_report(const GstStructure* report) {
  if (gst_structure_has_name(report, "cerberus-command")) {
    const gchar* order = gst_structure_get_string(report, "name");
    if (g_strcmp0(order, "picture") == 0) publish_picture();
    if (order != nullptr && on_order_) on_order_(order);
    return;
  }
  if (gst_structure_has_name(report, "cerberus-publish")) {
    const gchar *topic = gst_structure_get_string(report, "topic"),
                *payload = gst_structure_get_string(report, "payload");
    if (topic && payload && on_publish_) on_publish_(*this, topic, payload);
    return;
  }
  const gchar* state = gst_structure_get_string(report, "state");
  if (state == nullptr) return;
  if (gst_structure_has_name(report, "cerberus-pantilt")) head_state_ = state;
  if (gst_structure_has_name(report, "cerberus-recording")) {
    gboolean last = FALSE;
    gst_structure_get_boolean(report, "last", &last);
    const std::string_view what = state;
    if (what == "started") recording_ = true;
    if (what == "started" || what == "ended") publish_event();
    if ((what == "ended" && last) || what == "failed") recording_ = false;
  }
}

void Camera::on_message(GstMessage* message) {
  switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_ERROR: {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      fail(part_of(GST_MESSAGE_SRC(message)), error->message);
      break;
    }
    case GST_MESSAGE_WARNING: {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      say(settings_.name, part_of(GST_MESSAGE_SRC(message)) + ": " + error->message);
      break;
    }
    case GST_MESSAGE_EOS:
      if (state_ == State::running) {
        const bool is_file =
            settings_.source.kind == SourceKind::file || settings_.source.kind == SourceKind::world;
        if (!is_file) {
          fail("camera", "the stream ended");
          break;
        }
        again_ = settings_.source.loop;
        wanted_ = wanted_ && again_;
        close();
      } else if (state_ == State::ending) {
        close();
      }
      break;
    case GST_MESSAGE_ELEMENT:
      if (const GstStructure* report = gst_message_get_structure(message)) on_report(report);
      break;
    case GST_MESSAGE_LATENCY:
      gst_bin_recalculate_latency(GST_BIN(pipeline_));
      break;
    default:
      break;
  }
}

// Forgets picture and facts either way: none outlasts the time in which it may be seen.
void Camera::set_show(bool show) {
  picture_asked_after_ = 0;
  if (!show)
    rtsp_.hide(settings_.name, pipeline_);
  else if (shared_.rtsp)
    rtsp_.show(settings_.name, pipeline_);
  const std::lock_guard lock(newest_->lock);
  newest_->show = show;
  update_draw();
  g_clear_pointer(&newest_->picture, g_bytes_unref);
  newest_->facts.clear();
}

void Camera::set_watched(bool watched) {
  watched_ = watched;
  if (!watched && stage_ != "picture") set_stage("picture");
  const std::lock_guard lock(newest_->lock);
  update_draw();
}

// Under the lock of newest_. Pictures are drawn while somebody looks or one was asked for, of one branch.
void Camera::update_draw() {
  const bool draw = (watched_ || picture_asked_after_ > 0) && newest_->show;
  draw_ = draw && stage_ == "picture";
  draw_stage_ = draw && stage_ != "picture";
}

void Camera::set_stage(const std::string& stage) {
  stage_ = stage;
  if (pipeline_ != nullptr) {
    g_autoptr(GstElement) detect = element("detect");
    g_autoptr(GstElement) view = element("stage");
    if (detect && view) {
      if (stage != "picture") gst_util_set_object_arg(G_OBJECT(view), "stage", stage.c_str());
      gst_util_set_object_arg(G_OBJECT(detect), "keep-planes", stage == "picture" ? "never" : "always");
    }
  }
  const std::lock_guard lock(newest_->lock);
  update_draw();
}

bool Camera::set_live(const char* name, const char* property, double value) {
  if (pipeline_ == nullptr || state_ != State::running) return false;
  g_autoptr(GstElement) found = element(name);
  if (!found) return false;
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(found), property);
  if (spec == nullptr) return false;
  const GType type = G_PARAM_SPEC_VALUE_TYPE(spec);
  const bool is_whole = type != G_TYPE_DOUBLE && type != G_TYPE_FLOAT;
  g_auto(GValue) number = G_VALUE_INIT, wanted = G_VALUE_INIT, is = G_VALUE_INIT;
  g_value_init(&number, G_TYPE_DOUBLE);
  g_value_init(&wanted, type);
  g_value_init(&is, type);
  g_value_set_double(&number, is_whole ? std::round(value) : value);
  if (!g_value_transform(&number, &wanted)) return false;
  g_object_set_property(G_OBJECT(found), property, &wanted);
  g_object_get_property(G_OBJECT(found), property, &is);
  return gst_value_compare(&wanted, &is) == GST_VALUE_EQUAL;
}

void Camera::send_asked_picture() {
  guint64 number = 0;
  g_autoptr(GBytes) newest = picture(number);
  if (picture_asked_after_ == 0 || newest == nullptr || number <= picture_asked_after_) return;
  picture_asked_after_ = 0;
  set_watched(watched_);
  publish("picture", newest, false);
}

void Camera::set_mode(Mode mode) {
  if (final_) return;
  const Mode before = std::exchange(mode_, mode);
  publish_mode();
  if (mode == Mode::privacy) {
    wanted_ = again_ = false;
    record_ = false;
    set_show(false);
    if (state_ == State::running && order("home")) {
      state_ = State::parking;
      since_ = Clock::now();
    } else if (state_ == State::running) {
      end();
    } else if (state_ == State::waiting || state_ == State::ended) {
      state_ = State::off;
    }
    return;
  }
  wanted_ = true;
  if (state_ == State::off || (before == Mode::privacy && state_ == State::ended)) {
    start();
  } else if (state_ == State::parking) {  // privacy ended while the head was on its way
    if (std::exchange(stale_, false)) {
      order("stop");
      again_ = true;
      close();
      return;
    }
    order("auto");
    record_ = true;
    set_show(true);
    state_ = State::running;
    set_triggers();
  } else {
    again_ = again_ || state_ == State::ending || state_ == State::closing;
    set_triggers();
  }
}

void Camera::shut_down() {
  final_ = true;
  wanted_ = again_ = false;
  if (state_ == State::running || state_ == State::parking)
    end();
  else if (state_ == State::waiting || state_ == State::ended)
    state_ = State::off;
}

bool Camera::is_stopped() const {
  return state_ == State::off || state_ == State::ended;
}

void Camera::end() {
  if (head_ != nullptr) order("stop");
  state_ = State::ending;
  since_ = Clock::now();
  set_show(false);
  // Sources may be blocked in another thread's hands; the event is handed over there.
  gst_element_call_async(
      pipeline_,
      [](GstElement* pipeline, gpointer) { gst_element_send_event(pipeline, gst_event_new_eos()); }, nullptr,
      nullptr);
}

void Camera::close() {
  if (pipeline_ == nullptr) return;
  state_ = State::closing;
  since_ = Clock::now();
  record_ = false;
  set_show(false);
  if (bus_watch_ != 0) g_source_remove(std::exchange(bus_watch_, 0));
  using Holder = std::shared_ptr<Newest>;
  gst_element_call_async(
      pipeline_,
      [](GstElement* pipeline, gpointer data) {
        gst_element_set_state(pipeline, GST_STATE_NULL);
        g_main_context_invoke_full(
            nullptr, G_PRIORITY_DEFAULT,
            [](gpointer data) {
              if (Camera* camera = (*static_cast<Holder*>(data))->camera) camera->closed();
              return static_cast<gboolean>(G_SOURCE_REMOVE);
            },
            new Holder(*static_cast<Holder*>(data)),
            [](gpointer data) { delete static_cast<Holder*>(data); });
      },
      new Holder(newest_), [](gpointer data) { delete static_cast<Holder*>(data); });
}

void Camera::closed() {
  rtsp_.forget(settings_.name, pipeline_);
  g_clear_pointer(&head_, gst_object_unref);
  g_clear_pointer(&recorder_, gst_object_unref);
  g_clear_pointer(&pipeline_, gst_object_unref);
  rate_ = 0;
  head_state_.clear();
  recording_ = false;
  if (again_ && wanted_) {
    start();
  } else if (wanted_) {
    state_ = State::waiting;
  } else {
    state_ = final_ || mode_ == Mode::privacy ? State::off : State::ended;
  }
}

void Camera::tick() {
  const Clock::time_point now = Clock::now();
  const guint64 frames = frames_;
  if (frames != counted_) last_frame_ = now;
  const double interval = std::chrono::duration<double>(now - last_tick_).count();
  if (pipeline_ == nullptr)
    rate_ = 0;
  else if (interval > 0)
    rate_ = static_cast<double>(frames - counted_) / interval;
  counted_ = frames;
  last_tick_ = now;

  switch (state_) {
    case State::running: {
      if (now - last_frame_ > parameters_.stall) {
        fail("camera", "no frame for " + seconds(parameters_.stall));
        break;
      }
      const bool head = !parts_.head && head_backoff_.is_due(now);
      // A disk that is not there yet need not interrupt the camera.
      const bool recorder = !parts_.recorder && recorder_backoff_.is_due(now) &&
                            ::access(settings_.recorder->folder.c_str(), W_OK) == 0;
      if (head || recorder) {
        parts_.head = parts_.head || head;
        parts_.recorder = parts_.recorder || recorder;
        again_ = true;
        close();
      } else if (parts_.head && parts_.recorder && now - since_ > std::chrono::seconds(2) && rate_ > 0) {
        fault_.clear();
      }
      break;
    }
    case State::parking:
      // The order takes a moment until it shows in the poses.
      if (now - since_ > parameters_.parking || (parked_ && now - since_ >= std::chrono::milliseconds(800)))
        end();
      break;
    case State::ending:
      if (now - since_ > parameters_.ending) close();
      break;
    case State::waiting:
      if (wanted_ && camera_backoff_.is_due(now)) start();
      break;
    default:
      break;
  }
}

bool Camera::is_sound() const {
  const Clock::time_point now = Clock::now();
  if (state_ == State::running) return now - last_frame_ <= parameters_.stall + std::chrono::seconds(2);
  if (state_ == State::closing) return now - since_ <= parameters_.closing;
  return true;
}

GBytes* Camera::picture(guint64& number) const {
  const std::lock_guard lock(newest_->lock);
  number = newest_->number;
  return newest_->picture ? g_bytes_ref(newest_->picture) : nullptr;
}

std::string Camera::facts() const {
  const std::lock_guard lock(newest_->lock);
  return newest_->facts;
}

bool Camera::turn(double pan_speed, double tilt_speed) {
  gboolean done = FALSE;
  if (head_ != nullptr && state_ == State::running)
    g_signal_emit_by_name(head_, "turn", pan_speed, tilt_speed, &done);
  return done;
}

bool Camera::order(const char* signal) {
  gboolean done = FALSE;
  if (head_ != nullptr) g_signal_emit_by_name(head_, signal, &done);
  return done;
}

bool Camera::follow(guint track) {
  gboolean done = FALSE;
  if (head_ != nullptr && state_ == State::running) g_signal_emit_by_name(head_, "follow", track, &done);
  return done;
}

}  // namespace cerberus::robot
