// SPDX-License-Identifier: LGPL-2.1-or-later
// Data association: which track has which region of a frame. A region is one object's, a fragment of one, or a blob of
// several.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vision/detection/region.h"
#include "vision/tracking/assignment.h"
#include "vision/tracking/region_appearances.h"
#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {

class DataAssociation {
 public:
  // Where no origin stands the value was chosen by hand on vtest.avi and davis_tennis. Guard: MOTA 70 on PETS09-S2L1
  // and tests/unit (meeting, coats, tracker).
  struct Parameters {
    // Cost of a track without region, and the most that a pair costs, but for a track that comes back.
    // TrackHypothesis::distance() is about 0 to 2.
    double unmatched = 2;
    double shared = 1;  // cost of a track that stays in a blob of several

    // S from the first to the second region of an object where nothing else can be it. derived: 2,000 pixels a second at 25
    // frames a second are 1.3 S of an ellipse of 60x40 pixels. Guard: unit fast_object.
    double leap = 2;

    // Appearance distance. measured on vtest.avi: the same person again .16 in the median and .28 in one of ten; two
    // persons .36 in the median.
    // Costs nothing; and the most of a track that walked out of a head's picture. swept: .1 to .25. Guard:
    // unit coats.
    double usual_change = 0.15;
    double appearance_cost = 3.0;  // per unit beyond it,
    // and known_cost more of a model that was learnt for long, approached with known_time, for tracks in view: what was seen
    // for a second may be one side of a person. swept: 0 to 8 and 3 to 8 s. Guard: bench-variants, unit
    // data_association.
    double known_cost = 5.0;
    double known_time = 5.0;  // s, time constant
    // More than the last one by this: another object (shade comes step by step). The most for a track that comes back into the
    // picture. swept: .35 to .45. Guard: bench-moving_window.
    double sudden_change = 0.45;

    // Blobs of several.
    double larger = 1.3;  // times the area of a track: a region that may hold others
    // Of a track's area that lies in the blob, of a fragment's or a small track's that lies in the box of the track of which it
    // is a part, of a region's that its tracks fill if they are not fragments of one object, and of the rows and columns
    // that two boxes have in common. swept: .5 and .6. Guard: bench-development, unit meeting, straight.
    double inside = 0.5;
    // Intersection over union of an occluded track with the region. swept: .3 to .36, which are
    // equal but for person 11 of bench-in_window.
    double occluded_overlap = 0.33;
  };

  struct Frame {
    Size size;                 // frame pixels
    double seconds = 0;        // since the previous frame
    double maximum_speed = 0;  // frame pixels a second; 0: no limit
  };

  DataAssociation() = default;
  explicit DataAssociation(const Parameters& parameters) : parameters_(parameters) {}

  // Memory for so many: problems up to this size allocate nothing.
  void reserve(std::size_t tracks, std::size_t regions);

  // tracks: predicted to this frame. regions: frame pixels; the box of a region that fragments complete is enlarged in
  // place, and its appearance computed again. Tracks in view come first, then off-screen, then tentative ones. The
  // result lives until the next call.
  void associate(std::span<const TrackHypothesis> tracks, std::span<Region> regions,
                 RegionAppearances& appearances, const Frame& frame);

  // Of each track.
  std::span<const Match> matches() const { return matches_; }
  // No track has the region and it completes no other: it may be a new object.
  bool is_new(std::size_t region) const { return owner_[region] < 0 && !fragment_[region]; }

  // Questions about a region that a track has, when tracks before it in the list have been corrected already.
  // A track other than `self` is expected in the region, which is larger than `self`.
  bool others_expected(std::span<const TrackHypothesis> tracks, const TrackHypothesis& self,
                       const Box& region, Size frame) const;
  // A track other than `self` covers a part of the region.
  bool crowded(std::span<const TrackHypothesis> tracks, const TrackHypothesis& self, const Box& region) const;
  // The region is so much larger than the track that it may hold others.
  bool is_larger(const Box& region, const Box& track) const {
    return region.area() > parameters_.larger * track.area();
  }

  std::size_t bytes() const;

 private:
  enum class Turn { in_view, off_screen, tentative };
  static Turn turn_of(const TrackHypothesis& track);
  struct SameExtents {
    bool width = false, height = false;
  };

  void assign(Turn turn);
  double pair_cost(const TrackHypothesis& track, std::size_t region) const;
  double appearance_cost(const TrackHypothesis& track, std::size_t region) const;
  SameExtents same_extents(const TrackHypothesis& track, const Box& seen) const;
  bool may_hold(const Region& region, const TrackHypothesis& track) const;
  bool too_fast(const TrackHypothesis& track, double moved) const;
  void follow_leap();
  void gather_fragments();
  void share_regions();
  bool occludes(const TrackHypothesis& front, const TrackHypothesis& track, const Box& region) const;
  void merge_fragments();
  bool is_part(const TrackHypothesis& part, const TrackHypothesis& whole) const;
  bool one_above_another(const Box& a, const Box& b, const Box& region) const;
  bool side_by_side(const Box& a, const Box& b, const Box& expected) const;

  Parameters parameters_;
  // Of the call in progress.
  std::span<const TrackHypothesis> tracks_;
  std::span<Region> regions_;
  RegionAppearances* appearances_ = nullptr;
  Frame frame_;

  std::vector<Match> matches_;
  std::vector<int> owner_;      // track of each region, -1 none
  std::vector<char> fragment_;  // of each region: it completes another one
  std::vector<double> cost_, unmatched_;
  std::vector<int> rows_;  // tracks that take part in an assignment
  Assignment assignment_;
};

}  // namespace cerberus::vision
