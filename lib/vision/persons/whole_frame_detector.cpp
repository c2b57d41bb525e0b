// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/whole_frame_detector.h"

namespace cerberus::vision {

std::optional<std::string> WholeFrameDetector::find(const PersonPicture& frame,
                                                    std::vector<PersonDetection>& bodies) {
  bodies.clear();
  const double scale = lines_ > 0 ? static_cast<double>(lines_) / frame.luma.height : 1;
  auto refusal = detector_->detect(frame, scale, bodies);
  hits_to_bodies(bodies, share_);
  return refusal;
}

}  // namespace cerberus::vision
