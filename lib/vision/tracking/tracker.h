// SPDX-License-Identifier: LGPL-2.1-or-later
// Multi-object tracks: stable identities and velocities with the camera's motion taken out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "vision/detection/regions.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/geometry/transform.h"
#include "vision/tracking/appearance_model.h"

namespace cerberus::vision {

enum class TrackState { seen, coasted, stopped };

struct TrackOptions {
  double confirm_time = 0.2;   // s of evidence before a track is published; 0: every region is one at once
  double coast_time = 1.0;     // s a moving track is carried without evidence
  double hold_stopped = 30.0;  // s a confirmed track that stopped is held
  double away_time = 5.0;      // s a moving track is kept in mind while the camera looks elsewhere
  double maximum_speed = 0;    // frame pixels a second; faster jumps are not the same object (0: no limit)
};

struct Track {
  std::uint32_t id = 0;   // from 1, never used again in a stream
  Box box;                // frame pixels, clamped to the frame
  double vx = 0, vy = 0;  // frame pixels a second relative to the scene, camera motion taken out
  double top_speed =
      0;           // highest speed since confirmed, frame pixels a second: what a lower limit asks about
  double age = 0;  // s since first seen
  double confidence = 0;  // 0..1
  TrackState state = TrackState::seen;
};

class Tracker {
 public:
  Tracker();
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  void set_options(const TrackOptions& options);
  // Forget all tracks (identities go on counting).
  void reset();
  // regions: boxes in frame pixels. motion: frame k-1 to k, frame pixels. seconds: time since the previous frame
  // (<= 0: unknown, taken as the last known distance). gaze: lens and where the head looks, if both are known. Returns
  // confirmed tracks, by id; lives until the next call.
  //
  // sight: the analysed picture and what moves in it, if they are there. Then everybody's look is learnt where he is
  // seen alone, and tells who is who where places do not: in a group and when it parts, behind somebody else, and after
  // being away.
  //
  // Who leaves the picture because the camera turns is kept by bearing and elevation, unpublished, and is the same when
  // the camera comes back; without it angles are summed up from the camera's motion.
  std::span<const Track> update(std::span<const Region> regions, const Transform& motion, double seconds,
                                Size frame, const std::optional<CameraOrientation>& gaze = {},
                                const Sight& sight = {});
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
