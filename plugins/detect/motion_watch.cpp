// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion_watch.hpp"

#include <optional>
#include <utility>

#include "shared/clock_times.hpp"

namespace cerberus::plugin {

using vision::MotionEvents;

void MotionWatch::begin(GstElement* element) {
  const std::lock_guard guard(lock_);
  element_ = element;
  events_ = {};
  last_.clear();
}

void MotionWatch::frame(const std::vector<CerberusRegion>& regions, GstClockTime running_time, Time step,
                        Time hold, bool live) {
  {
    const std::lock_guard guard(lock_);
    live_ = live;
    hold_ = hold;
    if (!regions.empty()) last_ = regions;
    const bool timed = GST_CLOCK_TIME_IS_VALID(running_time);
    announce(events_.update(!regions.empty(), timed ? std::optional(time_of(running_time)) : std::nullopt,
                            step, hold),
             running_time);
    arm();
  }
  post();
}

void MotionWatch::end() {
  {
    const std::lock_guard guard(lock_);
    pending_.reset();
    announce(events_.end(), events_.last() ? clock_time(*events_.last()) : GST_CLOCK_TIME_NONE);
  }
  post();
}

void MotionWatch::play(bool plays) {
  const std::lock_guard guard(lock_);
  plays_ = plays;
  pending_.reset();
  arm();
}

void MotionWatch::flush() {
  const std::lock_guard guard(lock_);
  pending_.reset();
}

// A timer that is there stays and looks at the deadline when it wakes: one timer in a hold-time, not one a frame.
void MotionWatch::arm() {
  const auto after = events_.ends_after(hold_);
  if (!live_ || !plays_ || !after) return pending_.reset();
  g_autoptr(GstClock) clock = gst_element_get_clock(element_);
  if (!clock) return;
  deadline_ = gst_clock_get_time(clock) + clock_time(*after);
  if (!pending_ || gst_clock_id_get_time(pending_.get()) > deadline_) wake_at(clock, deadline_);
}

void MotionWatch::wake_at(GstClock* clock, GstClockTime time) {
  struct Call {
    GstElement* element;  // kept alive, and this with it
    MotionWatch* watch;
  };
  pending_.reset(gst_clock_new_single_shot_id(clock, time));
  gst_clock_id_wait_async(
      pending_.get(),
      [](GstClock* by, GstClockTime now, GstClockID id, gpointer data) -> gboolean {
        static_cast<Call*>(data)->watch->on_clock(by, now, id);
        return TRUE;
      },
      new Call{GST_ELEMENT(gst_object_ref(element_)), this},
      [](gpointer data) {
        gst_object_unref(static_cast<Call*>(data)->element);
        delete static_cast<Call*>(data);
      });
}

void MotionWatch::on_clock(GstClock* clock, GstClockTime time, GstClockID id) {
  {
    const std::lock_guard guard(lock_);
    if (id != pending_.get() || !GST_CLOCK_TIME_IS_VALID(time)) return;  // it was put off while it woke
    if (time < deadline_) return wake_at(clock, deadline_);
    pending_.reset();
    const auto after = events_.ends_after(hold_);
    const auto last = events_.last();
    announce(events_.end(), last && after ? clock_time(*last + *after) : GST_CLOCK_TIME_NONE);
  }
  post();
}

void MotionWatch::announce(MotionEvents::Change change, GstClockTime running_time) {
  if (change == MotionEvents::Change::none) return;
  g_autoptr(GPtrArray) objects = g_ptr_array_sized_new(static_cast<guint>(last_.size()));
  for (CerberusRegion& region : last_) g_ptr_array_add(objects, &region);
  CerberusStamp stamp;
  cerberus_stamp_init(&stamp);
  stamp.running_time = running_time;
  CerberusMotion motion{};
  motion.state = change == MotionEvents::Change::started ? CERBERUS_MOTION_STARTED : CERBERUS_MOTION_ENDED;
  motion.regions = objects;
  messages_.put(
      Message(cerberus_message_new_motion(GST_OBJECT(element_), &stamp, &motion), gst_message_unref));
}

void MotionWatch::post() {
  messages_.tell(
      [&](const Message& message) { gst_element_post_message(element_, gst_message_ref(message.get())); });
}

}  // namespace cerberus::plugin
