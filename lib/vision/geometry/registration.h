// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace cerberus::vision {

// Frames at the start of a scene in which a background model still has registration errors of its own nearly
// everywhere. The background model and the confirmation of new regions both wait for its end.
inline constexpr int kUnsettledFrames = 12;

}  // namespace cerberus::vision
