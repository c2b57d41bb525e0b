// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/look_times.h"

#include <algorithm>
#include <functional>

namespace cerberus::vision {
namespace {

// s. Chosen: detectors beside a video look once a second at the least; of what comes later the person was away.
constexpr double kUnknown = 1, kLongest = 5;
// Usual intervals after which a look is overdue. Derived: one at a multiple of a frame's duration comes up to a frame, which is
// an interval at the most, later than usual; half an interval later it is the next one's time.
constexpr double kOverdue = 1.5;

}  // namespace

double LookTimes::usual() const {
  std::array<double, kKept> known = intervals_;
  std::ranges::sort(known, std::greater());
  const auto kept = std::ranges::count_if(known, [](double each) { return each > 0; });
  return kept == 0 ? kUnknown : known[static_cast<std::size_t>(std::max<std::ptrdiff_t>(kept - 2, 0))];
}

void LookTimes::pass(double seconds) {
  since_boxes_ += seconds;
  since_look_ += seconds;
}

bool LookTimes::is_look(double seconds, bool boxes) {
  pass(seconds);
  if (boxes) {
    if (begun_ && since_boxes_ < kLongest) intervals_[next_++ % kKept] = since_boxes_;
    begun_ = true;
    since_boxes_ = since_look_ = 0;
    return true;
  }
  if (!begun_ || since_look_ < kOverdue * usual()) return false;
  since_look_ -= usual();
  return true;
}

}  // namespace cerberus::vision
