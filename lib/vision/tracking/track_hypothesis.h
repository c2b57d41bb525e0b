// SPDX-License-Identifier: LGPL-2.1-or-later
// One object as the tracker believes it to be: two filters for where it is, two for how large it is.
//
// Lengths are measured in body lengths S = max(width, height) of the object itself: a standing person is about
// 1.7 m, so a walk of 1.4 m/s is 0.8 S a second at any distance and any picture size. All noises follow from that.
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

namespace cerberus::vision {

// Regions from this confidence on are one whole object with its true extent.
constexpr double kWhole = 0.5;

// One axis of a region against one axis of a track. Where the extents agree the centres are compared. Where they do
// not (a fragment of the object, or a blob of several) only this much is known: the smaller lies inside the larger.
struct Residual {
  double distance = 0;
  bool same_extent = true;
};
Residual compare_extents(double expected_from, double expected_to, double from, double to);

struct TrackHypothesis {
  std::uint32_t id = 0;            // 0: not confirmed yet
  MovingValue x, y;                // centre
  SlowValue w, h;                  // logarithms of the extent
  double widest = 0, tallest = 0;  // the largest extent it has had
  Point origin;                    // where it was first seen, carried with the scene
  // Logarithms of the extent it was first seen with, carried with the scene.
  double born_width = 0, born_height = 0;
  // The region it was last seen in alone, carried with the scene; how far its ends have gone outwards step by step.
  Box last;
  double risen = 0, sunk = 0;
  // Largest distance from the origin, S; of its edges, where it comes nearer, or only one end goes.
  double travelled = 0;
  double top_speed = 0;  // pixels a second, since it was confirmed
  double confidence = 0;
  double age = 0, unseen = 0;  // s since first and since last seen
  double fitted = 0;           // s during which a region had its extent: how well the extent is known
  double proven = 0;           // the longest that ever was
  double shared = 0;           // s it has shared a region with others
  double slow = 0;             // s it has been seen standing, or nearly, up to now
  double misfit = 0;           // s since a region had its extent
  bool leapt = false;          // and the region has grown by a leap meanwhile
  Point misfit_from;           // where the middle of the first one was that had not, carried with the scene
  Point walk;                  // velocity, pixels a second, when last seen away from the picture's edges
  bool uncovered = false;      // first seen where the camera had just begun to look
  bool stood = false;          // it stood, or nearly, when the misfit began
  bool parted = false;         // its box was that of two who have come apart, or of a piece
  bool hidden = false;         // behind somebody else whose region this is
  double lost = 0;             // s in regions of several without being found there
  AppearanceModel look;
  double unlikeness = 0;   // of what was last seen of it and its look
  int looked = 0;          // frames in which that was learnt
  AppearanceModel recent;  // since it was last close to anybody else
  int recently = 0;        // frames in which that was learnt
  double clear = 1e9;      // s since then
  AppearanceModel place;   // all of its box, since it stands, whether that moves or not
  double changed = -1;     // how appearance_distance that its box is now; negative: nobody can tell
  int hits = 0, frames = 0;
  int region = -1;  // of this frame, -1 none
  bool stopped = false, dead = false;
  bool leaving = false;  // when last seen the picture's edge had cut it to less than it was
  // The camera turned away from it: kept by angle, and as pixels only while that is ahead of the camera.
  bool away = false, ahead = true;
  Direction where;
  double magnification = 1;  // CameraOrientation::magnification() there
  double absent = 0;         // s that it was expected, away or stopped, and not there

  static TrackHypothesis first_seen(const Region& region);

  double width() const { return std::exp(w.value); }
  double height() const { return std::exp(h.value); }
  double size() const { return std::max(width(), height()); }
  double speed() const { return std::hypot(x.velocity, y.velocity); }
  Box box() const;
  // What of the box the picture shows; all of it where that is next to nothing.
  Box visible(Size frame) const;

  // Less than a tenth of S from the picture's edge.
  bool at_border(Size frame) const;

  // Along its own velocity from frame k-1's time to frame k's, then with the camera into frame k's pixels. False: it
  // has no place there.
  bool predict(double seconds);
  bool carry(const Transform& motion, Size frame);

  // The camera has turned away from it; along its own velocity and with the camera, by angles; it is in the picture
  // again.
  void leave(const CameraOrientation& gaze);
  void predict_away(double seconds, const CameraOrientation& gaze);
  void come_back(const Box& seen);
  // An away one should be seen, all of it.
  bool expected_in(Size frame) const;

  // How badly a region fits: 0 perfectly; negative: it cannot be this object.
  double distance(const Box& seen, Size frame) const;

  // It stood, and its place looks as it did: whoever was there is there, whatever moves.
  bool stays() const;
  // Seen in this region; `alone`: by no other track. `found`: so far from its expected place what looks like it is, in
  // a region of several.
  void correct(const Region& region, bool alone, double seconds, Size frame,
               const std::optional<Point>& found = {});
  // Seen alone, in a region of its own extent, and so it looks. `nobody_near`: nobody else stands in a part of the
  // region, this is what it looks like.
  void remember(const AppearanceModel& seen, double seconds, bool nobody_near);
  // Its look is known well enough to tell it from others.
  bool well_known() const;
  // What it looks like now is known as well, and who it is in doubt: somebody else was close a moment ago, or it looks
  // so different.
  bool knows_recent() const;
  bool doubted() const;
  // After correct(): what all of its box looks like, if it is alone there.
  void settle(const AppearanceModel& all, double seconds);
  // Somebody else shares the region, or stands in a part of it.
  void mix();
  // Not seen.
  void miss(double seconds);

 private:
  void magnify(double scale);
  double neared() const;
  double stretched() const;
  void follow_ends(const Box& seen, double seconds, Size frame);
  bool leaps(const Box& seen, double seconds) const;
  void adopt(const Box& seen);
  bool outgrown(const Box& seen, bool whole, bool cut, double seconds);
  void resize(SlowValue& extent, double seen, bool is_cut, double seconds);
};

}  // namespace cerberus::vision
