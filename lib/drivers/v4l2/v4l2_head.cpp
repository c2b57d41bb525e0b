// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/v4l2/v4l2_head.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using sensing::degrees;
using sensing::radians;
using Kind = AxisCommand::Kind;

constexpr double kTie = 1e-6;                  // of a step: rounding of the division
constexpr double kSecond = radians(1) / 3600;  // of arc

// The nearest value that the control takes. Step 0 counts as 1.
std::int32_t on_grid(double value, const ControlRange& range) {
  const double step = std::max(1, range.step);
  const double count = std::round((value - range.least) / step);
  return static_cast<std::int32_t>(
      std::clamp(range.least + count * step, double(range.least), double(range.most)));
}

// The step nearest to `speed` that is no faster than `limit` (radians a second, as `fastest`); the slowest one where
// all are.
std::int32_t speed_step(double speed, double limit, double fastest, const ControlRange& range) {
  const double step = std::max(1, range.step);
  const double steps = range.most / step;  // of one way
  const double most = std::clamp(std::floor(limit / fastest * steps + kTie), 1.0, std::max(1.0, steps));
  return static_cast<std::int32_t>(std::round(std::clamp(speed / fastest * steps, -most, most)) * step);
}

bool turns_both_ways(const std::optional<ControlRange>& range) {
  return range && range->most > 0 && range->least == -range->most;
}

}  // namespace

std::optional<V4l2Options::Mode> v4l2_mode(const std::string& word) {
  using Mode = V4l2Options::Mode;
  if (word == "auto") return Mode::automatic;
  if (word == "speed") return Mode::speed;
  if (word == "absolute") return Mode::absolute;
  if (word == "relative") return Mode::relative;
  return std::nullopt;
}

V4l2Head::~V4l2Head() {
  stop({});
}

std::string V4l2Head::choose_mode() {
  const bool absolute = pan_.angles || tilt_.angles, relative = pan_.ways || tilt_.ways;
  const bool any_speed = pan_.speeds || tilt_.speeds;
  const bool speed = (!pan_.speeds || turns_both_ways(pan_.speeds)) &&
                     (!tilt_.speeds || turns_both_ways(tilt_.speeds)) && any_speed;
  const bool speeds_known = options_.pan_speed > 0 && options_.tilt_speed > 0;
  mode_ = options_.mode;
  if (mode_ == Mode::automatic)
    mode_ = speed && speeds_known ? Mode::speed
            : absolute            ? Mode::absolute
            : relative            ? Mode::relative
                                  : Mode::speed;
  if (!any_speed && !absolute && !relative)
    return "the camera " + options_.device + " has no controls for pan and tilt (v4l2-ctl -L lists them)";
  const auto lacks = [&](const char* what) {
    return "the camera " + options_.device + " has no controls for mode=" + what +
           " (v4l2-ctl -L lists them)";
  };
  if (mode_ == Mode::absolute && !absolute) return lacks("absolute");
  if (mode_ == Mode::relative && !relative) return lacks("relative");
  if (mode_ != Mode::speed) return {};
  if (!any_speed) return lacks("speed");
  if (!speed)
    return "the kernel reports a wrong minimum of the pan or tilt speed of " + options_.device +
           " (it is not minus the maximum): take mode=absolute or relative, or a newer kernel";
  return speeds_known ? "" : no_unit();
}

std::string V4l2Head::no_unit() const {
  return "the speeds of " + options_.device +
         " have no unit: name the degrees a second of the fastest ones (pan-speed=60 tilt-speed=40)";
}

std::string V4l2Head::check() const {
  const bool known = options_.pan_speed > 0 && options_.tilt_speed > 0;
  return options_.mode == Mode::speed && !known ? no_unit() : "";
}

std::string V4l2Head::check_range(const Axis& axis) const {
  if (mode_ != Mode::absolute || !axis.angles) return {};
  return motion::beyond_reach(axis.name, axis.limits, axis.angles->least * kSecond,
                              axis.angles->most * kSecond, "the camera " + options_.device);
}

