// SPDX-License-Identifier: LGPL-2.1-or-later
#include "playing_gate.hpp"

#include <chrono>

namespace cerberus::plugin {

void PlayingGate::await_data(GstElement* element) {
  awaits_data_ = true;
  gst_element_post_message(element, gst_message_new_async_start(GST_OBJECT(element)));
}

void PlayingGate::stop_awaiting(GstElement* element) {
  if (awaits_data_.exchange(false))
    gst_element_post_message(element, gst_message_new_async_done(GST_OBJECT(element), GST_CLOCK_TIME_NONE));
}

void PlayingGate::begin_playing() {
  const std::lock_guard guard(prerolled_);
  set_playing(true);
}

void PlayingGate::end_playing() {
  set_playing(false);
}

void PlayingGate::has_data(GstElement* element) {
  if (!awaits_data_.exchange(false)) return;
  // In another thread: this one may have to end before a change of state down can. The element outlives the call.
  gst_element_call_async(
      element, [](GstElement* of, gpointer gate) { static_cast<PlayingGate*>(gate)->continue_state(of); },
      this, nullptr);
}

void PlayingGate::continue_state(GstElement* element) {
  GST_STATE_LOCK(element);  // first, as a change of state has it where PLAYING begins
  const std::lock_guard guard(prerolled_);
  const bool waiting =
      GST_STATE_RETURN(element) == GST_STATE_CHANGE_ASYNC && GST_STATE_NEXT(element) == GST_STATE_PAUSED;
  if (waiting) gst_element_continue_state(element, GST_STATE_CHANGE_SUCCESS);
  GST_STATE_UNLOCK(element);
  if (waiting)
    gst_element_post_message(element, gst_message_new_async_done(GST_OBJECT(element), GST_CLOCK_TIME_NONE));
}

void PlayingGate::set_playing(bool playing) {
  {
    const std::lock_guard guard(lock_);
    playing_ = playing;
  }
  changed_.notify_all();
}

bool PlayingGate::wait(GstPad* pad) {
  using namespace std::chrono_literals;
  std::unique_lock guard(lock_);
  while (!playing_ && !GST_PAD_IS_FLUSHING(pad)) changed_.wait_for(guard, 20ms);
  return !GST_PAD_IS_FLUSHING(pad);
}

}  // namespace cerberus::plugin
