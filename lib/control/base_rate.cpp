// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/base_rate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::control {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Above this acceleration a head's lag of 30 ms appears as a base rate of 3 degrees a second.
constexpr double kAbrupt = sensing::radians(100);  // a second squared

}  // namespace

Turn base_turn(const vision::Transform& motion, const vision::Lens& lens, vision::Size picture,
               const motion::PanTilt& before, const motion::PanTilt& after) {
  constexpr int kGrid = 6;
  Turn sum;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      // Boxes count from the corner of a pixel, transforms from its middle.
      const vision::Point p{(i + 0.5) * picture.width / kGrid, (j + 0.5) * picture.height / kGrid};
      const vision::Point q = motion.apply({p.x - 0.5, p.y - 0.5});
      const vision::Direction was = lens.direction(p, before.pan, before.tilt);
      const vision::Direction is = lens.direction({q.x + 0.5, q.y + 0.5}, after.pan, after.tilt);
      sum.yaw += sensing::wrap(was.bearing - is.bearing);
      sum.pitch += was.elevation - is.elevation;
    }
  return {sum.yaw / (kGrid * kGrid), sum.pitch / (kGrid * kGrid)};
}

std::optional<Turn> head_turn(const PictureMotion& motion, const vision::Lens& lens,
                              const motion::PanTilt& look) {
  constexpr double kConfident = 0.5;  // share of the picture that must agree, as in HeadMotionMonitor
  if (!(motion.confidence >= kConfident) || !lens.known() || !motion.transform.is_sane(motion.picture))
    return std::nullopt;
  const Turn turn = base_turn(motion.transform, lens, motion.picture, look, look);
  return Turn{turn.yaw - motion.base_yaw, turn.pitch};
}

void BaseRate::reset() {
  *this = {};
}

void BaseRate::add(motion::Time time, double seconds, double turn, double head_rate) {
  if (!(seconds > 0)) return;
  const double change = std::abs(head_rate - std::exchange(head_rate_, head_rate));
  if (change > kAbrupt * seconds) calm_from_ = time + kSettle;
  if (!std::isfinite(turn) || time < calm_from_) return;
  if (count_ > 0 && time <= nth_last(0).time) count_ = 0;
  entries_[next_] = {time, turn / seconds};
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

double BaseRate::at(motion::Time time) const {
  std::array<double, kKept> rates;
  unsigned n = 0;
  for (; n < count_; ++n) {
    const Entry& entry = nth_last(n);
    if (time - entry.time >= kStale || (n >= kLeast && time - entry.time >= kSpan)) break;
    rates[n] = entry.rate;
  }
  if (n < kLeast) return kNan;
  const auto used = std::span(rates).first(n);
  std::ranges::sort(used);
  const unsigned out = n / 4;
  const auto middle = used.subspan(out, n - 2 * out);
  return std::accumulate(middle.begin(), middle.end(), 0.0) / static_cast<double>(middle.size());
}

}  // namespace cerberus::control
