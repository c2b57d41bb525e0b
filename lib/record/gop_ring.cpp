// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/gop_ring.h"

#include <utility>

namespace cerberus::record {

bool GopRing::push(Unit unit, bool continues) {
  if (units_.empty() && !unit.keyframe && !continues) return false;
  if (unit.keyframe) keyframes_.push(units_.end());
  bytes_ += unit.bytes;
  units_.push(std::move(unit));
  return true;
}

void GopRing::clear() {
  units_.clear();
  keyframes_.clear();
  bytes_ = 0;
}

std::optional<Number> GopRing::keyframe_at(Time time) const {
  if (keyframes_.empty()) return std::nullopt;
  Number k = keyframes_.end() - 1;
  while (k != keyframes_.begin() && units_[keyframes_[k]].presentation > time) --k;
  return keyframes_[k];
}

std::optional<Number> GopRing::keyframe_from(Number number) const {
  for (Number k = keyframes_.begin(); k != keyframes_.end(); ++k)
    if (keyframes_[k] >= number) return keyframes_[k];
  return std::nullopt;
}

void GopRing::keep_from(Time time, Number limit) {
  while (!keyframes_.empty()) {
    const bool whole = keyframes_.front() == units_.begin();
    if (whole && gops() == 1) return;
    const Number next = keyframes_[keyframes_.begin() + (whole ? 1 : 0)];
    if (next > limit || units_[next].presentation > time) return;
    drop_gop();
  }
}

void GopRing::drop_gop() {
  if (!keyframes_.empty() && keyframes_.front() == units_.begin()) keyframes_.pop();
  const Number until = keyframes_.empty() ? units_.end() : keyframes_.front();
  while (units_.begin() != until) {
    bytes_ -= units_.front().bytes;
    units_.pop();
  }
}

}  // namespace cerberus::record
