// SPDX-License-Identifier: LGPL-2.1-or-later
// When a detector looks of which only its boxes are known: it may look at few of the frames, and gives nothing where it
// finds nobody.
#pragma once

#include <array>
#include <cstddef>

namespace cerberus::vision {

class LookTimes {
 public:
  void reset() { *this = {}; }
  // Called once for each frame. seconds: since the previous one. boxes: it has boxes of persons. Returns whether it is
  // looked at: it has boxes, or a look is overdue, which then has shown nobody. None is before the first boxes.
  bool is_look(double seconds, bool boxes);
  // Called instead for a frame that is no look whatever it has.
  void pass(double seconds);

 private:
  // The second shortest: a look now and then shows nobody, and the interval around it is longer; a result that comes a frame
  // late, or a second one of a look, makes a shorter one.
  double usual() const;

  static constexpr std::size_t kKept = 4;
  std::array<double, kKept> intervals_{};  // s, of the last looks with boxes; 0: none
  std::size_t next_ = 0;
  bool begun_ = false;
  double since_boxes_ = 0, since_look_ = 0;  // s
};

}  // namespace cerberus::vision
