// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/report_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cerberus::motion {

// Whether the reports change as the commands do, over the last span.
bool ReportWatch::follows(const Point& now) {
  const Parameters& p = parameters_;
  if (seconds(now.time - mark_.time) < p.span) return follows_;
  const double commanded = now.commanded - mark_.commanded, reported = now.reported - mark_.reported;
  mark_ = now;
  const double share = reported / commanded;
  return std::abs(commanded) >= p.least_way && share >= p.least_share && share <= p.most_share;
}

// Whether the reports have come nearer to the command lately than they ever were since they are outside.
bool ReportWatch::progresses(const Point& now) {
  const double side = now.commanded > now.reported ? 1 : -1;
  if (side != side_ || (now.reported - nearest_) * side >= parameters_.least_way) {
    if (side == side_) progressed_ = now.time;
    side_ = side;
    nearest_ = now.reported;
  }
  return progressed_ > Time::zero() && seconds(now.time - progressed_) < parameters_.progress;
}

ReportWatch::Verdict ReportWatch::add(Time time, double reported, double commanded, double speed,
                                      double latency) {
  const Parameters& p = parameters_;
  const bool number = std::isfinite(reported);
  const Point now{time, number ? reported : begun_ ? last_.reported : commanded, commanded};
  if (!begun_) last_ = mark_ = now;
  begun_ = true;
  const double step = std::clamp(seconds(time - last_.time), 0.0, p.longest_step);
  const double reach = latency + p.grace;
  if (std::abs(speed) >= fastest_ || seconds(time - fast_) > reach) {
    fastest_ = std::abs(speed);
    fast_ = time;
  }
  const double tolerance = p.slack + fastest_ * reach;
  const double jump = std::abs(now.reported - last_.reported);
  const bool goes_on = number && jump <= p.slack + p.most_share * fastest_ * step;
  commanded_way_ += std::abs(commanded - last_.commanded);
  reported_way_ += jump;
  if (time > last_.time) last_ = now;
  follows_ = follows(now);
  if (number && std::abs(reported - commanded) <= tolerance) {
    outside_ = std::max(0.0, outside_ - step / 4);
    side_ = 0;
    progressed_ = {};
    return Verdict::plausible;
  }
  const bool nearer = progresses(now);
  const bool right = goes_on && (nearer || follows_);
  if (!right) outside_ += step;
  if (outside_ >= p.patience) return Verdict::parted;
  return right ? Verdict::plausible : Verdict::doubtful;
}

bool ReportWatch::take_rest(double reported, double commanded) {
  const Parameters& p = parameters_;
  const bool near = std::abs(reported - commanded) <= p.slack + commanded_way_ / 2;
  const bool moved = reported_way_ >= p.least_share * commanded_way_;
  if (commanded_way_ < p.least_way || !near || !moved) return false;
  commanded_way_ = reported_way_ = outside_ = 0;
  return true;
}

void ReportWatch::shift(double by) {
  last_.commanded += by;
  mark_.commanded += by;
}

double unwrapped(double reported, double commanded, const AxisLimits& limits) {
  constexpr double kTurn = 2 * std::numbers::pi, kSlack = sensing::radians(10);
  const auto inside = [&](double angle) {
    return angle >= limits.from - kSlack && angle <= limits.to + kSlack;
  };
  if (!std::isfinite(reported) || inside(reported)) return reported;
  const double nearest = reported + kTurn * std::round((commanded - reported) / kTurn);
  return inside(nearest) ? nearest : reported;
}

}  // namespace cerberus::motion
