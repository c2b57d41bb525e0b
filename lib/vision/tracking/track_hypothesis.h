// SPDX-License-Identifier: LGPL-2.1-or-later
// One object as the tracker believes it to be: its life cycle, two filters for its position, two for its extent, and
// what it looks like.
//
//            confirm            miss              stop
//  tentative -------> confirmed ----> coasted ----------> stopped
//                         ^  <--------- correct ------------'
//                         |  come_back              ^
//                         '----------- off_screen --' come_back, resume_stop
//                           leave: from confirmed, coasted or stopped to off_screen
//                           lose: from every state to lost; the tracker removes lost tracks
//
// Lengths are in S = max(width, height) of the object, see TrackParameters.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "vision/detection/regions.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/geometry/transform.h"
#include "vision/tracking/appearance_model.h"
#include "vision/tracking/kalman.h"
#include "vision/tracking/track_parameters.h"

namespace cerberus::vision {

inline constexpr TrackParameters kTrackParameters;

// One axis of a region against one axis of a track. Where the extents agree the centres are compared. Where they do
// not (a fragment of the object, or a blob of several) the smaller extent lies inside the larger, no more is known.
struct Residual {
  double distance = 0;
  bool same_extent = true;
};
Residual compare_extents(double expected_from, double expected_to, double from, double to,
                         const TrackParameters& parameters = kTrackParameters);

// The region of a track in this frame.
struct Match {
  int region = -1;        // -1: none
  bool occluded = false;  // behind the track that owns the region
  bool reshaped = false;  // the track's extent was that of a group or a fragment: the region's replaces it
  bool merged = false;    // the track is a fragment of an older one in the same region
  int sharers = 0;        // tracks in the region that are neither occluded nor merged
};

struct TrackHypothesis {
  enum class State {
    tentative,   // not confirmed yet: no identity
    confirmed,   // with a region in the last frame
    coasted,     // without one, carried on along its velocity
    stopped,     // without one, at the place where it ceased to move
    off_screen,  // the camera turned away from it: kept by bearing and elevation
    lost         // ended
  };

  // Data of states.
  struct Stopped {
    double absent = 0;  // s that the place has looked otherwise
  };
  struct OffScreen {
    Direction direction;
    double magnification = 1;  // CameraOrientation::magnification() there
    bool in_front = true;      // of the camera: the position in pixels is valid
    bool stopped = false;      // it was when the camera turned away
    double absent = 0;         // s that it was expected in the picture and not found
  };
  // A region of another extent, since when and how.
  struct Misfit {
    double time = 0;         // s since a region had the track's extent
    Point from;              // centre of the first region that had not, carried with the scene
    bool jumped = false;     // the region has grown by a jump meanwhile
    bool was_still = false;  // the object stood, or nearly, when it began
  };
  struct Appearance {
    AppearanceModel model;       // learnt while the object is alone
    int frames = 0;              // in which it was learnt
    double change = 0;           // appearance distance of the last region to the model
    AppearanceModel recent;      // since the last contact with another track
    int recent_frames = 0;       // in which that was learnt
    double since_contact = 1e9;  // s
    AppearanceModel place;       // of the whole box since the object stands, moving pixels or not
    double place_change = -1;    // appearance distance of the box to `place` in this frame; negative: unknown
  };

  const TrackParameters* parameters = &kTrackParameters;
  State state = State::tentative;
  std::uint32_t id = 0;  // 0: tentative
  Stopped stop_data;
  OffScreen off_screen;

