// SPDX-License-Identifier: LGPL-2.1-or-later
// Is the simulated house as difficult as life? Real sequences, and scenes of the house that are made like them: the same
// height, distance, light and motion of the camera. What a detector makes of both is compared.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "patrol_score.h"

namespace cerberus::bench {

struct Twin {
  const char* name;
  std::vector<std::string> real;  // development sequences of the data folder
  std::string scene;              // launch line without seed=, ends in video
};
std::span<const Twin> twins();

// Of every real sequence, as it is and mirrored. Empty: one is missing or could not be read.
std::vector<PatrolFigures> measure_real(const Twin& twin, const std::string& elements,
                                        const std::filesystem::path& data);
// Of so many seeds. Empty: it did not run.
std::vector<PatrolFigures> measure_simulated(const Twin& twin, const std::string& elements, int seeds);

}  // namespace cerberus::bench
