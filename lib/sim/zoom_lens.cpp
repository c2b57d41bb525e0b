// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/zoom_lens.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {

namespace {

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(std::llround(seconds * 1e9)));
}

double log_tangent(double field_of_view) {
  return std::log(std::tan(field_of_view / 2));
}

}  // namespace

void ZoomLens::elapse(Time until) {
  constexpr Time kStep = std::chrono::milliseconds(1);
  for (; now_ < until; now_ += kStep) {
    while (!coming_.empty() && coming_.front().given + time_of(traits_.dead_time) <= now_) {
      wanted_ = std::clamp(coming_.front().field_of_view, traits_.narrowest, traits_.widest);
      coming_.pop_front();
    }
    if (wanted_ > 0) {
      const double most = traits_.speed * motion::seconds(kStep), here = log_tangent(seen_);
      seen_ = 2 * std::atan(std::exp(here + std::clamp(log_tangent(wanted_) - here, -most, most)));
    }
    if (now_ < next_report_) continue;
    next_report_ += time_of(1 / traits_.reports);
    told_ = seen_;
  }
}

}  // namespace cerberus::sim
