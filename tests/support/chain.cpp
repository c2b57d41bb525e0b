// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/chain.h"

#include <array>

namespace cerberus::tests {

using namespace vision;

const char* Chain::stage_name(std::size_t stage) {
  static constexpr std::array names{"luma",    "camera motion", "differences", "threshold and moving area",
                                    "regions", "tracks"};
  return names.at(stage);
}

void Chain::begin(const LumaSource& frame, double seconds) {
  source_ = frame;
  const std::uint64_t number = frame_.number + 1;
  frame_ = {};
  frame_.size = {frame.width, frame.height};
  frame_.seconds = fresh_ ? 0 : seconds;
  frame_.fresh = fresh_;
  frame_.number = number;
  fresh_ = false;
}

void Chain::run_stage(std::size_t stage) {
  switch (static_cast<Stage>(stage)) {
    case Stage::luma:
      record_ = {};
      record_ = detector_.begin(source_);
      break;
    case Stage::camera:
      detector_.measure_camera(*record_, frame_);
      break;
    case Stage::differences:
      detector_.find_differences(*record_, frame_);
      break;
    case Stage::foreground:
      detector_.find_foreground(*record_, frame_);
      break;
    case Stage::regions:
      detector_.find_regions(*record_, frame_);
      break;
    case Stage::tracks:
      detector_.track(*record_, frame_, record_->regions->regions);
      break;
  }
}

void Chain::step(const LumaSource& frame, double seconds) {
  begin(frame, seconds);
  for (std::size_t s = 0; s < kStages; ++s) run_stage(s);
}

}  // namespace cerberus::tests
