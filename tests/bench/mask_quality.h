// SPDX-License-Identifier: LGPL-2.1-or-later
// How right the masks of a detector are.
#pragma once

#include <filesystem>
#include <string>

#include "sequences.h"

namespace cerberus::bench {

// Over all scored pixels of the sequence; nothing where it cannot be read. detector: elements of a launch line.
Counts mask_quality(const Sequence& s, const std::filesystem::path& data, const std::string& detector);

// The same of a plain detector without memory: what differs from the frame before, registered by our own measurement of
// the camera's motion and with a tolerance of 3x3 pixels, by more than the noise; closed by 9 pixels.
Counts compensated_difference(const Sequence& s, const std::filesystem::path& data);

}  // namespace cerberus::bench
