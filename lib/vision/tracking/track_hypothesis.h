// SPDX-License-Identifier: LGPL-2.1-or-later
// One object as the tracker believes it to be: the state of its life, two filters for its position, two for its
// extent, what it looks like, and what has been observed of it so far.
//
// Lengths are in S = max(width, height) of the object, see TrackParameters.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>

#include "vision/detection/region.h"
#include "vision/geometry/camera_orientation.h"
#include "vision/geometry/transform.h"
#include "vision/tracking/appearance_model.h"
#include "vision/tracking/kalman.h"
#include "vision/tracking/standing_place.h"
#include "vision/tracking/track_parameters.h"

namespace cerberus::vision {

// The states of a track, in the order of TrackLife's alternatives. life_cycle.h has the transitions and their rules,
// docs/design/track-states.md a drawing.
enum class TrackPhase { tentative, confirmed, coasted, stopped, off_screen, lost };

// Not confirmed yet: it has no identity and is not published.
struct Tentative {
  int hits = 1, frames = 1;  // frames with a region, frames in all
};
// With a region in the last frame.
struct Confirmed {};
// Without one, carried on along its velocity.
struct Coasted {};
// Without one, at the place where it ceased to move.
struct Stopped {
  double absent = 0;  // s for which the place has looked otherwise
};
// The camera turned away from it, or it walked out of the picture: it is kept by bearing and elevation, unpublished.
struct OffScreen {
  Direction direction;
  double magnification = 1;  // CameraOrientation::magnification() there
  bool in_front = true;      // of the camera: the position in pixels is valid
  bool stopped = false;      // it was when the camera turned away
  double absent = 0;         // s for which it was expected in the picture and not found
  // It left while the camera stood, on a head that cannot turn further or that holds: it is expected back over the side
  // of the picture that is next to it.
  bool walked_out = false;
};
// Ended; the tracker removes it.
struct Lost {};

using TrackLife = std::variant<Tentative, Confirmed, Coasted, Stopped, OffScreen, Lost>;

inline TrackPhase phase_of(const TrackLife& life) {
  return static_cast<TrackPhase>(life.index());
}

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
  bool leapt = false;     // beyond the gate: the object is faster than the first velocity allows
  bool reshaped = false;  // the track's extent was that of a group or a fragment: the region's replaces it
  bool merged = false;    // the track is a fragment of an older one in the same region
  int sharers = 0;        // tracks in the region that are neither occluded nor merged
};

struct TrackHypothesis {
  // How far the object has gone since it was first seen. Places and lengths are carried with the scene.
  struct Travel {
    Point origin;                          // first position
    double log_width = 0, log_height = 0;  // logarithms of the first extent
    double top_rise = 0, bottom_drop = 0;  // frame pixels that its ends have gone outwards step by step
    double most = 0;  // S: largest distance from the origin, or of its ends (approach(), stretch())
  };
  // What is known of it from where the picture's edges did not cut it.
  struct Uncut {
    double width = 0, height = 0;              // the largest extent so far, frame pixels
    double whole_width = 0, whole_height = 0;  // when last seen so, or when it came back; 0: not yet
    Point velocity;                            // frame pixels a second, when last seen so
    bool leaving = false;                      // the picture's edge cut it when last seen
  };
  // How long regions have had its extent, and since when the last ones have had another.
  struct Fit {
    double time = 0;         // s of regions of its extent since that was last replaced
    double longest = 0;      // s, the largest `time` so far
    double misfit = 0;       // s since a region had its extent
    Point misfit_from;       // centre of the first region that had not, carried with the scene
    bool was_still = false;  // the object stood, or nearly, when the misfit began
  };
  // Regions of several objects.
  struct Shared {
    double time = 0;       // s that it has shared a region
    double unlocated = 0;  // s in shared regions without being located there
  };
  struct Appearance {
    AppearanceModel model;  // learnt while the object is alone
    int frames = 0;         // in which it was learnt
    double learnt = 0;      // s of these
    double change = 0;      // appearance distance of the last region to the model
  };

  const TrackParameters* parameters = &kTrackParameters;
  TrackLife life;
  std::uint32_t id = 0;  // 0: tentative
  MovingValue x, y;      // centre, frame pixels
  SlowValue w, h;        // logarithms of the extent
  double top_speed = 0;  // frame pixels a second, since it was confirmed
  double confidence = 0;
  double age = 0, unseen = 0;           // s since first and since last seen
  double slow = 0;                      // s that it has been seen standing, or nearly, up to now
  Box last;                             // the last region that the track had alone, carried with the scene
  RegionKind kind = RegionKind::thing;  // of that region, or of a group that it has been for long enough
  double in_group = 0;                  // s that its regions have been groups up to now
  double since_person = 1e9;            // s since it had a person-like region alone
  Travel travel;
  Uncut uncut;
  Fit fit;
  Shared shared;
  Appearance appearance;
  StandingPlace standing;
  bool there = false;         // it is known to be where it stood, in this frame, before a camera that stands,
  bool left = false;          // or to have left from there: the place looks as before it came
  Match match;                // of this frame
  bool camera_moved = false;  // since the frame before

