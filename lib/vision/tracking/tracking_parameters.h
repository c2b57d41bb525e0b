// SPDX-License-Identifier: LGPL-2.1-or-later
// All tuned numbers of the tracker.
#pragma once

#include "vision/tracking/appearance_model.h"
#include "vision/tracking/data_association.h"
#include "vision/tracking/life_cycle.h"
#include "vision/tracking/region_appearances.h"
#include "vision/tracking/track_parameters.h"

namespace cerberus::vision {

struct TrackingParameters {
  TrackParameters track;
  LifeCycle::Parameters life;
  DataAssociation::Parameters association;
  RegionAppearances::Parameters search;
  AppearanceParameters appearance;
};

}  // namespace cerberus::vision
