// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/zoom_keeper.h"

#include <algorithm>
#include <cmath>

namespace cerberus::control {

namespace {

constexpr ZoomKeeper::Parameters kParameters;

double log_tangent(double field_of_view) {
  return std::log(std::tan(field_of_view / 2));
}

bool is_usable(const ZoomKeeper::Sight& sight) {
  return sight.height > 0 && std::isfinite(sight.height) && sight.field_of_view > 0 &&
         std::isfinite(sight.field_of_view) && std::isfinite(sight.off);
}

}  // namespace

std::optional<double> ZoomKeeper::update(double taken, const std::optional<Sight>& sight,
                                         const Range& range) {
  const Parameters& p = kParameters;
  if (!sight || !is_usable(*sight) || !(range.narrowest > 0) || !(range.narrowest < range.widest))
    return std::nullopt;
  const double dt = taken - seen_;
  if (size_ && dt <= 0) return std::nullopt;
  const double here = log_tangent(sight->field_of_view);
  double size = std::log(sight->height) + here;
  if (!size_ || dt > p.pause) {
    reset();
    since_ = stepped_ = taken;
  }
  seen_ = taken;
  if (!sight->whole) size = std::max(size, size_.value_or(size));
  size_ = size_ ? *size_ + (1 - std::exp(-dt / p.slowness)) * (size - *size_) : size;
  if (taken - stepped_ < p.period) return std::nullopt;
  // Of the time without a step no step is made up for.
  const double time = std::min(taken - stepped_, 2 * p.period);
  stepped_ = taken;

  const double from =
      std::clamp(commanded_.value_or(here), here - p.narrows * p.lead, here + p.widens * p.lead);
  const double wanted =
      std::clamp(*size_ - std::log(p.share), log_tangent(range.narrowest), log_tangent(range.widest));
  const double error = wanted - from;
  moves_ = std::abs(error) > (moves_ ? p.stop : p.start);
  const bool narrows = error < 0;
  const bool may_narrow = sight->whole && sight->off < p.centred && taken - since_ >= p.settled;
  if (!moves_ || (narrows && !may_narrow)) return std::nullopt;
  commanded_ = from + std::clamp(error, -p.narrows * time, p.widens * time);
  return 2 * std::atan(std::exp(*commanded_));
}

}  // namespace cerberus::control
