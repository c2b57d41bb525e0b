// SPDX-License-Identifier: LGPL-2.1-or-later
// The source of patrolsimsrc's video, which moves its world and tells its PIR sensors of it. It has patrolsimsrc's
// properties.
#pragma once

#include <gst/gst.h>

#include <memory>

#include "pir_stream.hpp"

namespace cerberus::plugin {

// Floating. Has the pad `src`.
GstElement* patrol_camera_new(std::shared_ptr<PirStream> pir);

}  // namespace cerberus::plugin
