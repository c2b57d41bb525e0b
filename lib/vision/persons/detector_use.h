// SPDX-License-Identifier: LGPL-2.1-or-later
// What a detector's scores say to a tracker.
#pragma once

namespace cerberus::vision {

struct DetectorUse {
  double threshold = 0;   // score from which on a body begins a track, by default
  double gain = 1;        // of the score, to that of EvidenceLook
  double least = 0;       // score down to which boxes of a whole frame are of use to a tracker
  bool encloses = false;  // EvidenceLook::encloses
};

// Of networks, whose scores are probabilities. Measured: the best of a published network on six scenes with nobody is .37, and of
// most people .8 to .99: from .9 on one look suffices. swept: a gain of 2 / 4 / 5 gives a mean MOTA of .70 / .74 / .75.
inline constexpr DetectorUse kNetworkUse{.threshold = 0.55, .gain = 5, .least = 0.4, .encloses = true};

// A detector's score as EvidenceLook has it: .5 at the threshold.
constexpr double evidence_score(double score, double threshold, const DetectorUse& use) {
  return 0.5 + use.gain * (score - threshold);
}

}  // namespace cerberus::vision
