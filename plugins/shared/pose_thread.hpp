// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides whether pose events are used for the frames of a stream. Without a queue between this element and the head,
// the head answers each frame in the thread that pushes it: every run has the same poses for the same frame. Through a
// queue the answer arrives some frames later, and how many depends on the load of the machine. Live that is as good as
// it gets; in a stream that is not live such poses are ignored, so that equal runs give equal results.
#pragma once

#include <gst/gst.h>

#include <mutex>
#include <optional>
#include <thread>

#include "cerberus/private/element.hpp"
#include "cerberus/private/messages.hpp"
#include "clock_times.hpp"

namespace cerberus::plugin {

class PoseThread {
 public:
  // A pose of the element's head was received, in any thread.
  void on_pose(const char* head) {
    const std::lock_guard guard(lock_);
    last_ = std::this_thread::get_id();
    head_ = head;
  }
  // In the streaming thread, for a frame without a pose of its own; no lock held. The first time that poses are ignored
  // `element` posts a warning.
  bool poses_count(GstElement* element) {
    const char* head = nullptr;
    {
      const std::lock_guard guard(lock_);
      in_step_ = in_step_ || last_ == std::this_thread::get_id();
      if (in_step_ || last_ == std::thread::id())
        return in_step_;  // one that comes just now is for the next frame
      head = head_;
    }
    if (!live_) {
      g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
      live_ = is_live(sink).value_or(true);
      if (!*live_)
        CERBERUS_ELEMENT_WARNING(element, STREAM, FAILED,
                                 ("The poses of the head \"%s\" are ignored: they come through a queue, and "
                                  "the stream is not live, so that "
                                  "each run would use them for other frames. Remove the queue, let "
                                  "virtualptz make the frames, or mark the "
                                  "source as live.",
                                  head),
                                 (nullptr));
    }
    return *live_;
  }
  void forget() {
    const std::lock_guard guard(lock_);
    last_ = {};
    in_step_ = false;
    live_.reset();
  }

 private:
  std::mutex lock_;  // of all but live_
  std::thread::id last_;
  const char* head_ = nullptr;  // interned
  bool in_step_ = false;        // a pose has come in the streaming thread
  std::optional<bool> live_;    // streaming thread
};

}  // namespace cerberus::plugin
