// SPDX-License-Identifier: LGPL-2.1-or-later
// Appearance of the regions of a frame, and the position of a known appearance within a region of several objects.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "vision/tracking/appearance_model.h"
#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {

class RegionAppearances {
 public:
  // Where no origin stands the value was chosen by hand. Guard: tests/unit/coats and MOTA 70 on PETS09-S2L1.
  struct Parameters {
    int samples = 500;           // pixels that are read of a region
    int rough_samples = 120;     // and of each candidate position in a group
    double reach = 0.5;          // S to either side that is searched
    double displacement = 0.05;  // cost of the farthest position to the side; twice as much up or down
    double steps = 6;            // candidate positions in the width of a box
    double inside = 0.8;         // of a candidate box that lies in the region
  };

  RegionAppearances() = default;
  RegionAppearances(const Parameters& parameters, const AppearanceParameters& appearance)
      : parameters_(parameters), level_(appearance) {}

  void reserve(std::size_t regions) { appearances_.reserve(regions); }
  void reset() { level_.reset(); }
  // A frame. regions: boxes in frame pixels. motion: frame k-1 to k, frame pixels. input lives until done(). Without
  // it no appearance is known.
  void update(const Sight& input, std::span<const Region> regions, const Transform& motion, Size frame);
  const AppearanceModel& of(std::size_t region) const { return appearances_[region]; }
  // After the region's box has changed.
  void recompute(std::size_t region, const Box& box);
  const Sight& sight() const { return input_; }
  // From frame pixels to those of the sight.
  Box in_sight(const Box& box) const;
  // The input of update() is not used any more.
  void done() { input_ = {}; }
  // Offset in frame pixels from the track's expected position to the best one by appearance in the region. Nothing:
  // no position looks like the track.
  std::optional<Point> find(const TrackHypothesis& track, const Box& region) const;
  std::size_t bytes() const { return appearances_.capacity() * sizeof(AppearanceModel); }

 private:
  AppearanceModel appearance_of(const Sight& input, const Box& box, int samples) const;

  Parameters parameters_;
  Sight input_;
  BrightnessLevel level_;
  std::vector<AppearanceModel> appearances_;  // of each region
  Size frame_;
};

}  // namespace cerberus::vision
