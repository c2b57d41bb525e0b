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
using onvif::SoapAnswer;
using sensing::degrees;
using sensing::radians;
using Kind = AxisCommand::Kind;

namespace {

constexpr OnvifParameters kParameters = kOnvifParameters;

// Faults that mean the space or the numbers in it, rather than the move.
bool refuses_space(const onvif::Fault& fault) {
  for (const std::string_view code :
       {"SpaceNotSupported", "InvalidVelocity", "InvalidTranslation", "InvalidArgVal"})
    if (fault.has(code)) return true;
  return false;
}

}  // namespace

OnvifHead::OnvifHead(std::unique_ptr<onvif::HttpClient> http, OnvifOptions options)
    : options_(std::move(options)),
      soap_(std::move(http)),
      login_(soap_, options_.login),
      zoom_lock_(options_.login.zoom),
      homing_(options_.home_time) {}

std::string OnvifHead::open(const HeadSetup& setup, Time now) {
  limits_ = setup.limits;
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
          .home = !positions_ && (options_.home || !camera_.preset.empty())};
}

void OnvifHead::on_login(Time now) {
  camera_ = login_.camera();
  spaces_ = onvif::velocity_spaces(camera_.options);
  position_space_ = onvif::position_space(camera_.options, options_.mechanics);
  const auto& status = camera_.status;
  positions_ = options_.feedback && status && status->position &&
               onvif::to_degrees(*status->position, position_space_, camera_.options, options_.mechanics);
  absolute_ = positions_ && camera_.absolute && position_space_;
  stops_by_zero_ = timeout_refused_ = false;
  online_ = true;
  zoom_lock_.on_sent(now);  // by the login
  if (options_.warn && !login_.warning().empty()) options_.warn(camera_name() + " " + login_.warning());
  retry_ = kParameters.reconnect;
  for (const SentStop& sent : stops_) soap_.cancel(sent.id);
  stops_.clear();
  begin_stop(now);
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
  homing_.end();
  stops_while_moving_ = 0;
  begin_stop(now);
}

// The camera turns at this velocity (degrees a second), as far as known.
void OnvifHead::set_velocity(const Angles& velocity, Time now) {
  sent_velocity_ = velocity;
  reckoned_.set_speeds({radians(velocity.pan), radians(velocity.tilt)}, now);
}

void OnvifHead::begin_stop(Time now) {
  set_velocity({}, now);
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
  stops_.push_back({send(request, now), move_ == 0});
}

// As long as none counts: at once when the last move has been answered, else after a while.
void OnvifHead::send_stops(Time now) {
  if (!stopping_) return;
  const bool counts =
      std::any_of(stops_.begin(), stops_.end(), [](const SentStop& sent) { return sent.last; });
  const Time again = online_ ? kParameters.stop_again : std::max(kParameters.stop_again, retry_);
  if ((online_ && move_ == 0 && !counts && stops_.empty()) || now - stop_sent_ >= again) send_stop(now);
}

