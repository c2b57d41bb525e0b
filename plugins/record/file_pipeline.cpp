// SPDX-License-Identifier: LGPL-2.1-or-later
#include "file_pipeline.hpp"

#include <gst/app/gstappsrc.h>

#include <algorithm>
#include <stdexcept>

namespace cerberus::plugin {

namespace {

// A fragment of this length is written at once. Derived: with the frame that the muxer holds back, the first frames are on
// the disk .5 s after a keyframe at 25 frames a second, and a killed process loses no more. Measured: smaller ones cost
// size (1.6 kB each). Guarded by the benchmark first_bytes.
constexpr guint kFragmentMilliseconds = 400;
// Frames of the first one, which the `moov` follows: a file whose writer is killed before that plays nowhere. Of two
// at every rate, because qtdemux drops a first fragment of one. Guarded by the tests of files that are never closed or cut off.
constexpr double kFirstFrames = 2.2;  // the muxer ends it where another frame would make it longer
constexpr int kUnbuffered = 2;        // filesink: a buffer of 64 KiB would delay the first byte by seconds
// Audio that is so much later than the video is no longer waited for: a muxer writes nothing while one track is silent.
constexpr GstClockTime kSilence = 3 * GST_SECOND;

// The length of the first fragment, as far as the caps tell the rate.
guint first_fragment(GstCaps* caps) {
  gint frames = 0, seconds = 0;
  if (!gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &frames, &seconds) ||
      frames <= 0 || seconds <= 0)
    return kFragmentMilliseconds;
  const double milliseconds = kFirstFrames * 1000 * seconds / frames;
  return static_cast<guint>(std::clamp<double>(milliseconds, 1, G_MAXUINT));
}

GstPadProbeReturn after_first_fragment(GstPad* pad, GstPadProbeInfo* info, gpointer) {
  if (gst_buffer_memcmp(GST_PAD_PROBE_INFO_BUFFER(info), 4, "moov", 4) != 0) return GST_PAD_PROBE_OK;
  g_autoptr(GstElement) muxer = gst_pad_get_parent_element(pad);
  if (muxer) g_object_set(muxer, "fragment-duration", kFragmentMilliseconds, nullptr);
  return GST_PAD_PROBE_REMOVE;
}

GstElement* make(const char* factory, GstElement* bin) {
  GstElement* element = gst_element_factory_make(factory, nullptr);
  if (!element) throw std::runtime_error(std::string("GStreamer's element ") + factory + " is missing");
  gst_bin_add(GST_BIN(bin), element);
  return element;
}

}  // namespace

FilePipeline::FilePipeline(const FileSpec& spec, const std::string& path, Ended ended)
    : pipeline_(GST_ELEMENT(gst_object_ref_sink(gst_pipeline_new(nullptr)))), ended_(std::move(ended)) {
  try {
    build(spec, path);
  } catch (...) {
    gst_object_unref(pipeline_);
    throw;
  }
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
  gst_bus_set_sync_handler(
      bus,
      [](GstBus*, GstMessage* message, gpointer self) {
        static_cast<FilePipeline*>(self)->report(message);
        gst_message_unref(message);
        return GST_BUS_DROP;
      },
      this, nullptr);
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);  // a failure is reported as a message
}

FilePipeline::~FilePipeline() {
  gst_element_set_state(pipeline_, GST_STATE_NULL);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
  gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr);
  gst_object_unref(pipeline_);
}

void FilePipeline::build(const FileSpec& spec, const std::string& path) {
  GstElement* muxer = make(spec.mp4 ? "mp4mux" : "matroskamux", pipeline_);
  GstElement* sink = make("filesink", pipeline_);
  if (spec.mp4) {
    g_object_set(muxer, "fragment-duration", first_fragment(spec.caps[0].get()), nullptr);
    gst_util_set_object_arg(G_OBJECT(muxer), "fragment-mode", "first-moov-then-finalise");
    g_autoptr(GstPad) source = gst_element_get_static_pad(muxer, "src");
    gst_pad_add_probe(source, GST_PAD_PROBE_TYPE_BUFFER, after_first_fragment, nullptr, nullptr);
  }
  g_object_set(sink, "location", path.c_str(), "buffer-mode", kUnbuffered, "sync", FALSE, "async", FALSE,
               nullptr);
  if (!gst_element_link(muxer, sink)) throw std::runtime_error("the muxer cannot be linked");
  for (std::size_t k = 0; k < spec.caps.size(); ++k) {
    Track& track = tracks_.emplace_back();
    if (!spec.caps[k]) continue;
    GstElement* source = make("appsrc", pipeline_);
    g_object_set(source, "caps", spec.caps[k].get(), "format", GST_FORMAT_TIME, "max-bytes", guint64{0},
                 nullptr);
    // Named: a source without a buffer yet would be linked to the first pad that comes.
    if (!gst_element_link_pads(source, "src", muxer, k == 0 ? "video_%u" : "audio_%u")) {
      g_autofree gchar* caps = gst_caps_to_string(spec.caps[k].get());
      throw std::runtime_error(std::string("the container does not take ") + caps);
    }
    track.source = source;
  }
}

void FilePipeline::report(GstMessage* message) {
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
    ended_(nullptr);
  } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
    g_autoptr(GError) error = nullptr;
    g_autofree gchar* detail = nullptr;
    gst_message_parse_error(message, &error, &detail);
    ended_(std::make_shared<FileFault>(
        FileFault{error->message, detail ? detail : "", error->domain == GST_RESOURCE_ERROR}));
  }
}

void FilePipeline::push(int track, GstBuffer* buffer) {
  const auto index = static_cast<std::size_t>(track);
  if (index >= tracks_.size() || !tracks_[index].source || tracks_[index].ended) {
    gst_buffer_unref(buffer);
    return;
  }
  tracks_[index].last = GST_BUFFER_PTS(buffer);
  if (track == 0) video_pushed_ += gst_buffer_get_size(buffer);
  gst_app_src_push_buffer(GST_APP_SRC(tracks_[index].source), buffer);
  if (track != 0) return;
  for (std::size_t k = 1; k < tracks_.size(); ++k)
    if (tracks_[0].last > tracks_[k].last + kSilence) end_track(static_cast<int>(k));
}

void FilePipeline::end_track(int track) {
  Track& ending = tracks_[static_cast<std::size_t>(track)];
  if (ending.source && !ending.ended) gst_app_src_end_of_stream(GST_APP_SRC(ending.source));
  ending.ended = true;
}

void FilePipeline::finish() {
  for (std::size_t k = 0; k < tracks_.size(); ++k) end_track(static_cast<int>(k));
}

std::uint64_t FilePipeline::video_level() const {
  return tracks_[0].source ? gst_app_src_get_current_level_bytes(GST_APP_SRC(tracks_[0].source)) : 0;
}

std::uint64_t FilePipeline::level() const {
  std::uint64_t sum = 0;
  for (const Track& track : tracks_)
    if (track.source) sum += gst_app_src_get_current_level_bytes(GST_APP_SRC(track.source));
  return sum;
}

}  // namespace cerberus::plugin