  MovingValue x, y;                // centre, frame pixels
  SlowValue w, h;                  // logarithms of the extent
  double widest = 0, tallest = 0;  // the largest extent so far, frame pixels
  Point origin;                    // first position, carried with the scene
  // Logarithms of the first extent, carried with the scene.
  double first_log_width = 0, first_log_height = 0;
  bool newly_visible = false;            // first seen where the camera had just begun to look
  Box last;                              // the last region that the track had alone, carried with the scene
  double top_rise = 0, bottom_drop = 0;  // frame pixels that its ends have gone outwards step by step
  double travelled = 0;  // S: largest distance from the origin, or of its ends (approach(), stretch())
  double top_speed = 0;  // frame pixels a second, since it was confirmed
  Point free_velocity;   // frame pixels a second, when last seen away from the picture's edges
  bool leaving = false;  // the picture's edge cut it when last seen
  Misfit misfit;
  RegionKind kind = RegionKind::thing;  // of the region that it was last seen in alone
  double confidence = 0;
  double age = 0, unseen = 0;  // s since first and since last seen
  int hits = 0, frames = 0;    // frames with a region, frames in all
  double fitted = 0;           // s of regions of its extent since that was last replaced
  double longest_fit = 0;      // s, the largest `fitted` so far
  double shared = 0;           // s that it has shared a region
  double unlocated = 0;        // s in shared regions without being located there
  double slow = 0;             // s that it has been seen standing, or nearly, up to now
  Appearance appearance;
  Match match;  // of this frame

  static TrackHypothesis first_seen(const Region& region,
                                    const TrackParameters& parameters = kTrackParameters);

  // Transitions; the comment of each names the states in which it may be called.
  void confirm(std::uint32_t identity);         // tentative
  void stop();                                  // coasted
  void leave(const CameraOrientation& camera);  // any but tentative: the camera has turned away from it
  void come_back(const Box& seen);              // off_screen: matched with a region
  void resume_stop();                           // off_screen and stopped: its place is in the picture again
  void lose() { state = State::lost; }
  // correct() leads from coasted and stopped to confirmed, miss() from confirmed to coasted.

  bool in_view() const {
    return state == State::confirmed || state == State::coasted || state == State::stopped;
  }
  bool stands() const {
    return state == State::stopped || (state == State::off_screen && off_screen.stopped);
  }

  double width() const { return std::exp(w.value); }
  double height() const { return std::exp(h.value); }
  double size() const { return std::max(width(), height()); }  // S in frame pixels
  double speed() const { return std::hypot(x.velocity, y.velocity); }
  Box box() const;
  // The part of the box inside the frame; all of it where that part is next to nothing.
  Box visible(Size frame) const;
  bool at_border(Size frame) const;

  // Along its own velocity from frame k-1's time to frame k's. False: the position is not finite.
  bool predict(double seconds);
  // With the camera into frame k's pixels. False: it has no position there.
  bool carry(const Transform& motion, Size frame);
  // Both for an off-screen track, by angles.
  void predict_off_screen(double seconds, const CameraOrientation& camera);
  // All of an off-screen track should be in the picture.
  bool expected_in(Size frame) const;

  // Cost of a region: 0 fits perfectly; negative: outside the validation gate.
  double distance(const Box& seen, Size frame) const;

  // The object stood and its place looks as it did: it is still there, whatever moves.
  bool stays() const;
  // Seen in this region. alone: no other track has it. found: offset of the best position by appearance from the
  // expected one, in a region of several.
  void correct(const Region& region, bool alone, double seconds, Size frame,
               const std::optional<Point>& found = {});
  // Not seen.
  void miss(double seconds);

  // Learns the appearance of a region of its own extent. isolated: no other track covers a part of the region.
  void remember(const AppearanceModel& seen, double seconds, bool isolated);
  // Learns what the whole box looks like; after correct(), for a track that is alone there.
  void learn_place(const AppearanceModel& all, double seconds);
  // Contact: another track shares the region, or covers a part of it.
  void touch();
  // Returns whether the appearance model distinguishes the object from others.
  bool has_appearance() const;
  // The same for the appearance since the last contact.
  bool has_recent_appearance() const;
  // The identity is in doubt: contact a moment ago, or a changed appearance.
  bool is_ambiguous() const;

 private:
  void magnify(double scale);
  double approach() const;
  double stretch() const;
  void follow_ends(const Box& seen, double seconds, Size frame);
  bool jumps(const Box& seen, double seconds) const;
  void adopt(const Box& seen);
  bool outgrown(const Box& seen, bool whole, bool cut, double seconds);
  void resize(SlowValue& extent, double seen, bool is_cut, double seconds);
  bool is_cut(double from, double to, double largest, int side) const;
};

}  // namespace cerberus::vision
