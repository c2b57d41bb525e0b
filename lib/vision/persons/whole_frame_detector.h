// SPDX-License-Identifier: LGPL-2.1-or-later
// A people detector over the whole frame.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vision/persons/body_boxes.h"
#include "vision/persons/person_detector.h"

namespace cerberus::vision {

class WholeFrameDetector {
 public:
  // lines: height of the picture that the detector scans; 0: it fits the frame to its own input, as networks do. share:
  // of its windows. detector: not nullptr.
  WholeFrameDetector(std::unique_ptr<PersonDetector> detector, int lines, BodyShare share)
      : detector_(std::move(detector)), lines_(lines), share_(share) {}

  // Replaces `bodies` by one box for each person found, in pixels of the frame, surest first. Returns nullopt, or why the
  // detector cannot be used (PersonDetector::detect). Throws std::exception.
  std::optional<std::string> find(const PersonPicture& frame, std::vector<PersonDetection>& bodies);
  bool sees_colours() const { return detector_->sees_colours(); }

 private:
  std::unique_ptr<PersonDetector> detector_;
  int lines_;
  BodyShare share_;
};

}  // namespace cerberus::vision
