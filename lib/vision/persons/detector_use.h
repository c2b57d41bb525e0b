// SPDX-License-Identifier: LGPL-2.1-or-later
// What a detector's scores say to a tracker.
#pragma once

namespace cerberus::vision {

struct DetectorUse {
  double threshold = 0;  // score from which on a body begins a track, by default
  double gain = 1;       // of the score, to that of EvidenceLook
  double least = 0;      // score down to which boxes of a whole frame are of use to a tracker
};

// Of networks, whose scores are probabilities. The gain makes .3 no evidence: the trial's.
inline constexpr DetectorUse kNetworkUse{.threshold = 0.55, .gain = 2, .least = 0.2};

// A detector's score as EvidenceLook has it: .5 at the threshold.
constexpr double evidence_score(double score, double threshold, const DetectorUse& use) {
  return 0.5 + use.gain * (score - threshold);
}

}  // namespace cerberus::vision
