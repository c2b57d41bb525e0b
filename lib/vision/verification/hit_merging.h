// SPDX-License-Identifier: LGPL-2.1-or-later
// One detection a person, of the many hits that a detector returns for one.
#pragma once

#include <vector>

#include "vision/persons/person_detector.h"

namespace cerberus::vision {

// Replaces the hits by one detection a person, surest first. Hits that overlap the surest one by more than half of
// their union become one box, the mean weighted by score - floor; of the others, those that overlap it by more than
// `apart` are dropped. The result does not depend on the order of the hits.
void merge_hits(std::vector<PersonDetection>& hits, double floor, double apart = 0.4);

}  // namespace cerberus::vision
