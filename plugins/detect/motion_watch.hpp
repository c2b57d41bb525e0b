// SPDX-License-Identifier: LGPL-2.1-or-later
// Posts when motion starts and ends (lib's MotionEvents) and what each track does (TrackEvents), in a live pipeline also
// when frames stop coming: then both end by the pipeline's clock. Messages are posted without a lock, in the order in which they arise.
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
  // No frame comes any more: motion ends now.
  void end();
  // The clock watches only while the element plays.
  void play(bool plays);
  // Frames that come now are of another time.
  void flush();

 private:
  using Message = std::shared_ptr<GstMessage>;
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
  bool live_ = false, plays_ = false;
  GstClockTime deadline_ = 0;  // when motion ends if no frame comes; clock time
  Pending pending_;            // wakes at the deadline as it was when it was made, or before
  threads::InOrder<Message> messages_;
};

}  // namespace cerberus::plugin
