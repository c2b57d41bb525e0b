// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons in the output of a neural network that detects objects.
#pragma once

#include <span>
#include <vector>

#include "vision/verification/person_detector.h"

namespace cerberus::vision {

struct NetworkOutput {
  std::span<const float> values;
  std::vector<int> shape;
};

// Appends what the outputs say of persons with a score (0 to 1) of at least `threshold`: boxes in pixels of the input of size `input`.
// person: number of the class, or -1: the first one (YOLO), the first after the background (SSD). The heads:
// - YOLO, one output: 1 x boxes x (4 + 1 + classes), the middle, width and height in pixels, the score that there is an object, scores of
//   the classes (version 5 and 7); or 1 x (4 + classes) x boxes, without the object's score (version 8 and 11);
// - SSD: one output 1 x 1 x boxes x 7: picture, class, score, left, top, right, bottom; or two, 1 x boxes x 4 (left, top, right,
//   bottom) and 1 x boxes x classes; in shares of the input.
// Returns false where the outputs are none of these, or have no such class.
bool read_persons(std::span<const NetworkOutput> outputs, Size input, int person, double threshold,
                  std::vector<PersonDetection>& hits);

}  // namespace cerberus::vision
