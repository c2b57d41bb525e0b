// SPDX-License-Identifier: LGPL-2.1-or-later
// Which events of each published track are reported: it appeared, it is still there (at a bounded rate), it left.
#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <vector>

#include "vision/tracking/tracker.h"

namespace cerberus::vision {

class TrackEvents {
 public:
  using Time = std::chrono::nanoseconds;
  enum class Change { appeared, updated, left };

  struct Parameters {
    // Least time between two `updated` events of one track: ten tracks make ten messages a second, which a bus that
    // is read by a user interface takes. Chosen, not measured; guarded by unit-track_events.
    Time update_interval = std::chrono::seconds(1);
  };

  struct Event {
    Change change = Change::appeared;
    Track track;  // as it was last published
    std::optional<Time> first,
        last;  // running times of the first and the last frame that it was published on
  };

  TrackEvents() = default;
  explicit TrackEvents(const Parameters& parameters) : parameters_(parameters) {}

  // One frame. `tracks`: those published on it. `time`: its running time, where it has one. `step`: the duration that
  // it counts for, as in MotionEvents::update(). `hold`: a track that is not published for so long has left; until
  // then a return continues the same visit; 0 = it leaves on the first frame without it. Returns the frame's events:
  // first those of tracks that left, then the others in the order of `tracks`. Valid until the next call.
  std::span<const Event> update(std::span<const Track> tracks, std::optional<Time> time, Time step,
                                Time hold);
  // The stream ends: all tracks leave.
  std::span<const Event> end();

 private:
  struct Visit {
    Event event;
    Time unseen{};        // since it was last published
    Time since_report{};  // since its last event
    bool present = false;
  };

  void see(const Track& track, std::optional<Time> time);

  Parameters parameters_;
  std::vector<Visit> visits_;
  std::vector<Event> events_;
  std::optional<Time> last_;
};

}  // namespace cerberus::vision
