// SPDX-License-Identifier: LGPL-2.1-or-later
// Names of the tuned numbers of detection and tracking: for sweeps (bench-quality --set).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "vision/detector_parameters.h"

namespace cerberus::bench {

struct NamedNumber {
  std::string name;  // "stage.name", as "track.gate" or "people.head.reach"
  std::variant<double*, int*> number;
  int least = 0;  // of a whole number: 1 where something is divided by it, or into as many
};
// All of them; they point into `parameters`.
std::vector<NamedNumber> named_numbers(vision::DetectorParameters& parameters);

// Sets one number. assignment: "stage.name=value"; the value is finite, a whole number at least as in NamedNumber and at
// most a million. Returns what is wrong with it, with the names that there are, or nothing where the number is set; else
// `parameters` is unchanged. Whether a number makes sense is not checked.
std::string set_number(vision::DetectorParameters& parameters, std::string_view assignment);

}  // namespace cerberus::bench
