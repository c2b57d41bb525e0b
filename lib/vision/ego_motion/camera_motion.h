// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's own motion between consecutive frames, estimated from the picture alone (paper II.B, first line:
// "the camera motion of the input frame is compensated").
#pragma once

#include <memory>
#include <optional>

#include "vision/ego_motion/motion_fit.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct CameraMotionOptions {
  MotionModel model = MotionModel::similarity;
};

struct CameraMotionResult {
  Transform transform;  // frame k-1 to frame k, analysis pixels; identity at the first frame of a scene
  // Share of the picture's usable patches that follow the transform, 0..1; 0 where too few parts of the picture say
  // anything (the transform then is the prior's, or identity).
  double confidence = 0;
  double residual = 0;  // RMS distance of those patches from it, analysis pixels
  bool still = false;   // the camera stands: the transform is exactly identity
  int scene_age = 0;  // frames of this scene seen, this one included: 1 = no predecessor (start, reset, cut)
};

// Feeds on one analysis picture a frame. Keeps a copy of what it needs of the previous one (a small pyramid).
class CameraMotion {
 public:
  CameraMotion();
  ~CameraMotion();
  CameraMotion(CameraMotion&&) noexcept;
  CameraMotion& operator=(CameraMotion&&) noexcept;

  void set_options(const CameraMotionOptions& options);
  // Forget the previous frame: the next one starts a scene.
  void reset();
  // `prior`: where the head's pose says the picture went (frame k-1 to k, analysis pixels). A first guess; and where
  // the turned picture is bent, a simple model is laid over it if that explains the picture better than the model
  // alone. A change of picture size resets by itself. A cut is recognised here and starts a scene (scene_age 1).
  CameraMotionResult update(GrayView picture, const std::optional<Transform>& prior = std::nullopt);
  // Bytes held, for the memory budget.
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
