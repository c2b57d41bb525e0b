// SPDX-License-Identifier: LGPL-2.1-or-later
// What the tracker knows between frames, and the steps that a frame takes: for the files that are the tracker,
// tracks.cpp (from frame to frame) and tracks_regions.cpp (whose a region is).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/camera_orientation.h"
#include "vision/tracking/assignment.h"
#include "vision/tracking/region_appearances.h"
#include "vision/tracking/track_hypothesis.h"
#include "vision/tracking/tracker.h"

namespace cerberus::vision {

constexpr double kCrossing = 3;  // s that two who came different ways may be in one place

// Whose turn it is to be found a region.
enum class Sort { here, away, unconfirmed };
inline Sort sort_of(const TrackHypothesis& b) {
  return b.id == 0 ? Sort::unconfirmed : b.away ? Sort::away : Sort::here;
}

struct Tracker::State {
  static constexpr double kDefaultSeconds = 1.0 / 25;  // until a frame distance is known

  TrackOptions options;
  std::vector<TrackHypothesis> bodies;
  std::vector<Region> regions;
  std::vector<int> owner;  // body of each region, -1 none
  std::vector<char> used;  // region explained
  std::vector<double> cost, unmatched;
  std::vector<int> rows;  // bodies taking part in an assignment
  std::vector<Track> published;
  Assignment assignment;
  std::uint32_t last_id = 0;
  double seconds = kDefaultSeconds;
  Size frame;
  OrientationEstimate heading;
  RegionAppearances sightings;
  Box known;             // of the picture, what has been in view for a while
  bool turning = false;  // the camera moved since the last frame

  State();
  void preallocate(std::size_t tracks, std::size_t seen);
  void look(const Transform& motion);
  void take(std::span<const Region> input);
  void predict(const Transform& motion);
  double pair_cost(const TrackHypothesis& body, std::size_t region) const;
  double look_price(const TrackHypothesis& body, std::size_t region) const;
  bool may_hold(const Region& region, const TrackHypothesis& body) const;
  void associate(Sort sort);
  void gather_fragments();
  bool hides(const TrackHypothesis& first, const TrackHypothesis& body, const Box& region) const;
  void share_regions();
  bool others_expected(const TrackHypothesis& body, const Region& region) const;
  bool crowded(const TrackHypothesis& body, const Region& region) const;
  void absorb_pieces();
  void remove_hollow();
  void drop_dead() {
    std::erase_if(bodies, [](const TrackHypothesis& b) { return b.dead; });
  }
  void give_birth();
  void age();
  void remove_duplicates();
  void publish();
  bool covered(const TrackHypothesis& body) const;
  bool left_place(const TrackHypothesis& body) const;
  bool has_stopped(const TrackHypothesis& body) const;
};

}  // namespace cerberus::vision
