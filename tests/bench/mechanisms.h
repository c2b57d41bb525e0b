// SPDX-License-Identifier: LGPL-2.1-or-later
// The mechanisms of detection and tracking, each of which a bench can leave out: by a switch of the library, or by a number
// with which it does nothing.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "vision/detector.h"
#include "vision/detector_parameters.h"

namespace cerberus::bench {

// A detector as motiondetect sets it up, but for what is left out of it.
struct DetectorSettings {
  DetectorSettings() { options.burnt_in = true; }
  vision::DetectorParameters numbers;
  vision::DetectorOptions options;
  bool camera_motion = true;  // else the camera is taken to stand
};

struct Mechanism {
  const char* name;
  // Files of lib/vision, with ".*" for source and header; or a file and a function in it: "components/components.cpp decide".
  std::vector<const char*> sources;
  int other_numbers;  // tuned numbers of its own in files that it shares
  // Each "stage.name=value" (parameters.h).
  std::vector<const char*> without;
  void (*leave_out)(DetectorSettings&) = nullptr;
};
// In the order in which a frame meets them. A mechanism may be a part of another one.
const std::vector<Mechanism>& mechanisms();

// names: of mechanisms, separated by commas. Returns what is wrong with them, with the names that there are, or nothing.
std::string leave_out(DetectorSettings& settings, std::string_view names);

struct Extent {
  int lines = 0, numbers = 0;
};
// Of a mechanism in a source tree. A source that is not there counts nothing.
Extent extent_of(const Mechanism& mechanism, const std::filesystem::path& source_tree);

}  // namespace cerberus::bench
