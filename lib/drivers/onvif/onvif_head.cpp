// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/onvif_head.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::drivers {

using motion::AxisCommand;
using onvif::Angles;
using sensing::degrees;
using sensing::radians;
using Kind = AxisCommand::Kind;

constexpr OnvifParameters kParameters = kOnvifParameters;

OnvifHead::OnvifHead(std::unique_ptr<onvif::HttpClient> http, OnvifOptions options)
    : options_(std::move(options)),
      soap_(std::move(http)),
      login_(soap_, options_.login),
      zoom_lock_(options_.login.zoom),
      homing_(options_.home_time) {}

// A camera that stands at the end of its range is no fault of its reports.
std::string OnvifHead::beyond_range() const {
  const onvif::Mechanics& mechanics = options_.mechanics;
  if (!mechanics.least || !mechanics.most) return {};
  const auto axis = [&](const char* name, const motion::AxisLimits& limits, double least, double most) {
    return motion::beyond_reach(name, limits, sensing::radians(least), sensing::radians(most), camera_name(),
                                " (range)");
  };
  std::string wrong = axis("pan", limits_.pan, mechanics.least->pan, mechanics.most->pan);
  return wrong.empty() ? axis("tilt", limits_.tilt, mechanics.least->tilt, mechanics.most->tilt) : wrong;
}

std::string OnvifHead::open(const HeadSetup& setup, Time now) {
  limits_ = setup.limits;
  if (const std::string wrong = beyond_range(); !wrong.empty()) return wrong;
  reckoned_.begin(now, {setup.pan, setup.tilt});
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - begin);
  };
  login_.begin(now, options_.login_time);
  while (login_.busy() && elapsed() < options_.login_time) {
    pollfd wait{soap_.fd(), POLLIN, 0};
    ::poll(&wait, 1, 20);
    while (const auto answer = soap_.take(now + elapsed()))
      if (login_.owns(answer->id)) login_.handle(*answer, now + elapsed());
  }
  // A slow camera is driven without what could not be asked for: its positions and absolute moves.
  if (login_.busy() && !login_.cut_short()) return camera_name() + " does not answer in time";
  if (!login_.wrong().empty()) return camera_name() + " " + login_.wrong();
  on_login(now + elapsed());
  keeps_limits_ = absolute_;
  return {};
}

HeadAbilities OnvifHead::abilities() const {
  return {.position = keeps_limits_,
          .velocity = true,
          .feedback = positions_,
          .rate = kParameters.rate,
          .home = !positions_ && (options_.home || !camera_.preset.empty()),
          .zoom = camera_.options.zoom && options_.login.zoom < 0};
}

// Small cameras let a move end later than asked, or only at their own steps of a second.
Time OnvifHead::camera_timeout() const {
  Time timeout = kParameters.camera_timeout;
  if (camera_.options.most_timeout && camera_.options.most_timeout->count() > 0)
    timeout = std::min<Time>(timeout, *camera_.options.most_timeout);
  if (camera_.options.least_timeout) timeout = std::max<Time>(timeout, *camera_.options.least_timeout);
  return timeout;
}

unsigned OnvifHead::send(const onvif::Request& request, Time now) {
  return soap_.send(camera_.ptz, request, now, kParameters.request_time);
}

void OnvifHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  if (pan != pan_ || tilt != tilt_) sent_angle_ = false;
  pan_ = pan;
  tilt_ = tilt;
  homing_.end();
  stops_while_moving_ = 0;
  if (pan.kind != Kind::hold || tilt.kind != Kind::hold) return send_move(now);
  if (moved_ && !stopping_) begin_stop(now);
}

void OnvifHead::limit(const motion::Limits& limits, Time now) {
  limits_ = limits;
  sent_angle_ = false;
  send_move(now);
}

void OnvifHead::stop(Time now) noexcept {
  pan_ = tilt_ = {};
  zoom_order_.reset();
  homing_.end();
  stops_while_moving_ = 0;
  begin_stop(now);
}

void OnvifHead::zoom(double position, Time now) {
  zoom_order_ = std::min(position, 1.0);
  zoom_ordered_ = now;
}

// A camera may take any AbsoluteMove as the end of the move before: the zoom waits until the head stands, and not for long.
void OnvifHead::send_zoom(Time now) {
  if (!zoom_order_ || !online_ || login_.busy() || moved_ || stopping_ || homing_.busy()) return;
  const double position = *std::exchange(zoom_order_, std::nullopt);
  if (camera_.options.zoom && now - zoom_ordered_ < kParameters.zoom_fresh)
    send(zoom_request(camera_, position), now);
}

