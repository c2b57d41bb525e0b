// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/pelco/pelco_head.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::PanTilt;
using sensing::degrees;
using sensing::radians;

// The nearest step of a straight line from 0 to `fastest` degrees a second that is no faster than `limit` (radians a
// second); the slowest one where all are.
int step_of(const AxisCommand& command, double fastest, double limit) {
  if (command.kind != AxisCommand::Kind::velocity || !std::isfinite(command.value)) return 0;
  const double steps = pelco::kMostStep / fastest;
  const double most = std::clamp(std::floor(degrees(limit) * steps + 1e-9), 1.0, double{pelco::kMostStep});
  return static_cast<int>(std::lround(std::clamp(degrees(command.value) * steps, -most, most)));
}

}  // namespace

std::string PelcoHead::check() const {
  if (options_.address < 1 || options_.address > 255) return "a Pelco-D address is 1 to 255";
  if (!(options_.pan_speed > 0) || !(options_.tilt_speed > 0))
    return "pan-speed and tilt-speed must be more than 0";
  if (options_.home_preset < 0 || options_.home_preset > 255) return "a Pelco-D preset is 1 to 255";
  if (!(options_.home_time > 0 && options_.home_time <= 40)) return "home-time must be up to 40 seconds";
  return check_device();
}

std::string PelcoHead::open(const HeadSetup& setup, Time now) {
  if (std::string wrong = check(); !wrong.empty()) return wrong;
  return connect(setup, now);
}

void PelcoHead::on_connected(Time now) {
  pan_at_.reset();
  tilt_at_.reset();
  measured_ = {kUnknown, kUnknown};  // it may have moved meanwhile
  connected_at_ = now;
  new_pose_ = false;
  zoom_unanswered_ = 0;
  home_at_.reset();
  stop(now);  // it stands until the next move
}

HeadAbilities PelcoHead::abilities() const {
  return {.position = false,
          .velocity = true,
          .feedback = options_.feedback,
          .rate = kRate,
          .home = !options_.feedback && options_.home_preset > 0,
          .zoom = options_.feedback};
}

PanTilt PelcoHead::speeds_of(int pan, int tilt) const {
  return {radians(options_.pan_speed * pan / pelco::kMostStep),
          radians(options_.tilt_speed * tilt / pelco::kMostStep)};
}

void PelcoHead::drive(int pan, int tilt, Time now) {
  const PanTilt allowed = confined(speeds_of(pan, tilt), measured_, now);
  if (allowed.pan == 0) pan = 0;
  if (allowed.tilt == 0) tilt = 0;
  if (pan == pan_ && tilt == tilt_) return;
  if (pan == 0 && tilt == 0) return stop(now);
  stops_owed_ = 0;
  pan_ = pan;
  tilt_ = tilt;
  sent_ = now;
  send(pelco::drive(options_.address, pan_, tilt_));
  set_speeds(speeds_of(pan_, tilt_), now);
}

void PelcoHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  if (home_at_) stop(now);
  drive(step_of(pan, options_.pan_speed, limits_.pan.speed),
        step_of(tilt, options_.tilt_speed, limits_.tilt.speed), now);
}

void PelcoHead::limit(const motion::Limits& limits, Time now) {
  limits_.pan.from = limits.pan.from;
  limits_.pan.to = limits.pan.to;
  limits_.tilt.from = limits.tilt.from;
  limits_.tilt.to = limits.tilt.to;
  if (!home_at_) drive(pan_, tilt_, now);
}

void PelcoHead::stop(Time now) noexcept {
  pan_ = tilt_ = 0;
  home_at_.reset();
  zoom_order_.reset();
  stops_owed_ = kStops - 1;
  sent_ = now;
  send(pelco::drive(options_.address, 0, 0));
  set_speeds({}, now);
}

void PelcoHead::home(Time now) {
  stop(now);
  stops_owed_ = 0;
  home_at_ = now + Time(static_cast<Time::rep>(options_.home_time * 1e9));
  sent_ = now;
  send(pelco::go_to_preset(options_.address, options_.home_preset));
}

std::optional<HomedLine> PelcoHead::take_homed(Time now) {
  if (!home_at_ || now < *home_at_) return std::nullopt;
  home_at_.reset();
  set_reference({}, now);
  return HomedLine{};
}

void PelcoHead::read(Time now) {
  std::vector<std::uint8_t> bytes;
  while (stream_.read(bytes)) {
    answers_.append(bytes);
    bytes.clear();
  }
  while (const auto position = answers_.take()) {
    if (position->address != options_.address) continue;
    if (position->axis == pelco::Axis::zoom) {
      zoom_ = position->zoom;
      zoom_unanswered_ = 0;
      continue;
    }
    const bool is_pan = position->axis == pelco::Axis::pan;
    (is_pan ? measured_.pan : measured_.tilt) = radians(position->degrees);
    (is_pan ? pan_at_ : tilt_at_) = now;
    (is_pan ? pan_reports_ : tilt_reports_) = true;
    new_pose_ = pan_at_ && tilt_at_ && now - std::min(*pan_at_, *tilt_at_) <= kPairAge;
  }
}

// Sends what is due of the zoom, in place of a question for a position. Returns whether something was.
bool PelcoHead::zoom_turn(Time now) {
  if (zoom_order_) {
    send(pelco::zoom(options_.address, *std::exchange(zoom_order_, std::nullopt)));
    return true;
  }
  if (!pan_reports_ && !tilt_reports_) return false;  // it answers nothing yet
  if (now - zoom_asked_ < (zoom_unanswered_ < kZoomInquiries ? kZoomPeriod : kZoomSeldom)) return false;
  zoom_asked_ = now;
  ++zoom_unanswered_;
  send(pelco::position_query(options_.address, pelco::Axis::zoom));
  return true;
}

Time PelcoHead::tick(Time now) {
  if (Time next; !is_there(now, next)) return next;
  read(now);
  if (!stream_.is_open()) return now;
  // A head that is limited by its own positions must report them, those of either axis, also when it has returned.
  const auto silent = [&](std::optional<Time> reported) {
    return now - reported.value_or(connected_at_) > kSilence;
  };
  if (options_.feedback && !pan_reports_ && !tilt_reports_ && silent({}))
    set_silent(true, now, ": check baud, address and wiring, or leave out feedback");
  else
    set_silent((pan_reports_ && silent(pan_at_)) || (tilt_reports_ && silent(tilt_at_)), now);
  if (!home_at_) drive(pan_, tilt_, now);  // stops at a limit
  const Time again = stops_owed_ > 0 ? Time(kStopAgain) : Time(kRepeat);
  if ((stops_owed_ > 0 || pan_ != 0 || tilt_ != 0) && now - sent_ >= again) {
    if (stops_owed_ > 0) --stops_owed_;
    sent_ = now;
    send(pelco::drive(options_.address, pan_, tilt_));
  } else if (options_.feedback && now - asked_ >= kRepeat / 2) {
    asked_ = now;
    if (zoom_turn(now)) return now + kStopAgain;
    send(pelco::position_query(options_.address, next_query_));
    next_query_ = next_query_ == pelco::Axis::pan ? pelco::Axis::tilt : pelco::Axis::pan;
  }
  return now + kStopAgain;
}

std::optional<PoseLine> PelcoHead::take_pose(Time now) {
  if (!std::exchange(new_pose_, false)) return std::nullopt;
  const Time oldest = std::min(*pan_at_, *tilt_at_);
  return PoseLine{{measured_.pan, 0, 0}, {measured_.tilt, 0, 0}, motion::seconds(now - oldest)};
}

}  // namespace cerberus::drivers
