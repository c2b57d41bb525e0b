// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/followed_axis.h"

#include <algorithm>
#include <cmath>

namespace cerberus::control {

namespace {

using sensing::radians;

constexpr double square(double x) {
  return x * x;
}

// All guarded by bench-heads; swept there on heads A, B, D, F.
struct Constants {
  // As the boxes of lib/sim have it.
  double box_noise = radians(1);
  // Density of the quick filter's acceleration at rate v: standing + passing v^4. A person who passes on a straight line
  // accelerates by up to .65 v^2 as seen from the head, so that a fast target needs a quick filter, and a slow one, at
  // which a head is seen to tremble, a calm one. swept: half and
  // twice of each change `run` by .1 degree and `mix` by 5 reversals.
  double standing = 10 * square(radians(1));  // radians^2 / s^3
  double passing = 2.4;                       // seconds, over radians^2
  double slow = 2 * square(radians(1));  // density of the slow filter. chosen; `rest` and `wander` guard it
  double first_rate = radians(30);       // a second. derived: a walker 3 m away
  // A target stands where the slow filter's rate stays below `still` and both filters agree, for `held`. swept: without
  // `held` a runner who turns round counts as standing (`run` + .05 degrees).
  double still = radians(2.5);  // a second
  double agree = radians(2);
  double held = .5;  // seconds
  // A quick estimate this many times beyond dead_band_start starts an axis, too. swept: 1 doubles the reversals of
  // `wander`, 2 costs .1 degree in `run`.
  double quick_start = 1.3;
  // 1/s: the commanded speed's. swept: at 16 B has 22 reversals a minute and at 10 16, `run` costs .06 degrees
  double smoothing = 10;
  double jerk_time = .04;  // seconds in which the full acceleration is reached. swept: .15 swings
  // Beyond this time from picture to effect gain and filter become slower in proportion. swept on D and L: .4 lags, 1
  // has twice the reversals.
  double quick_horizon = .6;  // seconds
  // The same for the time between pictures, in which an error is corrected blindly. derived: four tenths of an error
  // between two pictures.
  double quick_interval = .06;  // seconds
  // A position command leads this far beyond the target, so that the head does not brake before it. derived: seven
  // frames, less than the watchdog's time.
  double lead = .3;  // seconds
  // From one picture to the next the head turns by no more than this share of what is seen, so that the picture's motion
  // is found. derived: half of what registration searches
  double most_turn = .2;
};
constexpr Constants kConstants;

// Bandwidth by the dial, against normal. chosen; unit-followed_axis sees that each lags and
// trembles less or more.
double pace(Response response) {
  constexpr double kCalm = .7, kFast = 1.4;
  return response == Response::calm ? kCalm : response == Response::fast ? kFast : 1;
}

// Of angles, against a lens of 60 degrees: as much smaller as a longer one shows the target larger.
double view_scale(double field_of_view) {
  // derived: what cameras without a zoom see, and zooms at their widest, is no less; for them the numbers were swept
  constexpr double kUsual = radians(60), kLeast = radians(55);
  return field_of_view > 0 && field_of_view < kLeast ? std::tan(field_of_view / 2) / std::tan(kUsual / 2) : 1;
}

// Of the bandwidth: what a long way from picture to effect, and pictures that are far between, leave of it.
double slowed(double horizon, double interval) {
  return std::min({1.0, kConstants.quick_horizon / std::max(horizon, kConstants.quick_horizon),
                   kConstants.quick_interval / std::max(interval, kConstants.quick_interval)});
}

}  // namespace

FollowedAxis::Aim FollowedAxis::observe(double angle, const BaseTurn& base, const Times& times,
                                        const Parameters& parameters) {
  const Constants& c = kConstants;
  const double view = view_scale(parameters.field_of_view);
  if (!quick_.known())
    interval_ = 0;
  else if (times.taken > taken_)
    interval_ = std::min(times.taken - taken_, TargetFilter::kPause);
  taken_ = times.taken;
  const double world = angle + base.taken, v = quick_.known() ? quick_.rate() : 0;
  // Its bandwidth goes with the fourth root of its density. Rare pictures slow a filter by themselves.
  const double faster = square(square(pace(parameters.response) * slowed(times.horizon(), 0)));
  quick_.add(
      times.taken, world,
      {c.box_noise * view, faster * (c.standing * square(view) + c.passing * square(v * v)), c.first_rate});
  slow_.add(times.taken, world, {c.box_noise * view, c.slow * square(view), c.first_rate});
  Aim aim;
  aim.position = quick_.at(times.predicted()) - base.effect;
  aim.rate = quick_.rate() - base.rate;
  aim.calm = slow_.at(times.taken) - base.effect;
  if (std::abs(slow_.rate() - base.rate) >= c.still * view ||
      std::abs(aim.position - aim.calm) >= c.agree * view)
    moved_ = times.taken;
  aim.stands = times.taken - moved_ > c.held;
  return aim;
}

double FollowedAxis::shaped(double speed, const motion::AxisState& ahead, double most, const Times& times,
                            double smoothing) {
  double dt = std::max(0.0, times.effect - commanded_);  // the dead time that is learnt may become shorter
  if (commanded_ < 0 || dt > TargetFilter::kPause) {     // of an axis that did something else
    speed_ = ahead.speed;
    acceleration_ = 0;
    dt = kConstants.jerk_time;
  }
  const double wanted = std::clamp(smoothing * (speed - speed_), -most, most);
  const double jerk = most / kConstants.jerk_time * dt;
  acceleration_ += std::clamp(wanted - acceleration_, -jerk, jerk);
  speed_ += acceleration_ * std::min(dt, 1 / smoothing);
  commanded_ = times.effect;
  return speed_;
}

motion::AxisCommand FollowedAxis::command(const Aim& aim, const motion::AxisState& ahead,
                                          const motion::AxisLimits& limits, const Times& times,
                                          const Parameters& parameters) {
  const double target = aim.stands ? aim.calm : aim.position, rate = aim.stands ? 0 : aim.rate;
  const double error = target - ahead.position, size = std::abs(error);
  const double view = view_scale(parameters.field_of_view), start = view * parameters.dead_band_start;
  moves_ = moves_ ? std::abs(rate) > view * kConstants.still || size > view * parameters.dead_band_stop
                  : std::abs(aim.calm - ahead.position) > start ||
                        std::abs(aim.position - ahead.position) > kConstants.quick_start * start;
  if (!moves_) {
    speed_ = acceleration_ = 0;
    commanded_ = times.effect;
    return {};
  }
  const double quick = pace(parameters.response) * slowed(times.horizon(), interval_);
  const double close = std::min(quick * parameters.gain * size, std::sqrt(2 * limits.acceleration * size));
  double most = limits.speed;
  // Also after a gap in which the target was not seen: where it went meanwhile is not known.
  if (view < 1 && interval_ > 0)
    most = std::min(most, kConstants.most_turn * parameters.field_of_view / interval_);
  const double wanted = std::clamp(rate + std::copysign(close, error), -most, most);
  const double speed = shaped(wanted, ahead, limits.acceleration, times, quick * kConstants.smoothing);
  double goal = target + rate * kConstants.lead;
  // The speed leads away from there: a target that comes nearer faster than the head should go.
  if ((goal - ahead.position) * speed <= 0) goal = ahead.position + speed * kConstants.lead;
  if (speed == 0) return {};
  return {motion::AxisCommand::Kind::position, limits.clamp(goal), std::abs(speed)};
}

}  // namespace cerberus::control
