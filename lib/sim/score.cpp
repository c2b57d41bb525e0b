// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/score.h"

#include <cmath>

namespace cerberus::sim {

void Score::count_reversals(double camera) {
  if (count_ == 1) extreme_ = camera;
  const double back = camera - extreme_;
  if (back * direction_ > 0) extreme_ = camera;
  if (std::abs(back) <= parameters_.reversal || back * direction_ > 0) return;
  if (direction_ != 0) ++reversals_;
  direction_ = back > 0 ? 1 : -1;
  extreme_ = camera;
}

void Score::add(double seconds, double off, double camera, double published) {
  const double size = std::abs(off);
  if (!seen_ && size < parameters_.half_view) seen_ = seconds;
  if (size >= parameters_.centred) near_since_.reset();
  if (size < parameters_.centred && !near_since_) near_since_ = seconds;
  if (!centred_ && near_since_ && seconds - *near_since_ > parameters_.centred_for) centred_ = near_since_;
  if (seconds < parameters_.skip) return;
  if (count_++ == 0) first_ = seconds;
  last_ = seconds;
  squares_ += off * off;
  out_ += size >= parameters_.half_view;
  pose_squares_ += (published - camera) * (published - camera);
  count_reversals(camera);
}

double Score::rms() const {
  return std::sqrt(squares_ / static_cast<double>(count_));
}

double Score::lost() const {
  return static_cast<double>(out_) / static_cast<double>(count_);
}

double Score::reversals() const {
  return static_cast<double>(reversals_) * 60 / (last_ - first_);
}

double Score::pose_error() const {
  return std::sqrt(pose_squares_ / static_cast<double>(count_));
}

}  // namespace cerberus::sim
