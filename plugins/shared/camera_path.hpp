// SPDX-License-Identifier: LGPL-2.1-or-later
// Camera motion on a frame as lib/vision/camera_path.h knows it.
#pragma once

#include <cerberus/cerberus.h>

#include <algorithm>
#include <iterator>

#include "vision/camera_path.h"

namespace cerberus::plugin {

inline vision::CameraPathPoint path_point(const CerberusCameraMotion& motion) {
  vision::CameraPathPoint point{{}, motion.still != FALSE, motion.from, motion.scene_age, motion.path_id, {}};
  std::copy(std::begin(motion.matrix), std::end(motion.matrix), point.step.m.begin());
  std::copy(std::begin(motion.path), std::end(motion.path), point.path.m.begin());
  return point;
}
// Nothing where the frame carries none.
inline std::optional<vision::CameraPathPoint> path_point(GstBuffer* frame) {
  const CerberusCameraMotion* motion = cerberus_buffer_peek_camera_motion(frame);
  return motion ? std::optional(path_point(*motion)) : std::nullopt;
}

}  // namespace cerberus::plugin
