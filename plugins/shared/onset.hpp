// SPDX-License-Identifier: LGPL-2.1-or-later
// A PIR sensor that covers a part of the picture has begun to detect: `pirfusion` asks the person detector upstream for a look
// at once, by an event.
#pragma once

#include <gst/gst.h>

#include <mutex>
#include <thread>
#include <utility>

namespace cerberus::plugin {

constexpr char kOnsetEvent[] = "cerberus-onset";

inline GstEvent* new_onset_event() {
  return gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty(kOnsetEvent));
}

// From any thread to the streaming thread.
class OnsetFlag {
 public:
  void hear(GstEvent* event) {
    if (!gst_event_has_name(event, kOnsetEvent)) return;
    const std::lock_guard guard(lock_);
    heard_ = true;
    thread_ = std::this_thread::get_id();
  }
  // In the streaming thread: whether one has come since the last call. One that comes through a queue in a stream that is not
  // live is ignored: each run would meet it at another frame.
  bool take(bool live) {
    const std::lock_guard guard(lock_);
    return std::exchange(heard_, false) && (live || thread_ == std::this_thread::get_id());
  }

 private:
  std::mutex lock_;
  bool heard_ = false;
  std::thread::id thread_;
};

}  // namespace cerberus::plugin
