// SPDX-License-Identifier: LGPL-2.1-or-later
// What leaves a camera while it runs: pictures and facts for the page, messages for MQTT, streams for RTSP.
#include "camera_pictures.h"

#include <cerberus/cerberus.h>
#include <gst/app/gstappsink.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot/page/events.h"
#include "text/json_line.h"

namespace cerberus::robot {

namespace {

constexpr double kParked = 1;  // degrees from zero: several steps of the coarsest motors

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

// In front of the decoder and of the detection, so that what is late costs next to nothing and the next frame is younger.
// One thread goes through both. A file and a simulated robot wait for their reader and are never late.
void Camera::drop_late_frames() {
  if (waits_for_reader(settings_.source.kind)) return;
  late_ = {};
  for (const char* name : {"decoder", "detect"}) {
    g_autoptr(GstElement) found = element(name);
    if (found == nullptr) continue;  // the source's frames are not encoded
    g_autoptr(GstPad) pad = gst_element_get_static_pad(found, "sink");
    const bool encoded = g_str_equal(name, "decoder");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, encoded ? drop_if_late<true> : drop_if_late<false>,
                      this, nullptr);
  }
}

template <bool encoded>
GstPadProbeReturn Camera::drop_if_late(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  auto& camera = *static_cast<Camera*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  const std::chrono::nanoseconds now(std::chrono::steady_clock::now().time_since_epoch());
  const std::chrono::nanoseconds held =
      camera.settings_.source.kind == SourceKind::rtsp ? kNetworkLatency : std::chrono::nanoseconds(0);
  const std::chrono::nanoseconds age = std::chrono::nanoseconds(age_of(pad, buffer)) - held;
  const bool keyframe = !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT);
  const bool drop = encoded ? camera.late_.drop_encoded(age, keyframe, now) : camera.late_.drop(age, now);
  camera.late_frames_ += camera.late_.report(now);
  camera.came_ = true;
  return drop ? GST_PAD_PROBE_DROP : GST_PAD_PROBE_OK;
}

void Camera::connect() {
  drop_late_frames();
  if (settings_.source.kind == SourceKind::rtsp) {
    const std::pair<const char*, RtspSource*> sources[] = {{"source", &offered_},
                                                           {"recorded", &offered_record_}};
    for (const auto& [name, offered] : sources) {
      g_autoptr(GstElement) source = element(name);
      if (source) offered->watch(source, settings_.source.codec);
    }
  }
  drop_frames("picture-queue", draw_);
  drop_frames("stage-queue", draw_stage_);
  drop_frames("record-queue", record_);
  drop_frames("analysis-queue", record_);
  // Where all that analyses is behind the frame, a person detector included.
  g_autoptr(GstElement) fusion = element("fusion");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(fusion, "sink");
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

// Whether an event is being recorded, and why recording fails, where it changed.
void Camera::publish_recording() {
  if (!shared_.mqtt || !settings_.recorder) return;
  text::JsonLine line;
  line.open('{').key("recording").boolean(is_recording()).key("fault").text(recording_fault_).close('}');
  std::string_view text = line.finish();
  text.remove_suffix(1);  // the newline
  if (text == published_recording_) return;
  g_autoptr(GBytes) payload = g_bytes_new(text.data(), text.size());
  if (publish("recording", payload, true)) published_recording_ = text;
}

// Asks for a picture that is drawn from now on: while nobody looks there is none, or an old one.
void Camera::publish_picture() {
  const std::lock_guard lock(newest_->lock);
  if (!newest_->show) return;
  picture_asked_after_ = std::max<guint64>(newest_->number, 1);
  update_draw();
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

void Camera::send_asked_picture() {
  guint64 number = 0;
  g_autoptr(GBytes) newest = picture(number);
  if (picture_asked_after_ == 0 || newest == nullptr || number <= picture_asked_after_) return;
  picture_asked_after_ = 0;
  set_watched(watched_);
  publish("picture", newest, false);
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

}  // namespace cerberus::robot
