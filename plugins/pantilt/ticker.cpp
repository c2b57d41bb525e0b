// SPDX-License-Identifier: LGPL-2.1-or-later
#include "ticker.hpp"

#include <utility>

namespace cerberus::plugin {

void Ticker::run(GstClock* clock, const Tick& tick) {
  while (!quit_) {
    woken_ = false;
    GstClockID id = gst_clock_new_single_shot_id(clock, tick(gst_clock_get_time(clock)));
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

void Ticker::start(GstClock* clock, Tick tick) {
  if (thread_.joinable()) return;
  quit_ = false;
  thread_ = std::thread([this, clock = GST_CLOCK(gst_object_ref(clock)), tick = std::move(tick)] {
    run(clock, tick);
    gst_object_unref(clock);
  });
}

void Ticker::wake() {
  woken_ = true;
  const std::lock_guard guard(lock_);
  if (id_) gst_clock_id_unschedule(id_);
}

void Ticker::stop() {
  if (!thread_.joinable()) return;
  quit_ = true;
  wake();
  thread_.join();
}

}  // namespace cerberus::plugin