void OnvifHead::on_stop(const SentStop& sent, const SoapAnswer& answer, Time now) {
  if (!stopping_ || !answer.arrived) return;
  if (answer.not_authorized()) return log_in_again(now);
  if (answer.fault) {
    stops_by_zero_ = !stops_by_zero_;
    return;
  }
  if (!answer.good() || !sent.last || !online_) return;
  for (const SentStop& other : stops_) soap_.cancel(other.id);
  stops_.clear();
  stopping_ = moved_ = false;
  verifying_ = seen_moving_ && seen_idle_;
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
  if (has_position(now)) {
    const double seconds = motion::seconds(now - position_time_);
    pan = position_->pan + sent_velocity_.pan * seconds;
    tilt = position_->tilt + sent_velocity_.tilt * seconds;
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
  sent_angle_ = moved_ = true;
  set_velocity({}, now);
  sent_ = now;
}

void OnvifHead::send_move(Time now) {
  if (!online_ || login_.busy() || stopping_ || now < move_refused_until_) return;
  if (homing_.busy()) return send_home(now);
  if (absolute_ && goes_to_an_angle() && has_position(now)) return send_absolute(now);
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
  const Time refresh = timeout_refused_ ? motion::kNever : camera_timeout() / 2;
  if (moved_ && now - sent_ < (same ? refresh : Time(static_cast<Time::rep>(1e9 / kParameters.rate)))) return;
  std::optional<std::chrono::milliseconds> timeout;
  if (!timeout_refused_) timeout = std::chrono::ceil<std::chrono::milliseconds>(camera_timeout());
  move_ = send(onvif::continuous_move(camera_.profile, vector, timeout), now);
  set_velocity(wanted, now);
  sent_angle_ = false;
  moved_ = true;
  sent_ = now;
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
  return positions_ ? std::nullopt : speeds;
}

void OnvifHead::on_move(const SoapAnswer& answer, Time now) {
  move_ = 0;
  if (answer.good()) return;
  if (homing_.busy() && answer.fault && !answer.not_authorized()) return refuse(*answer.fault, now);
  if (homing_.busy()) homing_.want();
  const bool angle = std::exchange(sent_angle_, false);
  set_velocity({}, now);  // not in force: it is sent again, or something better
  if (!answer.fault) return;
  if (answer.not_authorized()) return log_in_again(now);
  if (angle) {
    absolute_ = false;  // from now on angles are reached at speeds
  } else if (answer.fault->has("TimeoutNotSupported")) {
    timeout_refused_ = true;
  } else if (refuses_space(*answer.fault) && spaces_.size() > 1) {
    spaces_.erase(spaces_.begin());
  } else {
    refuse(*answer.fault, now);
  }
}

void OnvifHead::refuse(const onvif::Fault& fault, Time now) {
  fault_ = camera_name() + " refuses to move: " + fault.text();
  stop(now);
  move_refused_until_ = now + kParameters.after_fault;
}

void OnvifHead::send_inquiry(Time now) {
  if (inquiry_ != 0 || !online_ || now - inquiry_sent_ < kParameters.inquiry_period) return;
  inquiry_sent_ = now;
  inquiry_ = send(onvif::get_status(camera_.profile), now);
}

void OnvifHead::on_status(const SoapAnswer& answer, Time now) {
  inquiry_ = 0;
  if (answer.not_authorized()) return log_in_again(now);
  const auto status = onvif::read_status(answer.body);
  if (!status) return;
  if (const auto zoom = onvif::zoom_share(*status, camera_.options)) on_zoom(*zoom, now);
  if (positions_ && status->position) {
    const auto at =
        onvif::to_degrees(*status->position, position_space_, camera_.options, options_.mechanics);
    if (at) {
      position_ = at;
      position_time_ = inquiry_sent_ + (now - inquiry_sent_) / 2;
      pose_ = PoseLine{{radians(at->pan), 0, 0}, {radians(at->tilt), 0, 0}, 0};
    }
  }
  if (!status->moving) return;
  (*status->moving ? seen_moving_ : seen_idle_) = true;
  homing_.on_move_status(*status->moving, inquiry_sent_);
  if (!*status->moving) {
    verifying_ = false;
    stops_while_moving_ = 0;
  }
  // A report from before the stop was acknowledged says nothing about it.
  if (!*status->moving || stopping_ || moved_ || inquiry_sent_ < stop_sent_ || !seen_idle_) return;
  verifying_ = stops_while_moving_ < kParameters.stops_while_moving;
  if (!verifying_) return;
  ++stops_while_moving_;
  begin_stop(now);
}

// A camera may take any AbsoluteMove as the end of the move before: the zoom waits until the head stands.
void OnvifHead::on_zoom(double position, Time now) {
  zoom_ = position;
  if (moved_ || stopping_ || homing_.busy() || !camera_.options.zoom || !zoom_lock_.on_zoom(position, now))
    return;
  send(zoom_request(camera_, options_.login.zoom), now);
  zoom_lock_.on_sent(now);
}

void OnvifHead::log_in_again(Time now) {
  if (login_.busy() || now - login_tried_ < retry_) return;
  login_tried_ = now;
  login_.begin(now, kParameters.request_time, true);
}

void OnvifHead::lose(const std::string& why, Time now) {
  fault_ = camera_name() + " " + why;
  if (std::exchange(online_, false)) {
    for (const unsigned id : {move_, inquiry_}) soap_.cancel(id);
    move_ = inquiry_ = 0;
    login_tried_ = now;  // reported before it is tried again
    stop(now);
  }
}

void OnvifHead::count_failures(const SoapAnswer& answer, Time now) {
  failures_ = answer.arrived ? 0 : failures_ + 1;
  unreadable_ = answer.arrived && !answer.body && !answer.fault ? unreadable_ + 1 : 0;
  if (!online_) return;
  // A camera may close an idle connection just when a request goes out: one failure is none.
  if (failures_ > 1) lose("cannot be reached: " + answer.wrong, now);
  if (unreadable_ >= kParameters.most_unreadable) lose("does not work: " + answer.wrong, now);
}

void OnvifHead::read(Time now) {
  while (const auto answer = soap_.take(now)) {
    if (login_.owns(answer->id)) {
      login_.handle(*answer, now);
      if (login_.busy()) continue;
      if (login_.wrong().empty()) {
        on_login(now);
        continue;
      }
      if (login_.refused()) retry_ = kParameters.after_refusal;
      lose(login_.wrong(), now);
      continue;
    }
    if (const auto stop = std::find_if(stops_.begin(), stops_.end(),
                                       [&](const SentStop& sent) { return sent.id == answer->id; });
        stop != stops_.end()) {
      const SentStop sent = *stop;
      stops_.erase(stop);
      on_stop(sent, *answer, now);
    } else if (answer->id == move_) {
      on_move(*answer, now);
    } else if (answer->id == inquiry_) {
      on_status(*answer, now);
    }
    count_failures(*answer, now);
  }
}

Time OnvifHead::tick(Time now) {
  read(now);
  const auto unanswered = soap_.unanswered();
  if (online_ && unanswered && now - *unanswered > options_.answer_time) lose("does not answer", now);
  if (!online_) log_in_again(now);
  if (online_ && !stopping_ && now >= move_refused_until_) fault_.clear();
  send_stops(now);
  send_move(now);
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
