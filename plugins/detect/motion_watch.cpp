// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion_watch.hpp"

#include <optional>
#include <utility>

#include "shared/clock_times.hpp"
#include "shared/region_conversion.hpp"

namespace cerberus::plugin {

using vision::MotionEvents;
using vision::TrackEvents;

void MotionWatch::begin(GstElement* element) {
  const std::lock_guard guard(lock_);
  element_ = element;
  events_ = {};
  track_events_ = {};
  cerberus_stamp_init(&stamp_);
  last_.clear();
  flushing_ = false;
}

void MotionWatch::frame(const std::vector<CerberusRegion>& regions, const CerberusStamp& stamp, Time step,
                        Time hold, bool live) {
  {
    const std::lock_guard guard(lock_);
    live_ = live;
    hold_ = hold;
    stamp_ = stamp;
    if (!regions.empty()) last_ = regions;
    tracks_.clear();
    for (const CerberusRegion& region : regions) tracks_.push_back(track_of(region));
    const auto time = known_time(stamp.running_time);
    announce(events_.update(!regions.empty(), time, step, hold),
             track_events_.update(tracks_, time, step, hold), stamp);
    arm();
  }
  post();
}

void MotionWatch::end() {
  {
    const std::lock_guard guard(lock_);
    pending_.reset();
    end_at(clock_time(events_.last()));
  }
  post();
  // Longer than any receiver of a message should take; then the end of the stream goes on alone.
  messages_.wait(std::chrono::seconds(1));
}

void MotionWatch::play(bool plays) {
  const std::lock_guard guard(lock_);
  plays_ = plays;
  pending_.reset();
  arm();
}

void MotionWatch::flush(bool begins) {
  const std::lock_guard guard(lock_);
  flushing_ = begins;
  arm();
}

// A timer that is there stays and looks at the deadline when it wakes: one timer in a hold-time, not one a frame.
void MotionWatch::arm() {
  const auto after = events_.ends_after(hold_);
  if (!live_ || !plays_ || flushing_ || !after) return pending_.reset();
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
    end_at(last && after ? clock_time(*last + *after) : GST_CLOCK_TIME_NONE);
  }
  post();
}

// Wall-clock time goes on from the last frame's.
void MotionWatch::end_at(GstClockTime running_time) {
  CerberusStamp stamp = stamp_;
  stamp.running_time = running_time;
  if (GST_CLOCK_TIME_IS_VALID(stamp.utc) && GST_CLOCK_TIME_IS_VALID(running_time) &&
      GST_CLOCK_TIME_IS_VALID(stamp_.running_time))
    stamp.utc += running_time - stamp_.running_time;
  announce(events_.end(), track_events_.end(), stamp);
}

void MotionWatch::announce(MotionEvents::Change change, std::span<const TrackEvents::Event> tracks,
                           const CerberusStamp& stamp) {
  GstObject* self = GST_OBJECT(element_);
  const auto put = [&](GstMessage* message, guint track = 0, bool updated = false) {
    messages_.put({std::shared_ptr<GstMessage>(message, gst_message_unref), track, updated});
  };
  const auto put_motion = [&](CerberusMotionState state) {
    g_autoptr(GPtrArray) objects = array_of(last_);
    CerberusMotion motion{};
    motion.state = state;
    motion.regions = objects;
    put(cerberus_message_new_motion(self, &stamp, &motion));
  };
  if (change == MotionEvents::Change::started) put_motion(CERBERUS_MOTION_STARTED);
  for (const TrackEvents::Event& event : tracks) {
    CerberusTrack track{};
    track.state = static_cast<CerberusTrackState>(event.change);
    track.region = tracked(event.track);
    track.first = clock_time(event.first);
    track.last = clock_time(event.last);
    put(cerberus_message_new_track(self, &stamp, &track), track.region.id,
        event.change == TrackEvents::Change::updated);
  }
  if (change == MotionEvents::Change::ended) put_motion(CERBERUS_MOTION_ENDED);
}

void MotionWatch::post() {
  messages_.deliver(
      [&](const Message& m) { gst_element_post_message(element_, gst_message_ref(m.message.get())); });
}

}  // namespace cerberus::plugin