std::string V4l2Head::connect(Time now) {
  if (const int error = controls_->open(options_.device)) {
    if (error == EACCES || error == EPERM)
      return "no permission to use " + options_.device + ": add the user to the group video";
    if (error == ENOENT)
      return "there is no camera " + options_.device + " (v4l2-ctl --list-devices lists them)";
    if (error == ENOTTY) return options_.device + " is no camera (v4l2-ctl --list-devices lists them)";
    return options_.device + " cannot be used as a camera: " + std::strerror(error);
  }
  for (Axis* axis : {&pan_, &tilt_}) {
    axis->speeds = controls_->query(axis->speed);
    axis->angles = controls_->query(axis->absolute);
    axis->ways = controls_->query(axis->relative);
    axis->sent.reset();
    axis->command = {};
    axis->moves = false;
  }
  if (stop_owed_)  // whatever else is wrong with the camera
    for (const Axis* axis : {&pan_, &tilt_})
      if (axis->speeds) controls_->set(axis->speed, 0);
  zooms_ = controls_->query(camera_control::kZoomAbsolute);
  if (zooms_ && zooms_->most <= zooms_->least) zooms_.reset();
  if (options_.zoom > 1)
    return "the zoom of " + options_.device + " is kept at 0 to 1 of its range (lock-zoom), not at " +
           text::significant(options_.zoom, 4).string();
  if (options_.zoom >= 0 && !zooms_)
    return "the camera " + options_.device + " has no zoom to lock (lock-zoom)";
  if (std::string wrong = choose_mode(); !wrong.empty()) return wrong;
  for (Axis* axis : {&pan_, &tilt_}) {
    const bool reads = mode_ != Mode::relative && read_position(*axis);
    if (axis->reads && !reads)
      return "the camera " + options_.device + " does not report its " + axis->name + " any more";
    axis->reads = reads;
    axis->plan = motion::Plan(axis->position, now);
  }
  // A position that lacks an axis is none: the pipeline would take the missing one as measured.
  reads_ = (pan_.reads || !drives(pan_)) && (tilt_.reads || !drives(tilt_)) && (pan_.reads || tilt_.reads);
  next_zoom_ = now;
  connected_ = true;
  return {};
}

bool V4l2Head::drives(const Axis& axis) const {
  return mode_ == Mode::speed ? axis.speeds.has_value() : axis.angles.has_value();
}

// Stops the camera, if it still takes that, and closes its device.
void V4l2Head::disconnect(Time now) noexcept {
  stop_owed_ = false;
  stop(now);
  controls_->close();
  connected_ = false;
  next_open_ = now + (stop_owed_ ? Time(kStopAgain) : Time(kReopen));
}

// Returns whether the camera is there again. It then stands until the next move.
bool V4l2Head::reconnect(Time now) {
  if (connected_) disconnect(now);
  if (now < next_open_) return false;
  next_open_ = now + (stop_owed_ ? Time(kStopAgain) : Time(kReopen));
  if (!connect(now).empty()) return false;
  lost_ = stop_owed_ = false;
  fault_.clear();
  stop(now);
  return true;
}

std::string V4l2Head::open(const HeadSetup& setup, Time now) {
  pan_.limits = setup.limits.pan;
  tilt_.limits = setup.limits.tilt;
  pan_.position = setup.pan;
  tilt_.position = setup.tilt;
  pan_.fastest = radians(options_.pan_speed);
  tilt_.fastest = radians(options_.tilt_speed);
  reckoned_.begin(now, {setup.pan, setup.tilt});
  if (std::string wrong = connect(now); !wrong.empty()) return wrong;
  for (const Axis* axis : {&pan_, &tilt_})
    if (std::string wrong = check_range(*axis); !wrong.empty()) return wrong;
  stop(now);
  next_ = now;
  return {};
}

HeadAbilities V4l2Head::abilities() const {
  const bool speed = mode_ == Mode::speed;
  return {.position = !speed,
          .velocity = true,
          .feedback = reads_,
          .rate = 20,
          .zoom = zooms_.has_value() && options_.zoom < 0};
}

