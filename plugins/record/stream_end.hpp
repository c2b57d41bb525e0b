// SPDX-License-Identifier: LGPL-2.1-or-later
// The end of the stream that an element posts which is no GstBaseSink.
#pragma once

#include <gst/gst.h>

#include <cstdint>
#include <mutex>
#include <optional>

#include "shared/confirm_playing.hpp"

namespace cerberus::plugin {

class StreamEnd {
 public:
  // An end that is posted when all has been written.
  struct Pending {
    std::uint64_t stream;
    guint32 number;  // of the event
  };
  // All of the present stream has come.
  Pending expect(guint32 number) const {
    const std::lock_guard guard(lock_);
    return {stream_, number};
  }
  // Nothing where the stream goes on since, or another one has begun: a seek may come while a file is being closed.
  void post(GstElement* element, const Pending& end) {
    {
      const std::lock_guard guard(lock_);
      if (end.stream != stream_) return;
      posted_ = end.number;
    }
    confirm_playing(element);
    send(element, end.number);
  }
  // On the way to PLAYING, before the base class: a bin forgets in PAUSED which of its elements have ended.
  void repeat(GstElement* element) const {
    std::optional<guint32> number;
    {
      const std::lock_guard guard(lock_);
      number = posted_;
    }
    if (number) send(element, *number);
  }
  // The stream goes on, or another one begins.
  void forget() {
    const std::lock_guard guard(lock_);
    ++stream_;
    posted_.reset();
  }

 private:
  static void send(GstElement* element, guint32 number) {
    GstMessage* message = gst_message_new_eos(GST_OBJECT(element));
    gst_message_set_seqnum(message, number);
    gst_element_post_message(element, message);
  }

  mutable std::mutex lock_;
  std::uint64_t stream_ = 0;  // counts on
  std::optional<guint32> posted_;
};

}  // namespace cerberus::plugin
