// SPDX-License-Identifier: LGPL-2.1-or-later
// An encoded stream of a running pipeline, handed on to the pipelines of an RTSP server: encoded once, sent to all.
#pragma once

#include <gst/app/app.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "publish/streams/keyframe_requests.h"
#include "publish/streams/stream_gate.h"

namespace cerberus::rtsp {

struct Unref {
  template <typename T>
  void operator()(T* object) const {
    gst_object_unref(object);
  }
};
template <typename T>
using Ref = std::unique_ptr<T, Unref>;

class EncodedStream {
 public:
  // `sink` is an appsink of the pipeline; its frames come here from now on. `valve` (or null) is in front of its
  // encoder: it is closed while there is no receiver, which costs nothing then.
  static std::shared_ptr<EncodedStream> make(GstAppSink* sink, GstElement* valve, std::string name);
  ~EncodedStream();
  EncodedStream(const EncodedStream&) = delete;
  EncodedStream& operator=(const EncodedStream&) = delete;

  const std::string& name() const { return name_; }
  // The caps of the stream; null before its first frame. To be unreferenced by the caller.
  GstCaps* caps() const;

  // `receiver` gets what publish::StreamGate says. Its running time is that of the pipeline of `sink`.
  void add(GstAppSrc* receiver);
  void remove(GstAppSrc* receiver);
  // A client of the receiver plays: it gets a keyframe as soon as the encoder can make one.
  void play(GstAppSrc* receiver);
  // A client lost packets, or joined, and needs a keyframe.
  void request_keyframe();

  // The receivers are given the end of the stream.
  void end();
  // From now on there is no receiver, until reopen(): frames that come are given to none.
  void close();
  void reopen();

 private:
  struct Receiver {
    Ref<GstAppSrc> source;
    publish::StreamGate gate;
  };

  EncodedStream(GstAppSink* sink, GstElement* valve, std::string name);
  static GstFlowReturn on_sample(GstAppSink* sink, gpointer holder);
  void deliver(GstSample* sample);
  void set_valve();
  void ask_for_keyframe();

  Ref<GstAppSink> sink_;
  Ref<GstElement> valve_;
  std::string name_;
  mutable std::mutex mutex_;  // all below
  GstCaps* caps_ = nullptr;
  std::vector<Receiver> receivers_;
  publish::KeyframeRequests requests_;
  std::chrono::nanoseconds newest_{0};  // running time of the newest frame
  bool closed_ = false;
  bool has_delta_frames_ = false;  // else every frame is a keyframe, and none is asked for (JPEG, metadata)
  guint asked_ = 0;                // keyframes that were asked for
};

}  // namespace cerberus::rtsp
