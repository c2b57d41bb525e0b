// SPDX-License-Identifier: LGPL-2.1-or-later
// Who is who once people have parted: where they were close together places alone may have swapped their identities,
// and what each looks like afterwards tells.
#pragma once

#include <span>

#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {

// Have they gone different ways for as long as both are known? Pieces of one object never do.
bool apart(const TrackHypothesis& a, const TrackHypothesis& b);
// Do they look so different that they are two?
bool strangers(const TrackHypothesis& a, const TrackHypothesis& b);

// Gives identities back: of two bodies near each other that look, since they were last mixed up with anybody, so much
// more like each other did before than like themselves, the identities are exchanged.
void swap_mistaken_identities(std::span<TrackHypothesis> bodies);

}  // namespace cerberus::vision
