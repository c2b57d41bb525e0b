// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's own motion between consecutive frames, estimated from the picture alone (paper II.B, first line:
// "the camera motion of the input frame is compensated").
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "vision/ego_motion/motion_fit.h"
#include "vision/ego_motion/scene_calm.h"
#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct CameraMotionOptions {
  MotionModel model = MotionModel::similarity;
};

struct CameraMotionResult {
  Transform transform;  // frame k-1 to frame k, analysis pixels; identity at the first frame of a scene
  // Share of the picture's usable patches that follow the transform, 0..1; 0 where too few parts of the picture have
  // matches (the transform is then the prior, the previous motion or identity).
  double confidence = 0;
  double residual = 0;  // RMS distance of those patches from the transform, analysis pixels
  bool still = false;   // the camera stands: the transform is exactly identity
  int scene_age =
      0;  // number of frames of this scene, this one included: 1 = no predecessor (start, reset, cut)
  SceneCorners corners;  // and whether they follow the transform
  double calm = 1;       // see SceneCalm::share(); filled by Detector::track(), which knows what is no scene
};

// Estimates the camera's motion from one analysis picture a frame. Keeps a small pyramid of an earlier picture, and no
// reference to the caller's pictures.
class CameraMotion {
 public:
  CameraMotion();
  ~CameraMotion();
  CameraMotion(CameraMotion&&) noexcept;
  CameraMotion& operator=(CameraMotion&&) noexcept;

  void set_options(const CameraMotionOptions& options);
  // Discards the previous frame: the next one starts a scene.
  void reset();
  // `prior`: the motion of the picture that follows from the head's poses (frame k-1 to k, analysis pixels). It serves
  // as a first guess; where the turn bends the picture (a homography), the model is also fitted on top of the prior,
  // and the better of both fits is used. A change of picture size resets by itself. A cut is recognised here and starts
  // a scene (scene_age 1). `excluded`: parts that show no scene (burnt_in.h), analysis pixels; no patch of them is used.
  CameraMotionResult update(GrayView picture, const std::optional<Transform>& prior = std::nullopt,
                            std::span<const Box> excluded = {});
  // Bytes in use, for the memory budget.
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::vision
