// SPDX-License-Identifier: LGPL-2.1-or-later
// Identity swaps: where two tracks were close together their positions alone may have exchanged their identities; the
// appearance afterwards shows it.
#pragma once

#include <span>

#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {

// Where no origin stands the value was chosen by hand. Guard: switches of PETS09-S2L1 and tests/unit (identity_swap,
// coats).
struct IdentitySwapParameters {
  double gain = 0.2;     // sum of appearance distances that an exchange must save
  double contact = 0.6;  // S: centres of two objects that touch,
  double parting = 1.5;  // S/s: and how fast they come apart. derived: two walkers in opposite directions
  double longest = 4;    // s since contact after which no exchange is considered
};
inline constexpr IdentitySwapParameters kIdentitySwapParameters;

// The two have gone different ways for as long as both exist. Fragments of one object never do.
bool went_apart(const TrackHypothesis& a, const TrackHypothesis& b);
// Both appearances are known and so different that they are two objects.
bool look_different(const TrackHypothesis& a, const TrackHypothesis& b);

// Exchanges the identities of two tracks near each other where each has looked, since the last contact, so much more
// like the other did before than like itself.
void undo_identity_swaps(std::span<TrackHypothesis> tracks,
                         const IdentitySwapParameters& parameters = kIdentitySwapParameters);

}  // namespace cerberus::vision
