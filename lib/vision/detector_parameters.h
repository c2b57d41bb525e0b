// SPDX-License-Identifier: LGPL-2.1-or-later
// All tuned numbers of detection and tracking; tests/bench/parameters.h gives them names.
#pragma once

#include "vision/detection/region_parameters.h"
#include "vision/geometry/box_edge.h"
#include "vision/tracking/tracking_parameters.h"

namespace cerberus::vision {

struct DetectorParameters {
  DetectionParameters detection;
  TrackingParameters tracking;
  BoxEdgeParameters edge;
};

}  // namespace cerberus::vision
