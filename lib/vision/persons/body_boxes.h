// SPDX-License-Identifier: LGPL-2.1-or-later
// Boxes of bodies from the windows of a people detector.
#pragma once

#include <vector>

#include "vision/persons/person_detector.h"

namespace cerberus::vision {

// The part of a detector's window that the person covers, around the window's middle: shares of its width and height.
struct BodyShare {
  double width = 1, height = 1;
};

struct BodyBoxParameters {
  // Intersection over union of two windows: more, and they show one person. Usual of non-maximum suppression.
  double same_window = 0.5;
  // Share of the smaller of two bodies that lies in the other: this much, and they are one body. (Beyond half, their middles
  // are nearer to each other than half the wider one's width: they stand on one upright axis.)
  // Measured: without this rule the mean MOTA of a tracker on seven sequences falls from 55 to 28. Guard: bench-persons.
  double nested = 0.65;
};

// Of hits that overlap by more than same_window, the one with the best score stays (non-maximum suppression). Leaves
// the best score first; the result does not depend on the order of the hits.
void suppress_overlaps(std::vector<PersonDetection>& hits, const BodyBoxParameters& p = {});

// Whether two boxes are taken for one body, as a torso within it: so much of the smaller lies in the other.
bool is_one_body(const Box& a, const Box& b, const BodyBoxParameters& p = {});

// Of boxes that are one body, the one with the best score stays. Leaves the best score first.
void keep_one_box_a_body(std::vector<PersonDetection>& bodies, const BodyBoxParameters& p = {});

// The steps in a row: a detector's hits become one box a body, surest first.
void hits_to_bodies(std::vector<PersonDetection>& hits, BodyShare share, const BodyBoxParameters& p = {});

}  // namespace cerberus::vision
