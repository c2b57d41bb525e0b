// SPDX-License-Identifier: LGPL-2.1-or-later
// Finds people in one picture. plugins/verify implements it with OpenCV.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/persons/person_picture.h"

namespace cerberus::vision {

struct PersonDetection {
  Box box;           // pixels of the picture
  double score = 0;  // the detector's own measure; higher is surer
};

class PersonDetector {
 public:
  virtual ~PersonDetector() = default;
  // Appends every hit in `picture`, several for one person; the order is of no account. scale: by which a detector with a
  // window of fixed size enlarges the picture; a network fits the picture to its input instead. Where the detector
  // turns out to be none that can be used, returns a sentence that says why. Throws std::exception.
  virtual std::optional<std::string> detect(const PersonPicture& picture, double scale,
                                            std::vector<PersonDetection>& hits) = 0;
  // Whether it makes use of colours.
  virtual bool sees_colours() const { return false; }
};

}  // namespace cerberus::vision
