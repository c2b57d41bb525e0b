// SPDX-License-Identifier: LGPL-2.1-or-later
// What the regions of a frame look like, and where in a region of several somebody who is known by his look stands.
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
  void reserve(std::size_t regions) { looks_.reserve(regions); }
  void reset() { level_.reset(); }
  // A frame. regions: boxes in frame pixels. motion: frame k-1 to k, frame pixels. sight lives until done(). Without
  // it nobody looks like anything.
  void update(const Sight& sight, std::span<const Region> regions, const Transform& motion, Size frame);
  const AppearanceModel& of(std::size_t region) const { return looks_[region]; }
  // The region's box is another one now.
  void look_again(std::size_t region, const Box& box);
  // What all of the box looks like, whether it moves or not.
  AppearanceModel place(const Box& box) const;
  // The frame is done: what was handed to update() may go.
  void done() { sight_ = {}; }
  // How far, in frame pixels, from where the body is expected what looks like it is in the region. Nothing: nothing
  // does.
  std::optional<Point> find(const TrackHypothesis& body, const Box& region) const;
  std::size_t bytes() const { return looks_.capacity() * sizeof(AppearanceModel); }

 private:
  AppearanceModel appearance_of(const Sight& sight, const Box& box, int samples) const;

  Sight sight_;
  BrightnessLevel level_;
  std::vector<AppearanceModel> looks_;  // of each region
  Size frame_;
};

}  // namespace cerberus::vision
