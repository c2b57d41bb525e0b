// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds people in one picture. plugins/verify implements it with OpenCV.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct PersonDetection {
  Box box;           // pixels of the picture
  double score = 0;  // the detector's own measure; higher is surer
};

class PersonDetector {
 public:
  virtual ~PersonDetector() = default;
  // Appends every hit in `picture`, several for one person; the order is of no account. scale: by which the picture is
  // to be enlarged so that the person that is looked for has VerificationParameters::look_height. Where the detector
  // turns out to be none that can be used, returns a sentence that says why. Throws std::exception.
  virtual std::optional<std::string> detect(GrayView picture, double scale,
                                            std::vector<PersonDetection>& hits) = 0;
};

// Replaces the hits by one detection a person, surest first. Hits that overlap the surest one by more than half of
// their union become one box, the mean weighted by score - floor; of the others, those that overlap it by more than
// `apart` are dropped. The result does not depend on the order of the hits.
void merge_hits(std::vector<PersonDetection>& hits, double floor, double apart = 0.4);

}  // namespace cerberus::vision
