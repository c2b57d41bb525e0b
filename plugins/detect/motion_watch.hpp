// SPDX-License-Identifier: LGPL-2.1-or-later
// Posts when motion starts and ends (lib's MotionEvents) and what each track does (TrackEvents), in a live pipeline
// also when frames stop coming: then both end by the pipeline's clock. Messages are posted without a lock, in the order
// in which they arise.
#pragma once

#include <cerberus/cerberus.h>

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "threads/in_order.h"
#include "vision/tracking/motion_events.h"
#include "vision/tracking/track_events.h"

namespace cerberus::plugin {

class MotionWatch {
 public:
  using Time = vision::MotionEvents::Time;

  // A new stream of `element`, which is not owned.
  void begin(GstElement* element);
  // One frame with these tracked regions and this stamp. step: seconds as of MotionEvents. live: from here on the clock
  // watches too.
  void frame(const std::vector<CerberusRegion>& regions, const CerberusStamp& stamp, Time step, Time hold,
             bool live);
  // No frame comes any more: motion ends now. All is posted when this returns, also by the clock's thread, unless that
  // is held up.
  void end();
  // The clock watches only while the element plays.
  void play(bool plays);
  // A flush begins, or has ended. In between no timer is set: the frame that is being analysed is of the time before.
  void flush(bool begins);

 private:
  struct Message {
    std::shared_ptr<GstMessage> message;
    guint track = 0;       // identity of its track; 0: it is about motion
    bool updated = false;  // the track was there before and still is

    // While nothing can be posted, the newest update of a track is kept, and all that happens once.
    static bool replaces(const Message& newer, const Message& older) {
      return older.updated && older.track == newer.track;
    }
  };
  struct Unschedule {
    void operator()(GstClockID id) const {
      gst_clock_id_unschedule(id);
      gst_clock_id_unref(id);
    }
  };
  using Pending = std::unique_ptr<void, Unschedule>;

  // With the lock held.
  void announce(vision::MotionEvents::Change change, std::span<const vision::TrackEvents::Event> tracks,
                const CerberusStamp& stamp);
  void end_at(GstClockTime running_time);            // likewise
  void arm();                                        // likewise
  void wake_at(GstClock* clock, GstClockTime time);  // likewise
  void on_clock(GstClock* clock, GstClockTime time, GstClockID id);
  void post();  // without

  std::mutex lock_;
  GstElement* element_ = nullptr;
  vision::MotionEvents events_;
  vision::TrackEvents track_events_;
  CerberusStamp stamp_{};              // of the last frame
  std::vector<vision::Track> tracks_;  // of the frame at hand
  std::vector<CerberusRegion> last_;   // of the last frame with any
  Time hold_{};
  bool live_ = false, plays_ = false, flushing_ = false;
  GstClockTime deadline_ = 0;  // when motion ends if no frame comes; clock time
  Pending pending_;            // wakes at the deadline as it was when it was made, or before
  threads::InOrder<Message> messages_{Message::replaces};
};

}  // namespace cerberus::plugin