bool V4l2Head::read_position(Axis& axis) noexcept {
  std::int32_t value = 0;
  if (!axis.angles || controls_->get(axis.absolute, value) != 0) return false;
  axis.position = value * kSecond;
  return true;
}

void V4l2Head::lose(int error) {
  if (!fault_.empty()) return;
  fault_ = "the camera " + options_.device + " does not obey any more (" + std::strerror(error) + ")";
  lost_ = true;
  stop_owed_ = mode_ == Mode::speed;
}

double V4l2Head::speed_of(const Axis& axis) const {
  return axis.speeds && axis.sent ? *axis.sent * axis.fastest / axis.speeds->most : 0;
}

// A camera goes no further than the limits, by its own positions or, without these, by the speeds in force.
void V4l2Head::set_speeds(const motion::PanTilt& speed, Time now) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const motion::PanTilt measured{pan_.reads ? pan_.position : kUnknown,
                                 tilt_.reads ? tilt_.position : kUnknown};
  const motion::PanTilt allowed = reckoned_.confined(speed, measured, {pan_.limits, tilt_.limits}, 0, now);
  set_speed(pan_, allowed.pan);
  set_speed(tilt_, allowed.tilt);
}

void V4l2Head::set_speed(Axis& axis, double speed) {
  if (!axis.speeds) return;
  const std::int32_t value = speed_step(speed, axis.limits.speed, axis.fastest, *axis.speeds);
  if (axis.sent == value) return;
  const int error = controls_->set(axis.speed, value);
  check(error);
  if (error == 0) axis.sent = value;
}

// The speeds in force have changed, perhaps.
void V4l2Head::note_speeds(Time now) noexcept {
  if (mode_ == Mode::speed) reckoned_.set_speeds({speed_of(pan_), speed_of(tilt_)}, now);
}

std::optional<SpeedsLine> V4l2Head::take_speeds(Time now) {
  const auto speeds = reckoned_.take_speeds(now);
  return reads_ ? std::nullopt : speeds;
}

void V4l2Head::plan(Axis& axis, const AxisCommand& command, Time now) {
  axis.command = command;
  axis.plan = motion::Plan::make(now, axis.plan.at(now), command, axis.limits);
  axis.moves = axis.moves || axis.plan.end() > now || command.kind == Kind::position;
}

void V4l2Head::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  if (lost_) return;
  stop_owed_ = false;
  if (mode_ == Mode::speed) {
    const auto speed = [](const AxisCommand& command) {
      return command.kind == Kind::velocity && std::isfinite(command.value) ? command.value : 0;
    };
    set_speeds({speed(pan), speed(tilt)}, now);
  } else {
    plan(pan_, pan, now);
    plan(tilt_, tilt, now);
  }
  note_speeds(now);
  next_ = std::min(next_, now);
}

void V4l2Head::limit(const motion::Limits& limits, Time now) {
  pan_.limits = limits.pan;
  tilt_.limits = limits.tilt;
  if (mode_ == Mode::speed) return;
  for (Axis* axis : {&pan_, &tilt_}) plan(*axis, axis->command, now);
}

void V4l2Head::stop(Time now) noexcept {
  for (Axis* axis : {&pan_, &tilt_}) {
    axis->command = {};
    if (mode_ != Mode::speed) {
      // Where it is, or where it was sent last.
      const bool known = axis->reads && read_position(*axis);
      axis->moves = axis->moves && known;
      axis->plan = motion::Plan(axis->position, now);
    } else if (axis->speeds) {
      // Whatever is believed to be in force; set again by tick() until the camera takes it.
      const int error = controls_->set(axis->speed, 0);
      stop_owed_ = stop_owed_ || error != 0;
      if (error == 0) axis->sent = 0;
    }
  }
  note_speeds(now);
}

