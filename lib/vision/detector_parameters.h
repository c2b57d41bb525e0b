// SPDX-License-Identifier: LGPL-2.1-or-later
// What benches may change: tuned numbers of detection and tracking, which tests/bench/parameters.h names, and mechanisms.
#pragma once

#include "vision/background/mechanisms.h"
#include "vision/detection/region_parameters.h"
#include "vision/geometry/box_edge.h"
#include "vision/tracking/tracking_parameters.h"

namespace cerberus::vision {

struct DetectorParameters {
  DetectionParameters detection;
  TrackingParameters tracking;
  BoxEdgeParameters edge;
  ForegroundMechanisms mechanisms;
};

}  // namespace cerberus::vision
