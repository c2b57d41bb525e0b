// SPDX-License-Identifier: LGPL-2.1-or-later
#include "job.h"

#include <glib-unix.h>
#include <gst/video/gstvideometa.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace cerberus::demo {

namespace {

constexpr int kPatience = 60;  // seconds for which the watchdog waits for a frame

}  // namespace

Job::Job(GstElement* pipeline, std::string path, std::string folder, const VideoFile& video)
    : pipeline_(pipeline), path_(std::move(path)), folder_(std::move(folder)), video_(video) {
  decode_with_care(pipeline);
  g_autoptr(GstElement) fusion = gst_bin_get_by_name(GST_BIN(pipeline), "fusion");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(fusion, "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_frame, this, nullptr);
}

// Runs in the streaming thread for every frame with its objects.
GstPadProbeReturn Job::on_frame(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto& job = *static_cast<Job*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  ++job.frames_;
  if (GST_BUFFER_PTS_IS_VALID(buffer)) job.position_ = GST_BUFFER_PTS(buffer);
  static const GQuark motion = g_quark_from_static_string("motion"),
                      person = g_quark_from_static_string("person");
  gpointer state = nullptr;
  const std::lock_guard lock(job.mutex_);
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* region = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    if (region->roi_type == motion || region->roi_type == person) job.objects_.insert(region->id);
  }
  return GST_PAD_PROBE_OK;
}

double Job::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

std::size_t Job::objects() const {
  const std::lock_guard lock(mutex_);
  return objects_.size();
}

double Job::ends_early_at() const {
  const GstClockTime end = position_;
  const bool early = !interrupted_ && GST_CLOCK_TIME_IS_VALID(video_.duration) &&
                     end + end / 10 + GST_SECOND < video_.duration;
  return early ? static_cast<double>(end) / GST_SECOND : 0;
}

void Job::end(std::string error) {
  if (error_.empty()) error_ = std::move(error);
  g_main_loop_quit(loop_);
}

// A terminal gets one line that moves, anything else (a log) a line every ten seconds.
gboolean Job::on_progress(gpointer data) {
  auto& job = *static_cast<Job*>(data);
  const guint64 frames = job.frames_;
  if (frames == 0) return G_SOURCE_CONTINUE;
  std::string percent;
  if (GST_CLOCK_TIME_IS_VALID(job.video_.duration))
    percent = std::to_string(
                  std::min<guint64>(100, gst_util_uint64_scale(job.position_, 100, job.video_.duration))) +
              " %, ";
  std::fprintf(stderr, "%s%s%" G_GUINT64_FORMAT " frames, %.1f a second, %zu objects%s",
               job.terminal_ ? "\r\033[K" : "", percent.c_str(), frames, frames / job.seconds(),
               job.objects(), job.terminal_ ? "" : "\n");
  return G_SOURCE_CONTINUE;
}

// A damaged file can leave its demuxer waiting for ever.
gboolean Job::on_watch(gpointer data) {
  auto& job = *static_cast<Job*>(data);
  const guint64 frames = job.frames_;
  job.idle_ = frames == job.watched_frames_ ? job.idle_ + 1 : 0;
  job.watched_frames_ = frames;
  if (job.idle_ < kPatience) return G_SOURCE_CONTINUE;
  job.end(job.name() + ": no frame follows frame " + std::to_string(frames));
  return G_SOURCE_REMOVE;
}

gboolean Job::on_interrupt(gpointer data) {
  auto& job = *static_cast<Job*>(data);
  if (job.interrupted_) {  // the second time: at once, and the MP4 is not finished
    job.end("interrupted");
    return G_SOURCE_CONTINUE;
  }
  job.interrupted_ = true;
  std::fprintf(stderr, "\ndemo: stopping, and finishing the files\n");
  gst_element_send_event(job.pipeline_, gst_event_new_eos());
  return G_SOURCE_CONTINUE;
}

// What went wrong, for users who do not know GStreamer.
std::string Job::explain(GstMessage* message) const {
  g_autoptr(GError) error = nullptr;
  g_autofree gchar* debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  const std::string source = GST_OBJECT_NAME(GST_MESSAGE_SRC(message));
  std::string text;
  if (g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NO_SPACE_LEFT))
    text = "no space left for " + folder_;
  else if (source == "json" || source == "mp4")
    text = "cannot write to " + folder_ + ": " + error->message;
  else if (source == "pir")
    text = std::string("the sensors' recording cannot be used: ") + error->message;
  else if (path_.empty())
    text = error->message;
  else if (frames_ == 0)
    text = not_a_video(path_) + error->message;
  else
    text = path_ + ", after frame " + std::to_string(frames_.load()) + ": " + error->message;
  if (debug && g_getenv("GST_DEBUG")) text += std::string("\n") + debug;
  return text;
}

gboolean Job::on_message(GstBus*, GstMessage* message, gpointer data) {
  auto& job = *static_cast<Job*>(data);
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
    job.end(job.explain(message));
  else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
    job.end({});
  return G_SOURCE_CONTINUE;
}

bool Job::run() {
  loop_ = g_main_loop_new(nullptr, FALSE);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
  gst_bus_add_watch(bus, on_message, this);
  g_unix_signal_add(SIGINT, on_interrupt, this);
  g_unix_signal_add(SIGTERM, on_interrupt, this);
  terminal_ = isatty(STDERR_FILENO);
  g_timeout_add(terminal_ ? 200 : 10000, on_progress, this);
  g_timeout_add_seconds(1, on_watch, this);
  started_ = std::chrono::steady_clock::now();
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  g_main_loop_run(loop_);
  gst_bus_remove_watch(bus);
  g_main_loop_unref(loop_);
  loop_ = nullptr;
  if (terminal_ && frames_ > 0) std::fprintf(stderr, "\r\033[K");
  if (error_.empty() && frames_ == 0) error_ = name() + " has no frame that could be decoded";
  return error_.empty();
}

}  // namespace cerberus::demo
