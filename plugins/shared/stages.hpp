// SPDX-License-Identifier: LGPL-2.1-or-later
// The steps from a frame to its regions, each with its predecessor inside: a stage whose input is not on the buffer
// makes that input itself, with the defaults, and leaves it there for those who follow. Every element of the corridor
// is one of these stages with properties; so the bin and the chain cannot differ. What a predecessor needs it takes
// when it is needed first: mostly it is upstream.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cerberus/private/plane_pool.hpp"
#include "frame.hpp"
#include "vision/background/foreground_mask.h"
#include "vision/change/three_frame_difference.h"
#include "vision/detection/burnt_in.h"
#include "vision/detection/limits.h"
#include "vision/detection/regions.h"
#include "vision/detection/zones.h"
#include "vision/geometry/lens.h"
#include "vision/image/luma.h"

namespace cerberus::plugin {

inline constexpr int kDefaultAnalysisWidth = 320;

// The frame's small grey picture.
class LumaStage {
 public:
  void set_analysis_width(int width) { analysis_width_ = width; }
  // The plane upstream attached, else one of our own (attached too). Empty: the buffer's memory does not hold the
  // picture its caps promise.
  MappedPlane obtain(Frame& frame);
  // Always our own.
  MappedPlane make(Frame& frame);

 private:
  int analysis_width_ = kDefaultAnalysisWidth;
  vision::LumaScaler scaler_;
  PlanePool pool_;
};

// What rides in a HISTOGRAM plane: 256 counts, over how many frames the differences span, and how the threshold was
// chosen from the counts, once it was.
struct HistogramRecord {
  std::uint32_t count[256];
  std::int32_t frames, previous;                  // vision::DifferenceResult
  std::int32_t chosen;                            // 0: the rest is not known yet
  std::int32_t weighting, extremes, order, clip;  // vision::FuzzyThresholdOptions
};

// Registered differences and their histogram (Eq. 1, 2).
class DifferenceStage {
 public:
  LumaStage& luma() { return luma_; }
  void set_options(const vision::DifferenceOptions& options) {
    options_ = options;
    if (difference_) difference_->set_options(options);
  }
  // Both return false for an unusable buffer. ensure() takes what is on the buffer if it has
  // this size, and D(k-1) as it comes: upstream was asked for it.
  bool ensure(Frame& frame, vision::Size size, bool previous_wanted);
  bool run(Frame& frame, bool previous_wanted);

 private:
  LumaStage luma_;
  vision::DifferenceOptions options_;
  std::optional<vision::ThreeFrameDifference> difference_;
  Sequence sequence_;
  PlanePool current_pool_, previous_pool_, histogram_pool_;
};

// Threshold and moving area (Eq. 3 to 10).
class MaskStage {
 public:
  LumaStage& luma() { return before_.luma(); }
  void set_options(const vision::ForegroundMaskOptions& options) {
    options_ = options;
    if (area_) area_->set_options(options);
  }
  void learn_burnt_in(bool on) {
    if (!on) burnt_in_.reset();
    learns_burnt_in_ = on;
  }
  // What the camera writes into its pictures, if that is news since the frame before: frame pixels.
  std::span<const vision::Box> burnt_in_news() const { return news_; }
  bool ensure(Frame& frame);
  bool run(Frame& frame);

 private:
  void tell_how(GstBuffer* buffer, HistogramRecord& record);
  DifferenceStage before_;
  vision::ForegroundMaskOptions options_;
  std::optional<vision::ForegroundMask> area_;
  vision::BurntIn burnt_in_;
  bool learns_burnt_in_ = true;
  std::vector<vision::Box> news_;
  vision::Size size_;
  Sequence sequence_;
  PlanePool pool_, histogram_pool_;
};

// Regions of interest from the moving area.
class RegionStage {
 public:
  LumaStage& luma() { return before_.luma(); }
  void set_options(const vision::RegionOptions& options) { finder_.set_options(options); }
  vision::Zones& zones() { return zones_; }
  // Of the mask of the last frame.
  vision::Size size() const { return size_; }
  // field_of_view: horizontal, radians, 0 = unknown (limits in metres are not judged then); mounting_height: metres;
  // tilt: radians, of frames that bring none.
  void set_gate(const vision::SizeLimits& gate, double field_of_view, double mounting_height, double tilt) {
    gate_ = gate;
    field_of_view_ = field_of_view;
    mounting_height_ = mounting_height;
    tilt_ = tilt;
  }
  // False for an unusable buffer. Labels (2 bytes a pixel) are only made where planes are wanted.
  bool run(Frame& frame);

 private:
  void publish(Frame& frame, std::span<const vision::Region> regions, vision::Size analysis);
  MaskStage before_;
  vision::RegionFinder finder_;
  vision::Zones zones_;
  vision::SizeLimits gate_;
  double field_of_view_ = 0, mounting_height_ = 0, tilt_ = 0;
  vision::Size size_;
  Sequence sequence_;
  PlanePool mask_pool_, label_pool_;
};

// What motiontrack wants to see of a frame, the planes LUMA and MASK, may stay on it though nobody else asks for
// planes: leave_sight() takes off all the others (all of them where there is no motiontrack), drop_sight() what it
// left. Planes that stay for everybody are told by the LABELS among them.
void leave_sight(const Frame& frame);
void drop_sight(GstBuffer* buffer);

// "Nothing was found" and "nobody has looked" are told apart by a mark on the buffer.
bool regions_known(GstBuffer* buffer);
void mark_regions_known(GstBuffer* buffer);

}  // namespace cerberus::plugin
