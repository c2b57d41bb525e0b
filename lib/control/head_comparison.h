// SPDX-License-Identifier: LGPL-2.1-or-later
// Compares the turn of the picture with the turn of the head that carries the camera, from frame to frame. What the
// head does not explain is a turn of the base below it, or a fault of the head (slip.h). Not thread-safe; allocates
// nothing.
#pragma once

#include <optional>

#include "control/base_rate.h"
#include "control/slip.h"
#include "motion/pan_tilt.h"
#include "vision/geometry/lens.h"
#include "vision/geometry/transform.h"

namespace cerberus::control {

class HeadComparison {
 public:
  struct Parameters {
    // Share of the picture that must agree with the measured motion before it is compared. Chosen: below half of it,
    // a person who fills the picture may be what was measured. Guarded by unit-head_comparison.
    double least_confidence = .5;
  };

  // The head when a frame was taken.
  struct Head {
    // Radians; nothing: there is no head, or no pose of it yet; not finite: there is one and its direction is not known.
    std::optional<motion::PanTilt> look;
    const char* name = nullptr;  // compared by its address only: interned
    bool commanded =
        false;  // by its commands, which it may fail to execute; else as the source of the frame knows
  };

  // The motion of the picture since the frame before.
  struct Picture {
    vision::Size size;         // pixels
    vision::Transform motion;  // pixels
    double confidence = 0;     // 0 to 1; 0: unknown
    motion::Time time{};       // running time of the frame, 0 if it has none
    double seconds = 0;        // since the frame before; 0: none, or not known
    bool fresh = true;         // the frame begins a scene
  };

  struct Faults {
    std::optional<SlipFinding> pan, tilt;
  };

  HeadComparison() = default;
  explicit HeadComparison(const Parameters& parameters) : parameters_(parameters) {}

  // Forgets all frames and faults.
  void reset() { *this = HeadComparison(parameters_); }
  // Forgets the evidence of faults, for another lens or another head.
  void forget_faults();

  // For each frame in this order: expect(), base_rate(), faults().

  // Adds the head of the next frame. Returns the motion of the picture since the frame before that follows from both
  // heads, pixels; nothing where one of them or the lens is unknown.
  std::optional<vision::Transform> expect(const Head& head, const vision::Lens& lens);
  // Adds the picture's motion. Returns the yaw rate of the base, radians a second, positive to the right; NaN: unknown.
  double base_rate(const Picture& picture, const vision::Lens& lens);
  // The same for a frame that repeats the last picture.
  double base_rate(motion::Time time) const { return base_.at(time); }
  // Returns the faults that the frame completes the evidence of. reported: yaw rate of the base that was measured by
  // other means, radians a second, 0 if none was.
  Faults faults(double seconds, double reported);

  const Head& head() const { return now_; }

 private:
  Parameters parameters_;
  Head before_, now_;
  BaseRate base_;
  SlipWatch pan_, tilt_;
  // Of the last frame, radians: the base's turn as the picture shows it, and the head's.
  Turn turn_;
  double pan_turn_ = 0, tilt_turn_ = 0;
  bool comparable_ = false;
};

}  // namespace cerberus::control
