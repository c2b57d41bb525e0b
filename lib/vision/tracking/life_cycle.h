// SPDX-License-Identifier: LGPL-2.1-or-later
// The life of a track: the transitions between its states (track_hypothesis.h), and the rules by which they happen.
//
//   tentative --confirm--> confirmed --coast--> coasted --stop--> stopped
//
//   see          coasted, stopped -> confirmed
//   leave        coasted, stopped -> off_screen, where the camera turns away
//   walk_out     the same, where the object leaves the picture of a head that stands
//   come_back    off_screen -> coasted or stopped, as it was; then see in the same frame
//   resume_stop  off_screen -> stopped
//   lose         every state -> lost; the tracker removes lost tracks
//
// docs/design/track-states.md has a drawing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "vision/detection/region.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/tracking/track_hypothesis.h"
#include "vision/tracking/tracker.h"

namespace cerberus::vision {

class LifeCycle {
 public:
  // Where no origin stands the value was chosen by hand on vtest.avi and davis_tennis. Guard: boxes on vtest.avi,
  // MOTA 70 on PETS09-S2L1, tests/unit (tracker, standing, straight, turning).
  struct Parameters {
    // Confirmation.
    // S that an object has moved. The uncovered place of an object that belonged to the background model, and a lamp
    // that was switched on, never move.
    double least_travel = 0.12;
    // Frames with a region; at a low frame rate two, after so many times confirm-time.
    int least_hits = 3;
    double confirm_slack = 0.99;  // of confirm-time: rounding of the frame distances adds up
    // Share of a tentative track's frames that had a region, at least. swept: .4 to .6. With fewer it is lost, after as large
    // a share of confirm-time without region. swept: .5 to 1. Guard: bench-in_window.
    double hit_share = 0.5;
    // Coasting.
    // Of the time for which the object was seen; of the coast time, at the picture's edge. measured: instead of .5 and .3 MOTA
    // is .33 +- .28 higher. Guard: bench-development, bench-steady.
    double coast_share = 0.4;
    double certain = 0.4;  // of the box's width: standard deviation up to which a coasted track is published
    double seen = 1.5;     // s for which an object was seen that has stopped
  };

  LifeCycle() = default;
  explicit LifeCycle(const Parameters& parameters) : parameters_(parameters) {}

  struct Frame {
    Size size;             // pixels
    double seconds = 0;    // since the previous frame
    bool turning = false;  // the camera moved since the previous frame
    CameraOrientation camera;
    bool head = false;  // the camera can turn
  };

  // Transitions. The comment names the states in which each may be called.
  static void confirm(TrackHypothesis& track, std::uint32_t id);  // tentative
  static void coast(TrackHypothesis& track);                      // confirmed: no region
  static void stop(TrackHypothesis& track);                       // coasted
  static void see(TrackHypothesis& track);                        // coasted, stopped: a region corrected it
  static void leave(TrackHypothesis& track, const CameraOrientation& camera);     // coasted, stopped
  static void walk_out(TrackHypothesis& track, const CameraOrientation& camera);  // coasted, stopped
  static void come_back(TrackHypothesis& track, const Box& seen);  // off_screen: matched with a region
  static void resume_stop(TrackHypothesis& track);  // off_screen, stopped before: its place is in view again
  static void lose(TrackHypothesis& track);         // any

  // A frame's transitions of all tracks, after those with a region were corrected.
  void advance(std::span<TrackHypothesis> tracks, const Frame& frame, const TrackOptions& options);
  // The state in which a track is published after advance(), if it is.
  std::optional<TrackState> published(const TrackHypothesis& track) const;

 private:
  void advance_tentative(TrackHypothesis& track);
  void advance_coasted(TrackHypothesis& track);
  void advance_stopped(TrackHypothesis& track);
  void advance_off_screen(TrackHypothesis& track);
  void depart(TrackHypothesis& track);
  bool is_confirmed(const TrackHypothesis& track) const;
  bool has_stopped(const TrackHypothesis& track) const;
  bool covered(const TrackHypothesis& track) const;
  bool outside(const TrackHypothesis& track) const;
  bool is_sliver(const TrackHypothesis& track) const;
  double coast_time(const TrackHypothesis& track) const;
  void fade(TrackHypothesis& track, double time) const;

  Parameters parameters_;
  std::uint32_t last_id_ = 0;
  // Of the frame in progress.
  std::span<const TrackHypothesis> tracks_;
  Frame frame_;
  TrackOptions options_;
};

}  // namespace cerberus::vision
