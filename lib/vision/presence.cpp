// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/presence.h"

#include <algorithm>
#include <utility>

namespace cerberus::vision {

Presence::Change Presence::update(bool present, std::optional<Time> time, Time step, Time hold) {
  // The times tell the length of a gap as well; without them there is only the frame rate. Time that runs backwards
  // (a seek) is no silence.
  const Time passed = time && last_ ? std::max(*time - *last_, Time::zero()) : step;
  last_ = time;
  if (present) {
    quiet_ = Time::zero();
    return std::exchange(active_, true) ? Change::none : Change::started;
  }
  if (!active_) return Change::none;
  quiet_ += passed;
  return quiet_ >= hold ? end() : Change::none;
}

Presence::Change Presence::end() {
  return std::exchange(active_, false) ? Change::ended : Change::none;
}

}  // namespace cerberus::vision
