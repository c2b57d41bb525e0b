// SPDX-License-Identifier: LGPL-2.1-or-later
// Runs over the development sequences: each sequence at each analysis width, as it is and mirrored.
#pragma once

#include <string>
#include <vector>

#include "development_sequences.h"
#include "set_detector.h"

namespace cerberus::bench {

// Of all runs of a sequence, by detector; empty: it could not be read.
using SequenceOutcomes = std::vector<Outcome>;

// Of every sequence. The library's detectors see each frame once it is decoded; sequences and widths are spread over the
// processor's cores.
std::vector<SequenceOutcomes> measure(const std::vector<DevelopmentSequence>& sequences,
                                      const std::vector<int>& widths,
                                      const std::vector<DetectorSettings>& detectors);
// The same of one detector: a launch line, in which motiondetect gets the width.
std::vector<SequenceOutcomes> measure(const std::vector<DevelopmentSequence>& sequences,
                                      const std::vector<int>& widths, const std::string& elements);

// How calm the scene is in every frame of all runs (CameraMotionResult::calm). Empty: the sequence could not be read.
std::vector<double> measure_calm(const DevelopmentSequence& sequence, const std::vector<int>& widths);

}  // namespace cerberus::bench
