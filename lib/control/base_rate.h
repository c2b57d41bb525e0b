// SPDX-License-Identifier: LGPL-2.1-or-later
// Yaw rate of the base that carries the head: the turn of the picture minus the turn of the head.
#pragma once

#include <array>
#include <optional>

#include "motion/head_limits.h"
#include "motion/pan_tilt.h"
#include "vision/geometry/lens.h"
#include "vision/geometry/transform.h"

namespace cerberus::control {

// Radians to the right and up.
struct Turn {
  double yaw = 0, pitch = 0;
};

// Returns the turn of the base: `motion` (frame k-1 to k, pixels of a picture of this size, seen through `lens`) minus
// the head's turn from `before` to `after`.
//   mean over a grid of the picture of  direction(p, before) - direction(motion p, after)
// The mean is taken over bearings, because the shift of a simple model is a mean over pixels: at the border of a 60
// degree lens a degree has a third more pixels than in the middle. NaN for an unknown lens or pose.
Turn base_turn(const vision::Transform& motion, const vision::Lens& lens, vision::Size picture,
               const motion::PanTilt& before, const motion::PanTilt& after);

// The motion of the picture since the frame before, as measured.
struct PictureMotion {
  vision::Transform transform;  // frame pixels
  double confidence = 0;        // 0 to 1: share of the picture that agrees
  vision::Size picture;         // pixels
  double base_yaw = 0;          // radians by which the base turned meanwhile, as reported
  bool base_reported = false;   // it was, which a base_yaw other than 0 says as well
};
// Whether something measures the turn of the base, so that head_turn() is the head's alone.
inline bool base_is_known(const PictureMotion& motion) {
  return motion.base_reported || motion.base_yaw != 0;
}
// Returns the turn of a head that looks at `look` and whose picture moved. Nothing: the confidence is too low, or it is
// no motion of a camera, or the lens is unknown.
std::optional<Turn> head_turn(const PictureMotion& motion, const vision::Lens& lens,
                              const motion::PanTilt& look);

// Converts the turns of single frames to a rate: the mean of their middle half over kSpan, so that neither a wrong
// measurement nor a shaking camera counts as a turn.
class BaseRate {
 public:
  static constexpr motion::Time kSpan = std::chrono::milliseconds(300);
  static constexpr int kLeast = 3;  // frames, whatever their duration
  static constexpr motion::Time kStale =
      std::chrono::milliseconds(700);  // without a frame: the rate is unknown
  static constexpr motion::Time kSettle = std::chrono::milliseconds(150);  // longest assumed lag of a head

  void reset();
  // Adds a frame taken at `time`, `seconds` after the one before. `turn`: of the base since then, radians; NaN:
  // unknown. `head_rate`: the head's mean speed since then, radians a second. Frames at and just after an abrupt change
  // of it are ignored: there the lag of the head appears as a turn of the base.
  void add(motion::Time time, double seconds, double turn, double head_rate);
  // Returns the rate in radians a second, positive to the right. NaN: unknown.
  double at(motion::Time time) const;

 private:
  struct Entry {
    motion::Time time{};
    double rate = 0;
  };
  static constexpr unsigned kKept = 64;
  const Entry& nth_last(unsigned n) const { return entries_[(next_ + kKept - 1 - n) % kKept]; }

  std::array<Entry, kKept> entries_{};
  unsigned next_ = 0, count_ = 0;
  double head_rate_ = 0;
  motion::Time calm_from_{};
};

}  // namespace cerberus::control