// Degrees a second, of the move that is sent now. Its Timeout ends it.
void OnvifHead::on_sent(const Angles& velocity, Time now) {
  sent_velocity_ = velocity;
  sent_ = now;
  moved_ = true;
  reckoned_.set_speeds({radians(velocity.pan), radians(velocity.tilt)}, now,
                       timeouts_ == Timeouts::given ? now + camera_timeout() : motion::kNever);
}

void OnvifHead::begin_stop(Time now) {
  sent_velocity_ = {};
  reckoned_.stop(now);
  sent_angle_ = false;
  if (camera_.profile.empty()) return;
  stopping_ = moved_ = true;
  verifying_ = false;
  send_stop(now);
}

void OnvifHead::send_stop(Time now) {
  stop_sent_ = now;
  if (stops_.size() >= kParameters.most_stops) return;
  const onvif::PanTilt zero{0, 0, spaces_.empty() ? std::string() : spaces_.front().uri};
  const onvif::Request request = stops_by_zero_ ? onvif::continuous_move(camera_.profile, zero, std::nullopt)
                                                : onvif::stop(camera_.profile);
  stops_.push_back({send(request, now), now, move_ == 0});
}

// As long as none counts: at once when the last move has been answered, else after a while.
void OnvifHead::send_stops(Time now) {
  if (!stopping_) return;
  const bool counts =
      std::any_of(stops_.begin(), stops_.end(), [](const SentStop& sent) { return sent.last; });
  const Time again = online_ ? kParameters.stop_again : std::max(kParameters.stop_again, retry_);
  if ((online_ && move_ == 0 && !counts && stops_.empty()) || now - stop_sent_ >= again) send_stop(now);
}

bool OnvifHead::has_position(Time now) const {
  return position_ && now - position_time_ < kParameters.fresh;
}

bool OnvifHead::goes_to_an_angle() const {
  const bool angle = pan_.kind == Kind::position || tilt_.kind == Kind::position;
  return angle && pan_.kind != Kind::velocity && tilt_.kind != Kind::velocity;
}

onvif::PanTilt OnvifHead::wanted_velocity(Time now) const {
  std::optional<double> pan, tilt;  // by the last report and the velocity in force since
  const motion::PanTilt here = reckoned_.position(now);
  if (has_position(now) && !reports_.proven()) {  // it would turn on and on if the reports were false
    const motion::PanTilt travel = reports_.travel({degrees(here.pan), degrees(here.tilt)});
    pan = position_->pan + travel.pan;
    tilt = position_->tilt + travel.tilt;
  } else if (has_position(now)) {
    const double seconds = motion::seconds(now - position_time_);
    pan = position_->pan + sent_velocity_.pan * seconds;
    tilt = position_->tilt + sent_velocity_.tilt * seconds;
  } else if (!positions_ && keeps_limits_) {  // it has lost them: what was promised is kept by reckoning
    pan = degrees(here.pan);
    tilt = degrees(here.tilt);
  }
  // A head that goes to angles keeps the limits itself, for which it needs its position; the others are sent speeds
  // that brake before them. Without a position the reckoned one stops the camera a little beyond.
  Angles speed{onvif::approach(pan_, limits_.pan, pan, keeps_limits_),
               onvif::approach(tilt_, limits_.tilt, tilt, keeps_limits_)};
  if (!positions_) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    const motion::PanTilt allowed =
        reckoned_.confined({radians(speed.pan), radians(speed.tilt)}, {kUnknown, kUnknown}, limits_, 0, now);
    speed = {allowed.pan == 0 ? 0 : speed.pan, allowed.tilt == 0 ? 0 : speed.tilt};
  }
  return onvif::to_velocity(speed, spaces_.front(), options_.mechanics);
}

void OnvifHead::send_absolute(Time now) {
  if (sent_angle_ || move_ != 0) return;
  verifying_ = false;
  const auto target = [](const AxisCommand& command, const motion::AxisLimits& limits, double position) {
    if (command.kind != Kind::position || !std::isfinite(command.value)) return position;
    return degrees(std::clamp(command.value, limits.from, limits.to));
  };
  const Angles to{target(pan_, limits_.pan, position_->pan), target(tilt_, limits_.tilt, position_->tilt)};
  const auto speed = [](const AxisCommand& command, const motion::AxisLimits& limits) {
    return degrees(command.speed > 0 ? std::min(command.speed, limits.speed) : limits.speed);
  };
  move_ =
      send(onvif::absolute_move(camera_.profile, onvif::to_position(to, *position_space_, options_.mechanics),
                                onvif::to_speed({speed(pan_, limits_.pan), speed(tilt_, limits_.tilt)},
                                                camera_.options, options_.mechanics)),
           now);
  sent_angle_ = true;
  tries_ = false;
  on_sent({}, now);
}

