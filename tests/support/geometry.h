// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "sensing/angles.h"
#include "sensing/sectors.h"

#include <check.h>  // last: it defines fail()

namespace cerberus::tests {

// Of sensors that look along these bearings, degrees.
inline sensing::Geometry geometry(std::vector<double> bearings, double field_of_view) {
  for (double& bearing : bearings) bearing = sensing::radians(bearing);
  sensing::Geometry result;
  ck_assert(result.set(bearings, sensing::radians(field_of_view)));
  return result;
}

}  // namespace cerberus::tests
