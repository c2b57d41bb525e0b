// SPDX-License-Identifier: LGPL-2.1-or-later
// Identities for boxes of elements that give none.
#pragma once

#include <cstdint>
#include <span>

#include "vision/tracking/tracker.h"

namespace cerberus::vision {

// Gives tracks without an identity (id 0), in the order of `now`, the one of the track of the frame before that they
// overlap most, by an intersection over union above 0.3, each once; else the next one after `last`, which counts on.
void keep_identities(std::span<const Track> before, std::span<Track> now, std::uint32_t& last);

}  // namespace cerberus::vision