void OnvifHead::send_move(Time now) {
  if (!online_ || login_.busy() || stopping_ || now < move_refused_until_) return;
  if (homing_.busy()) return send_home(now);
  if (absolute_ && reports_.proven() && goes_to_an_angle() && has_position(now)) return send_absolute(now);
  const onvif::PanTilt vector = wanted_velocity(now);
  const Angles wanted = onvif::from_velocity(vector, options_.mechanics);
  if (wanted.pan == 0 && wanted.tilt == 0) {
    if (moved_) begin_stop(now);
    return;
  }
  if (move_ != 0) return;
  verifying_ = false;
  const bool same = std::abs(wanted.pan - sent_velocity_.pan) < kParameters.least_change &&
                    std::abs(wanted.tilt - sent_velocity_.tilt) < kParameters.least_change &&
                    (wanted.pan == 0) == (sent_velocity_.pan == 0) &&
                    (wanted.tilt == 0) == (sent_velocity_.tilt == 0);
  // Also without a Timeout: the camera's own default may end a move.
  const Time refresh = camera_timeout() / 2;
  if (moved_ && now - sent_ < (same ? refresh : Time(static_cast<Time::rep>(1e9 / kParameters.rate)))) return;
  std::optional<std::chrono::milliseconds> timeout;
  if (timeouts_ == Timeouts::given) timeout = std::chrono::ceil<std::chrono::milliseconds>(camera_timeout());
  move_ = send(onvif::continuous_move(camera_.profile, vector, timeout), now);
  sent_angle_ = false;
  tries_ = timeouts_ == Timeouts::tried_without;
  on_sent(wanted, now);
}

void OnvifHead::home(Time now) {
  stop(now);
  homing_.want();
}

void OnvifHead::send_home(Time now) {
  if (!homing_.wanted() || move_ != 0) return;
  move_ = send(options_.home ? onvif::goto_home_position(camera_.profile)
                             : onvif::goto_preset(camera_.profile, camera_.preset),
               now);
  tries_ = false;
  homing_.on_sent(now);
  moved_ = true;
}

std::optional<HomedLine> OnvifHead::take_homed(Time now) {
  if (!homing_.take(now)) return std::nullopt;
  reckoned_.set_reference({}, now);
  return HomedLine{};
}

std::optional<SpeedsLine> OnvifHead::take_speeds(Time now) {
  const auto speeds = reckoned_.take_speeds(now);
  told_speeds_ = told_speeds_ || (!positions_ && speeds);
  return told_speeds_ ? speeds : std::nullopt;
}

void OnvifHead::send_inquiry(Time now) {
  if (inquiry_ != 0 || !online_ || now - inquiry_sent_ < kParameters.inquiry_period) return;
  inquiry_sent_ = now;
  inquiry_ = send(onvif::get_status(camera_.profile), now);
}

void OnvifHead::log_in_again(Time now) {
  if (login_.busy() || now - login_tried_ < retry_) return;
  login_tried_ = now;
  login_.begin(now, kParameters.request_time, true);
}

Time OnvifHead::tick(Time now) {
  read(now);
  reckoned_.expire(now);
  const auto unanswered = soap_.unanswered();
  if (online_ && unanswered && now - *unanswered > options_.answer_time) lose("does not answer", now);
  if (!online_) log_in_again(now);
  if (online_ && !stopping_ && now >= move_refused_until_) fault_.clear();
  send_stops(now);
  send_move(now);
  send_zoom(now);
  send_inquiry(now);
  return now + (stopping_ || move_ != 0 ? std::chrono::milliseconds(10) : std::chrono::milliseconds(25));
}

std::optional<PoseLine> OnvifHead::take_pose(Time now) {
  std::optional<PoseLine> pose = std::exchange(pose_, std::nullopt);
  if (pose) pose->age = motion::seconds(now - position_time_);
  return pose;
}

void OnvifHead::watch(std::vector<pollfd>& fds) const {
  fds.push_back({soap_.fd(), POLLIN, 0});
}

}  // namespace cerberus::drivers