void V4l2Head::send_angle(Axis& axis, double angle) {
  int error = 0;
  if (mode_ == Mode::absolute && axis.angles) {
    std::int32_t value = on_grid(angle / kSecond, *axis.angles);
    // A step may be a whole degree: an angle within the limits is rounded towards their inside.
    constexpr double kHair = 1e-9;  // radians: rounding of the multiplication
    const int step = std::max(1, axis.angles->step);
    const bool below = angle <= axis.limits.to + kHair, above = angle >= axis.limits.from - kHair;
    if (below && value * kSecond > axis.limits.to + kHair && value - step >= axis.angles->least)
      value -= step;
    if (above && value * kSecond < axis.limits.from - kHair && value + step <= axis.angles->most)
      value += step;
    if (axis.sent != value) error = controls_->set(axis.absolute, value);
    axis.sent = value;
    if (!axis.reads) axis.position = value * kSecond;
  } else if (mode_ == Mode::relative && axis.ways) {
    const int step = std::max(1, axis.ways->step);
    const double steps = (angle - axis.position) / kSecond / step;
    const double way = std::trunc(steps + std::copysign(kTie, steps)) * step;
    const auto value =
        static_cast<std::int32_t>(std::clamp(way, double(axis.ways->least), double(axis.ways->most)));
    if (value != 0) error = controls_->set(axis.relative, value);
    if (error == 0) axis.position += value * kSecond;
  }
  check(error);
}

std::int32_t V4l2Head::zoom_value(double position) const {
  return on_grid(
      zooms_->least + std::min(position, 1.0) * (static_cast<double>(zooms_->most) - zooms_->least), *zooms_);
}

void V4l2Head::zoom(double position, Time) {
  if (zooms_ && !lost_) controls_->set(camera_control::kZoomAbsolute, zoom_value(position));
}

// Reads the zoom, and sets it where it is to be kept. What is reported is what was read: a camera may refuse a zoom, or
// take seconds to reach it, and turns all the same.
void V4l2Head::check_zoom(Time now) {
  if (!zooms_ || lost_ || now < next_zoom_) return;
  next_zoom_ = now + kZoomPeriod;
  const double range = static_cast<double>(zooms_->most) - zooms_->least;
  std::int32_t value = 0;
  if (controls_->get(camera_control::kZoomAbsolute, value) != 0) return;
  if (options_.zoom >= 0) {
    const std::int32_t wanted = zoom_value(options_.zoom);
    const bool set = value != wanted && controls_->set(camera_control::kZoomAbsolute, wanted) == 0;
    if (set && controls_->get(camera_control::kZoomAbsolute, value) != 0) return;
  }
  zoom_ = std::clamp((value - static_cast<double>(zooms_->least)) / range, 0.0, 1.0);
}

// The positions of a camera that reports them are read more often than this.
void V4l2Head::probe(Time now) {
  if (lost_ || now < next_probe_) return;
  next_probe_ = now + kProbe;
  if (!pan_.reads && !tilt_.reads) check(controls_->probe());
}

Time V4l2Head::tick(Time now) {
  if (lost_ && !reconnect(now)) return next_open_;
  if (now < next_) return next_;
  next_ = now + kPeriod;
  if (stop_owed_) {
    stop_owed_ = false;
    stop(now);
  }
  for (Axis* axis : {&pan_, &tilt_}) {
    if (mode_ == Mode::speed || !axis->moves) continue;
    axis->moves = now < axis->plan.end();
    send_angle(*axis, axis->plan.at(now + Time(kPeriod)).position);
  }
  for (Axis* axis : {&pan_, &tilt_})
    if (!lost_ && axis->reads && !read_position(*axis)) lose(ENODEV);
  const motion::PanTilt speed{speed_of(pan_), speed_of(tilt_)};
  if (mode_ == Mode::speed && !lost_ && (speed.pan != 0 || speed.tilt != 0)) set_speeds(speed, now);
  note_speeds(now);
  probe(now);
  check_zoom(now);
  new_pose_ = reads_ && !lost_;
  if (!lost_) return next_;
  disconnect(now);
  return next_open_;
}

std::optional<PoseLine> V4l2Head::take_pose(Time) {
  if (!std::exchange(new_pose_, false)) return std::nullopt;
  return PoseLine{{pan_.position, 0, 0}, {tilt_.position, 0, 0}, 0};
}

}  // namespace cerberus::drivers
