// SPDX-License-Identifier: LGPL-2.1-or-later
// vision::Detector without GStreamer, stage by stage, with the elements' defaults (no label picture: no element reads
// it): for tests and benches of lib.
#pragma once

#include <cstddef>
#include <span>

#include "vision/detector.h"

namespace cerberus::tests {

class Chain {
 public:
  static constexpr std::size_t kStages = 6;
  static const char* stage_name(std::size_t stage);

  // A frame of `seconds` after the one before; then run_stage(0) ... run_stage(kStages - 1), or step() for
  // all.
  void begin(const vision::LumaSource& frame, double seconds);
  void run_stage(std::size_t stage);
  void step(const vision::LumaSource& frame, double seconds);
  // Forget all, as a seek does.
  void reset() { fresh_ = true; }
  // Default 320; 0: the frame's own size.
  void set_analysis_width(int width) {
    options_.analysis_width = width;
    detector_.set_options(options_);
  }
  // Whether what the camera writes into its pictures is learnt; default: no.
  void set_burnt_in(bool on) {
    options_.burnt_in = on;
    detector_.set_options(options_);
  }

  vision::Size analysis_size() const { return (*record_->luma)->size(); }
  vision::GrayView mask() const { return record_->mask(); }
  const vision::CameraMotionResult& motion() const { return *record_->camera; }
  const vision::ForegroundMaskResult& area() const { return record_->foreground->result; }
  std::span<const vision::Box> burnt_in() const { return detector_.burnt_in(); }         // analysis pixels
  std::span<const vision::Region> regions() const { return record_->regions->regions; }  // frame pixels
  std::span<const vision::Track> tracks() const { return *record_->tracks; }
  // Bytes that all stages hold, the record and its pictures included, but for its lists of regions and tracks.
  std::size_t bytes() const {
    return detector_.bytes() + record_->bytes() - own_bytes() -
           record_->tracks->capacity() * sizeof(vision::Track);
  }
  std::size_t own_bytes() const { return record_->regions->regions.capacity() * sizeof(vision::Region); }

 private:
  vision::LumaSource source_;
  vision::DetectorOptions options_;
  vision::Detector detector_;
  vision::DetectorFrame frame_;
  vision::Record record_;
  bool fresh_ = true;
};

}  // namespace cerberus::tests
