// SPDX-License-Identifier: LGPL-2.1-or-later
// Multi-object tracks: stable identities, and velocities relative to the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "vision/detection/region.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/geometry/transform.h"
#include "vision/tracking/appearance_model.h"

namespace cerberus::vision {

struct TrackingParameters;  // tracking_parameters.h

enum class TrackState { seen, coasted, stopped };

struct TrackOptions {
  double confirm_time = 0.2;   // s with regions before a track is published; 0: every region is one at once
  double coast_time = 1.0;     // s that a moving track is kept without region
  double hold_stopped = 30.0;  // s that a stopped track is kept
  double away_time = 5.0;      // s that a moving track is kept off-screen
  double maximum_speed = 0;    // frame pixels a second; faster jumps are not the same object (0: no limit)
};

struct Track {
  std::uint32_t id = 0;   // from 1, never used again in a stream
  Box box;                // frame pixels, clamped to the frame; published without_edge (box_edge.h)
  double vx = 0, vy = 0;  // frame pixels a second relative to the scene, camera motion taken out
  double top_speed =
      0;           // frame pixels a second, the highest since confirmed: a lower limit is compared with it
  double age = 0;  // s since first seen
  double confidence = 0;  // 0..1
  TrackState state = TrackState::seen;
  // Of the region that it was last seen in alone; a group's where that lasts (TrackParameters::settled).
  RegionKind kind = RegionKind::person_like;
  // Which witnesses it has: motion, and a person detector (EvidenceTracker).
  bool motion = true, person = false;
  // Of the middle of the box from the camera's axis, radians, and along the floor, metres. NaN: not known; filled by
  // Detector.
  double bearing = std::numeric_limits<double>::quiet_NaN();
  double distance = std::numeric_limits<double>::quiet_NaN();
};

// Whether a track is still published `seconds` after the last new picture, where only repetitions of it have come since:
// they say nothing of what moves, so the tracker does not see them, and a track ends as if nothing had been seen.
bool outlasts(TrackState state, double seconds, const TrackOptions& options);

class Tracker {
 public:
  Tracker();
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  void set_options(const TrackOptions& options);
  // Begins anew with these numbers, and the options that were set.
  void set_parameters(const TrackingParameters& parameters);
  // Drops all tracks (identities go on counting).
  void reset();
  // regions: boxes in frame pixels. motion: frame k-1 to k, frame pixels. seconds: time since the previous frame
  // (<= 0: unknown, the last known distance is used). camera: lens and head position, if both are known. input: the
  // analysed picture and its foreground mask, if they are there: then the appearance of each track is learnt while it
  // is alone, and decides in groups, when groups part, behind occlusions and after a track was off-screen.
  //
  // Returns the confirmed tracks in view, by identity; the span lives until the next call. A track that leaves the
  // picture because the camera turns is kept by bearing and elevation, unpublished, and has the same identity when the
  // camera comes back; without `camera` the angles are summed up from the camera's motion.
  std::span<const Track> update(std::span<const Region> regions, const Transform& motion, double seconds,
                                Size frame, const std::optional<CameraOrientation>& camera = {},
                                const Sight& input = {});
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
