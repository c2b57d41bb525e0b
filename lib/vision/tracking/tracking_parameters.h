// SPDX-License-Identifier: LGPL-2.1-or-later
// All tuned numbers of the tracker.
#pragma once

#include "vision/tracking/appearance_model.h"
#include "vision/tracking/data_association.h"
#include "vision/tracking/life_cycle.h"
#include "vision/tracking/region_appearances.h"
#include "vision/tracking/track_parameters.h"

namespace cerberus::vision {

// The part of the picture that has been in view for a while. By hand. Guard: tests/unit/turning.
struct ViewParameters {
  // s until what the camera has turned to counts as seen for a while: foreground there moves, as no object can have left
  // a hole in a model that did not exist
  double newly_visible = 0.5;
  double newly_visible_share = 0.5;  // of a region outside the established view
};

struct TrackingParameters {
  TrackParameters track;
  LifeCycle::Parameters life;
  DataAssociation::Parameters association;
  RegionAppearances::Parameters search;
  AppearanceParameters appearance;
  ViewParameters view;
};

}  // namespace cerberus::vision
