// SPDX-License-Identifier: LGPL-2.1-or-later
#include "ticker.hpp"

#include <utility>

namespace cerberus::plugin {

void Ticker::run() {
  while (!quit_) {
    woken_ = false;
    GstClockID id = gst_clock_new_single_shot_id(clock_, tick_(gst_clock_get_time(clock_)));
    {
      const std::lock_guard guard(lock_);
      id_ = id;
    }
    if (!quit_ && !woken_) gst_clock_id_wait(id, nullptr);
    const std::lock_guard guard(lock_);
    id_ = nullptr;
    gst_clock_id_unref(id);
  }
}

bool Ticker::start(GstClock* clock, Tick tick) {
  if (thread_) return true;
  quit_ = false;
  clock_ = GST_CLOCK(gst_object_ref(clock));
  tick_ = std::move(tick);
  const auto body = [](gpointer self) -> gpointer {
    static_cast<Ticker*>(self)->run();
    return nullptr;
  };
  thread_ = g_thread_try_new("cerberus-tick", body, this, nullptr);
  if (!thread_) gst_clear_object(&clock_);
  return thread_ != nullptr;
}

void Ticker::wake() {
  woken_ = true;
  const std::lock_guard guard(lock_);
  if (id_) gst_clock_id_unschedule(id_);
}

void Ticker::stop() {
  if (!thread_) return;
  quit_ = true;
  wake();
  g_thread_join(std::exchange(thread_, nullptr));
  gst_clear_object(&clock_);
}

}  // namespace cerberus::plugin