  static TrackHypothesis first_seen(const Region& region,
                                    const TrackParameters& parameters = kTrackParameters);

  TrackPhase phase() const { return phase_of(life); }
  bool is(TrackPhase p) const { return phase() == p; }
  bool in_view() const {
    return is(TrackPhase::confirmed) || is(TrackPhase::coasted) || is(TrackPhase::stopped);
  }
  bool stands() const {
    const auto* away = std::get_if<OffScreen>(&life);
    return is(TrackPhase::stopped) || (away && away->stopped);
  }

  bool walked_out() const {
    const auto* away = std::get_if<OffScreen>(&life);
    return away && away->walked_out;
  }

  double width() const { return std::exp(w.value); }
  double height() const { return std::exp(h.value); }
  double size() const { return std::max(width(), height()); }  // S in frame pixels
  double speed() const { return std::hypot(x.velocity, y.velocity); }
  double seen_for() const { return age - unseen; }  // s from first to last seen
  Box box() const;
  // The part of the box inside the frame; all of it where that part is nothing.
  Box visible(Size frame) const;
  bool at_border(Size frame) const;

  // Along its own velocity from frame k-1's time to frame k's; camera_moves: between the two. False: the position is not
  // finite.
  bool predict(double seconds, bool camera_moves = false);
  // With the camera into frame k's pixels. False: it has no position there.
  bool carry(const Transform& motion, Size frame);
  // Both for an off-screen track, by angles.
  void predict_off_screen(double seconds, const CameraOrientation& camera);
  // All of an off-screen track should be in the picture.
  bool expected_in(Size frame) const;

  // As it leaves the picture, cut by its edge: restores the extent that it had when last seen whole. Limits the velocity's
  // variance.
  void restore_whole();
  // It has this extent where nothing cuts it.
  void note_whole();

  // Cost of a region: 0 fits perfectly; negative: outside the validation gate.
  double distance(const Box& seen, Size frame) const;

  // Seen in this region. alone: no other track has it. found: offset of the best position by appearance from the
  // expected one, in a region of several.
  void correct(const Region& region, bool alone, double seconds, Size frame,
               const std::optional<Point>& found = {});
  // The region's extent and place replace the track's.
  void adopt(const Box& seen);
  // Not seen: it slows down.
  void miss(double seconds);

  // The object stood, and its place still differs from what was there before: it is there, whatever moves.
  bool stays() const;
  // Learns the appearance of a region of its own extent, where no other track covers a part of the region (isolated).
  void remember(const AppearanceModel& seen, double seconds, bool isolated);
  // Returns whether the appearance model distinguishes the object from others.
  bool has_appearance() const;

 private:
  // A region beside the box in which the track expects it.
  struct Comparison {
    Residual x, y;
    bool fits = false;                        // both extents agree
    bool within_x = false, within_y = false;  // it lies in the expected box
    bool cut_x = false, cut_y = false;        // by the picture's edge: it changes as the object comes or goes
    bool at_edge = false;  // the picture's edge cuts it, whether it comes, goes or stands there
    bool stays = false;    // the object is seen to stay where it stood
    bool cut() const { return cut_x || cut_y; }
  };

  void magnify(double scale);
  Direction expected(const Direction& kept, const CameraOrientation& camera) const;
  double approach() const;
  double stretch() const;

  // Steps of correct(), in track_correction.cpp.
  Comparison compare(const Box& seen, bool alone, Size frame) const;
  bool is_cut(double from, double to, double largest, int side) const;
  bool outgrown(const Region& region, bool cut, double seconds);
  void replace_extent(const Box& seen, bool cut);
  void move_to(const Point& found, double seconds);
  void move_by(const Comparison& how, double seconds, Size frame);
  void refine_extent(const Box& seen, const Comparison& how, double seconds, Size frame);
  void resize(SlowValue& extent, double seen, bool is_cut, double seconds);
  void follow_ends(const Box& seen, double seconds, Size frame);
  void shrink_into(const Box& region);
  void take_kind(RegionKind seen, bool alone, bool fits, double seconds);
  void note_seen(double seen_confidence, double size_before, double seconds);
};

// The two have gone different ways for as long as both exist. Fragments of one object never do.
bool went_apart(const TrackHypothesis& a, const TrackHypothesis& b);
// Both appearances are known and so different that they are two objects.
bool look_different(const TrackHypothesis& a, const TrackHypothesis& b);

}  // namespace cerberus::vision
