// SPDX-License-Identifier: LGPL-2.1-or-later
// Where points of one picture lie in the next one: pyramidal Lucas-Kanade (B. D. Lucas, T. Kanade 1981) in its inverse
// compositional form (S. Baker, I. Matthews 2004), for a translation of a small window.
#pragma once

#include <optional>

#include "vision/geometry/transform.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

struct SparseFlowParameters {
  int levels = 3;  // of the pyramid, the picture included. The trial's.
  double least_edge =
      2;  // grey levels a pixel, squared: smaller eigenvalue of the window's mean gradient matrix
  int iterations = 8;  // at most, a level
  double step = 0.03;  // pixels; a smaller correction ends the iterations
};

// Both pyramids have the same size and at least `parameters.levels` levels. at: point of `before`; guess: where it may lie
// in `now`, pixels of level 0. nullopt: the window leaves a picture, has no texture, or the search diverges.
std::optional<Point> follow_point(const Pyramid& before, const Pyramid& now, Point at, Point guess,
                                  const SparseFlowParameters& parameters = {});

}  // namespace cerberus::vision
