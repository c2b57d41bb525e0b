// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/trials/calibration.h"

#include <algorithm>
#include <cmath>

#include "text/numbers.h"

namespace cerberus::control {
namespace {

// A head that goes beyond its reach by this share is not under control.
constexpr double kBeyond = 1.25;
constexpr int kMostMissed =
    25;  // frames in a row without a measured turn, while the head turns: about a second

}  // namespace

AxisCalibration::AxisCalibration(double reach, double fastest, const CalibrationParameters& parameters)
    : parameters_(parameters), reach_(reach) {
  for (const double degrees : parameters.speeds) {
    const double speed = sensing::radians(degrees);
    const double length = std::min(parameters.longest, reach / 2 / speed);
    if (speed > fastest || length < parameters.least) continue;
    runs_.push_back({.speed = speed, .length = length, .reversal = true});
    runs_.push_back({.speed = speed, .length = length});
    runs_.push_back({.speed = -speed, .length = length, .reversal = true});
    runs_.push_back({.speed = -speed, .length = length});
  }
  if (runs_.empty()) problem_ = "the limits leave no room to measure a speed";
}

std::optional<double> AxisCalibration::command(Time now) {
  if (!problem_.empty() || at_ == runs_.size()) return std::nullopt;
  if (!begun_) {
    begun_ = now;
    angle_ = n_ = st_ = sa_ = stt_ = sta_ = 0;
  }
  const Run& run = runs_[at_];
  const double passed = motion::seconds(now - *begun_);
  if (passed < run.length) return run.speed;
  if (passed < run.length + parameters_.pause) return 0;
  finish(runs_[at_++]);
  begun_.reset();
  return command(now);
}

void AxisCalibration::add(Time taken, double turn) {
  if (!begun_ || at_ == runs_.size()) return;
  const double t = motion::seconds(taken - *begun_);
  if (t < 0) return;
  if (!std::isfinite(turn)) {
    n_ = st_ = sa_ = stt_ = sta_ = 0;  // the line is broken: only what follows is straight
    if (++missed_ > kMostMissed)
      problem_ = "the picture does not show how the camera turns: it needs light, and something to see";
    return;
  }
  missed_ = 0;
  position_ += turn;
  angle_ += turn;
  if (std::abs(position_) > kBeyond * reach_)
    problem_ = "the head went further than it was commanded to: check horizontal-fov and the device's speeds";
  if (t < parameters_.steady || t > runs_[at_].length) return;
  n_ += 1;
  st_ += t;
  sa_ += angle_;
  stt_ += t * t;
  sta_ += t * angle_;
}

// angle = slope t + offset, by least squares.
void AxisCalibration::finish(Run& run) {
  const double det = n_ * stt_ - st_ * st_;
  if (n_ < parameters_.least_frames || !(det > 0)) return;
  const double slope = (n_ * sta_ - st_ * sa_) / det;
  const double offset = (sa_ - slope * st_) / n_;
  if (!(slope * run.speed > 0)) return;  // it did not turn, or the other way
  run.actual = std::abs(slope);
  run.delay = -offset / slope;
  run.measured = true;
}

double AxisCalibration::seconds_left() const {
  double left = 0;
  for (std::size_t i = at_; i < runs_.size(); ++i) left += runs_[i].length + parameters_.pause;
  return left;
}

motion::SpeedMap AxisCalibration::speeds() const {
  std::vector<motion::SpeedPoint> points;
  for (std::size_t i = 0; i < runs_.size(); i += 4) {
    const Spread runs = speed_runs(runs_[i].speed);
    // A step of the device that serves two commanded speeds gives no rising table: the first one stays.
    const bool rises = runs.runs > 0 && (points.empty() || runs.mean() > points.back().actual);
    if (rises) points.push_back({runs_[i].speed, runs.mean()});
  }
  return motion::SpeedMap(std::move(points));
}

void Spread::add(double value) {
  least = runs == 0 ? value : std::min(least, value);
  most = runs == 0 ? value : std::max(most, value);
  sum += value;
  ++runs;
}

std::string Spread::text(double unit, int decimals) const {
  if (runs < 2) return std::to_string(runs) + (runs == 1 ? " run" : " runs");
  std::string text = std::to_string(runs) + " runs, ";
  text += text::rounded(least / unit, decimals).string_view();
  text += " to ";
  text += text::rounded(most / unit, decimals).string_view();
  return text;
}

Spread AxisCalibration::speed_runs(double commanded) const {
  Spread spread;
  for (const Run& run : runs_)
    if (run.measured && std::abs(run.speed) == commanded) spread.add(run.actual);
  return spread;
}

Spread AxisCalibration::dead_time_runs() const {
  Spread spread;
  for (const Run& run : runs_)
    if (run.measured && !run.reversal) spread.add(run.delay);
  return spread;
}

Spread AxisCalibration::backlash_runs() const {
  const double dead = dead_time();
  Spread spread;
  for (std::size_t i = 1; i < runs_.size(); ++i)
    if (runs_[i].measured && runs_[i].reversal) spread.add((runs_[i].delay - dead) * runs_[i].actual);
  return spread;
}

AxisCalibration::FarApart AxisCalibration::far_apart() const {
  FarApart worst;
  for (std::size_t i = 0; i < runs_.size(); i += 4) {  // speeds() leaves out those whose mean does not rise
    const Spread runs = speed_runs(runs_[i].speed);
    const double share = runs.runs > 0 ? (runs.most - runs.least) / runs.mean() : 0;
    if (share > parameters_.far_apart && share > worst.share) worst = {runs_[i].speed, share};
  }
  return worst;
}

double AxisCalibration::dead_time() const {
  double sum = 0, weights = 0;
  for (const Run& run : runs_) {
    if (!run.measured || run.reversal) continue;
    sum += run.actual * run.actual * run.delay;
    weights += run.actual * run.actual;
  }
  return weights > 0 ? std::max(0.0, sum / weights) : 0;
}

double AxisCalibration::backlash() const {
  const double dead = dead_time();
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < runs_.size(); ++i) {  // before the first run the play may lie on either side
    if (!runs_[i].measured || !runs_[i].reversal) continue;
    sum += (runs_[i].delay - dead) * runs_[i].actual;
    ++count;
  }
  return count > 0 ? std::max(0.0, sum / count) : 0;
}

}  // namespace cerberus::control
