// SPDX-License-Identifier: LGPL-2.1-or-later
// Makes an element of several sink pads reach PAUSED with its first frame, as a sink does, and take no more before
// PLAYING.
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

namespace cerberus::plugin {

class PlayingGate {
 public:
  // In change_state(): the element goes to PAUSED; it leaves PAUSED; PLAYING begins and ends.
  void await_data(GstElement* element);
  void stop_awaiting(GstElement* element);
  void begin_playing();
  void end_playing();

  // In a streaming thread: the first data is there.
  void has_data(GstElement* element);
  // Waits for PLAYING. False: the pad is flushing, or stops.
  bool wait(GstPad* pad);

 private:
  void continue_state(GstElement* element);
  void set_playing(bool playing);

  std::atomic<bool> awaits_data_ = false;
  // Held while PAUSED is reported, and taken on the way to PLAYING: a bin may otherwise forget that it plays, and never
  // post EOS (the thread that reports PAUSED goes on after the application has set PLAYING; seen on 1.22 on a busy
  // machine). Where an element upstream is the last one to reach PAUSED, it holds no such lock: confirm_playing.hpp.
  std::recursive_mutex prerolled_;
  std::mutex lock_;  // of playing_
  std::condition_variable changed_;
  bool playing_ = false;
};

}  // namespace cerberus::plugin
