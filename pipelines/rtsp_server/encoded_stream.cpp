// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/encoded_stream.h"

#include <gst/video/video.h>

#include <algorithm>
#include <utility>

namespace cerberus::rtsp {
namespace {

// Stamps in running time: encoders begin anywhere (x264enc at 1000 hours).
GstBuffer* in_running_time(GstBuffer* buffer, const GstSegment* segment) {
  GstBuffer* frame = gst_buffer_copy(buffer);  // of the stamps; the bytes are shared
  const auto running_time = [segment](GstClockTime time) {
    return gst_segment_to_running_time(segment, GST_FORMAT_TIME, time);
  };
  GST_BUFFER_PTS(frame) = running_time(GST_BUFFER_PTS(buffer));
  GST_BUFFER_DTS(frame) = running_time(GST_BUFFER_DTS(buffer));
  return frame;
}

}  // namespace

EncodedStream::EncodedStream(GstAppSink* sink, GstElement* valve, std::string name)
    : sink_(GST_APP_SINK(gst_object_ref(sink))),
      valve_(valve ? GST_ELEMENT(gst_object_ref(valve)) : nullptr),
      name_(std::move(name)) {}

std::shared_ptr<EncodedStream> EncodedStream::make(GstAppSink* sink, GstElement* valve, std::string name) {
  std::shared_ptr<EncodedStream> stream(new EncodedStream(sink, valve, std::move(name)));
  // Frames are sent when they come; a stream without frames keeps no other one from starting.
  g_object_set(sink, "sync", FALSE, "async", FALSE, nullptr);
  GstAppSinkCallbacks callbacks = {};
  callbacks.new_sample = on_sample;
  gst_app_sink_set_callbacks(sink, &callbacks, new std::weak_ptr<EncodedStream>(stream), [](gpointer holder) {
    delete static_cast<std::weak_ptr<EncodedStream>*>(holder);
  });
  return stream;
}

EncodedStream::~EncodedStream() {
  GstAppSinkCallbacks none = {};
  gst_app_sink_set_callbacks(sink_.get(), &none, nullptr, nullptr);
  gst_clear_caps(&caps_);
}

GstCaps* EncodedStream::caps() const {
  const std::lock_guard lock(mutex_);
  return caps_ ? gst_caps_ref(caps_) : nullptr;
}

void EncodedStream::add(GstAppSrc* receiver) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  gst_app_src_set_caps(receiver, caps_);
  receivers_.push_back({Ref<GstAppSrc>(GST_APP_SRC(gst_object_ref(receiver))), {}});
  set_valve();
}

void EncodedStream::remove(GstAppSrc* receiver) {
  const std::lock_guard lock(mutex_);
  std::erase_if(receivers_, [receiver](const Receiver& each) { return each.source.get() == receiver; });
  set_valve();
}

// The stream begins in any case: its caps are part of a mount's description. (The valve asks upstream for a new
// negotiation, which does not lead here.)
void EncodedStream::set_valve() {
  if (valve_) g_object_set(valve_.get(), "drop", caps_ && receivers_.empty(), nullptr);
}

void EncodedStream::play(GstAppSrc* receiver) {
  {
    const std::lock_guard lock(mutex_);
    for (Receiver& each : receivers_)
      if (each.source.get() == receiver) each.gate.play();
  }
  request_keyframe();
}

void EncodedStream::request_keyframe() {
  bool ask = false;
  {
    const std::lock_guard lock(mutex_);
    ask = has_delta_frames_ && requests_.request(newest_);
  }
  if (ask) ask_for_keyframe();
}

void EncodedStream::end() {
  const std::lock_guard lock(mutex_);
  for (const Receiver& each : receivers_) gst_app_src_end_of_stream(each.source.get());
}

void EncodedStream::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const Receiver& each : receivers_) gst_app_src_end_of_stream(each.source.get());
  receivers_.clear();
  set_valve();
}

void EncodedStream::reopen() {
  const std::lock_guard lock(mutex_);
  closed_ = false;
}

// Upstream from the sink: every element hands it on until the encoder takes it.
void EncodedStream::ask_for_keyframe() {
  g_autoptr(GstPad) pad = gst_element_get_static_pad(GST_ELEMENT(sink_.get()), "sink");
  guint number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = ++asked_;
  }
  gst_pad_push_event(pad, gst_video_event_new_upstream_force_key_unit(GST_CLOCK_TIME_NONE, TRUE, number));
}

// The pipeline may still run when the server ends: the stream is kept while a frame of it is delivered.
GstFlowReturn EncodedStream::on_sample(GstAppSink* sink, gpointer holder) {
  g_autoptr(GstSample) sample = gst_app_sink_pull_sample(sink);
  const std::shared_ptr<EncodedStream> stream = static_cast<std::weak_ptr<EncodedStream>*>(holder)->lock();
  if (sample && stream) stream->deliver(sample);
  return GST_FLOW_OK;
}

void EncodedStream::deliver(GstSample* sample) {
  GstBuffer* buffer = gst_sample_get_buffer(sample);
  if (!buffer) return;
  g_autoptr(GstBuffer) frame = in_running_time(buffer, gst_sample_get_segment(sample));
  const bool keyframe = !GST_BUFFER_FLAG_IS_SET(frame, GST_BUFFER_FLAG_DELTA_UNIT);
  bool ask = false;
  {
    // A receiver's queue takes a frame without waiting: nothing can hold this lock up.
    const std::lock_guard lock(mutex_);
    if (GST_BUFFER_PTS_IS_VALID(frame)) newest_ = std::chrono::nanoseconds(GST_BUFFER_PTS(frame));
    has_delta_frames_ = has_delta_frames_ || !keyframe;
    ask = requests_.frame(newest_, keyframe);
    if (!caps_ || !gst_caps_is_equal(caps_, gst_sample_get_caps(sample))) {
      gst_caps_replace(&caps_, gst_sample_get_caps(sample));
      for (const Receiver& each : receivers_) gst_app_src_set_caps(each.source.get(), caps_);
      set_valve();
    }
    for (Receiver& each : receivers_) {
      const auto waiting = gst_app_src_get_current_level_buffers(each.source.get());
      if (each.gate.pass(keyframe, waiting))
        gst_app_src_push_buffer(each.source.get(), gst_buffer_ref(frame));
      else if (each.gate.wants_keyframe(waiting))
        ask = requests_.request(newest_) || ask;
    }
  }
  if (ask) ask_for_keyframe();
}

}  // namespace cerberus::rtsp
