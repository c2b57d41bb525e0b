// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera.h"

#include <unistd.h>

#include <utility>

#include "camera_pictures.h"

namespace cerberus::robot {

namespace {

constexpr const char* kStates[] = {"off", "running", "parking", "ending", "closing", "waiting", "ended"};

void say(const std::string& camera, const std::string& text) {
  g_printerr("cerberusd: %s: %s\n", camera.c_str(), text.c_str());
}

std::string seconds(Camera::Clock::duration duration) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(duration).count()) + " s";
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
  if (parts_.recorder) recording_fault_.clear();  // its recorder reports its own
  published_recording_.clear();
  if (kept_stopped_ && head_ != nullptr) {  // before the first frame, with which it would follow by itself
    gst_element_set_state(pipeline_, GST_STATE_PAUSED);
    emit("stop");
  }
  // What refuses to start posts an error on the bus.
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  publish_event();
  publish_recording();
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
    recording_fault_ = text;
    parts_.recorder = false;
    again_ = true;
  } else {
    wait = camera_backoff_.failed(now);
  }
  fault_ = part + ": " + text;
  say(settings_.name, fault_ + "; it is tried again in " + seconds(wait));
  close();
}

void Camera::diagnose(GstObject* from, const GError* error, const gchar* debug) {
  if (diagnosing_ || state_ != State::running) return;
  g_autoptr(GstElement) recorded = element("recorded");
  const bool second =
      recorded && (from == GST_OBJECT(recorded) || gst_object_has_as_ancestor(from, GST_OBJECT(recorded)));
  diagnosing_ = true;
  // The answer may come after the camera, or for a pipeline that is no more.
  (second ? offered_record_ : offered_)
      .diagnose(settings_.source, second ? settings_.source.record_uri : settings_.source.uri, error, debug,
                [holder = newest_, pipeline = pipeline_](const std::string& text) {
                  Camera* camera = holder->camera;
                  if (camera != nullptr && camera->diagnosing_ && camera->pipeline_ == pipeline)
                    camera->fail("camera", text);
                });
}

void Camera::on_report(const GstStructure* report) {
  if (gst_structure_has_name(report, "cerberus-command")) {
    const gchar* order = gst_structure_get_string(report, "name");
    if (g_strcmp0(order, "picture") == 0) publish_picture();
    gboolean done = FALSE;
    gst_structure_get_boolean(report, "done", &done);
    if (order != nullptr) note_order(order, done);
    if (order != nullptr && on_order_) on_order_(order);
    return;
  }
  if (gst_structure_has_name(report, "cerberus-publish")) {
    const gchar *topic = gst_structure_get_string(report, "topic"),
                *payload = gst_structure_get_string(report, "payload");
    if (topic && payload && on_publish_) on_publish_(*this, topic, payload);
    return;
  }
  if (gst_structure_has_name(report, "cerberus-base-request")) {
    double yaw_rate = 0;
    if (gst_structure_get_double(report, "yaw-rate", &yaw_rate) && on_base_request_)
      on_base_request_(state_ == State::running ? yaw_rate : 0);
    return;
  }
  const gchar* state = gst_structure_get_string(report, "state");
  if (state == nullptr) return;
  if (gst_structure_has_name(report, "cerberus-pantilt")) {
    const gchar* reason = gst_structure_get_string(report, "reason");
    head_state_ = state;
    head_reason_ = reason ? reason : "";
    gboolean waits = FALSE;
    gst_structure_get_boolean(report, "waits-for-order", &waits);
    head_waits_ = waits;
  }
  if (gst_structure_has_name(report, "cerberus-recording")) {
    gboolean last = FALSE;
    gst_structure_get_boolean(report, "last", &last);
    const std::string_view what = state;
    ++changes_of_recordings_;
    if (what == "fault") {
      const gchar* fault = gst_structure_get_string(report, "fault");
      set_recording_fault(fault ? fault : "unknown");
    }
    if (what == "sound") set_recording_fault("");
    if (what == "started") recording_ = true;
    if (what == "started" || what == "ended") publish_event();
    if ((what == "ended" && last) || what == "failed") recording_ = false;
    publish_recording();
  }
}

// Of the recorder that runs. The first line of the log about it says that recording fails.
void Camera::set_recording_fault(const std::string& text) {
  if (!parts_.recorder || text == recording_fault_) return;
  recording_fault_ = text;
  say(settings_.name, text.empty() ? "recording works again" : "recording fails: " + text);
}

void Camera::on_message(GstMessage* message) {
  switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_ERROR: {
      g_autoptr(GError) error = nullptr;
      g_autofree gchar* debug = nullptr;
      gst_message_parse_error(message, &error, &debug);
      const std::string part = part_of(GST_MESSAGE_SRC(message));
      if (part == "camera" && settings_.source.kind == SourceKind::rtsp)
        diagnose(GST_MESSAGE_SRC(message), error, debug);
      else
        fail(part, error->message);
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
        if (!waits_for_reader(settings_.source.kind)) {
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

void Camera::set_mode(Mode mode) {
  if (final_) return;
  const Mode before = std::exchange(mode_, mode);
  publish_mode();
  if (mode == Mode::privacy) {
    wanted_ = again_ = false;
    record_ = false;
    set_show(false);
    if (state_ == State::running && emit("home")) {
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
      emit("stop");
      again_ = true;
      close();
      return;
    }
    emit(kept_stopped_ ? "stop" : "auto");
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
  emit("stop");
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
  diagnosing_ = false;
  if (pipeline_ == nullptr) return;
  state_ = State::closing;
  since_ = Clock::now();
  record_ = recording_ = false;
  publish_recording();
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
  head_reason_.clear();
  head_waits_ = false;
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
  if (came_.exchange(false) || frames != counted_) last_frame_ = now;
  const double interval = std::chrono::duration<double>(now - last_tick_).count();
  if (pipeline_ == nullptr)
    rate_ = 0;
  else if (interval > 0)
    rate_ = static_cast<double>(frames - counted_) / interval;
  counted_ = frames;
  last_tick_ = now;
  if (const guint64 late = late_frames_.exchange(0); late > 0)
    say(settings_.name,
        std::to_string(late) + (late == 1 ? " frame was" : " frames were") +
            " dropped that came late: the head follows no old picture. If this goes on, the machine "
            "is too slow for this camera: choose a smaller picture or fewer frames a second");

  switch (state_) {
    case State::running: {
      if (now - last_frame_ > parameters_.stall) {
        const bool network = settings_.source.kind == SourceKind::rtsp;
        fail("camera",
             (network ? settings_.source.uri + ": " : "") + "no frame for " + seconds(parameters_.stall));
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

}  // namespace cerberus::robot
