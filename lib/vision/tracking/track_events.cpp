// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/track_events.h"

#include <algorithm>

#include "vision/tracking/motion_events.h"

namespace cerberus::vision {

std::span<const TrackEvents::Event> TrackEvents::update(std::span<const Track> tracks,
                                                        std::optional<Time> time, Time step, Time hold) {
  const Time passed = frame_step(step, time, last_);
  last_ = time;
  events_.clear();
  for (Visit& visit : visits_) {
    visit.present =
        std::ranges::any_of(tracks, [&](const Track& track) { return track.id == visit.event.track.id; });
    visit.unseen = visit.present ? Time::zero() : visit.unseen + passed;
    visit.since_report += passed;
    if (visit.present || visit.unseen < hold) continue;
    visit.event.change = Change::left;
    events_.push_back(visit.event);
  }
  std::erase_if(visits_, [&](const Visit& visit) { return !visit.present && visit.unseen >= hold; });
  for (const Track& track : tracks) see(track, time);
  return events_;
}

void TrackEvents::see(const Track& track, std::optional<Time> time) {
  auto visit = std::ranges::find(visits_, track.id, [](const Visit& v) { return v.event.track.id; });
  const bool is_new = visit == visits_.end();
  if (is_new) {
    visit = visits_.emplace(visits_.end());
    visit->event.first = time;
  }
  visit->event.track = track;
  visit->event.last = time;
  if (!is_new && visit->since_report < parameters_.update_interval) return;
  visit->event.change = is_new ? Change::appeared : Change::updated;
  visit->since_report = Time::zero();
  events_.push_back(visit->event);
}

std::span<const TrackEvents::Event> TrackEvents::end() {
  events_.clear();
  for (Visit& visit : visits_) {
    visit.event.change = Change::left;
    events_.push_back(visit.event);
  }
  visits_.clear();
  return events_;
}

}  // namespace cerberus::vision
