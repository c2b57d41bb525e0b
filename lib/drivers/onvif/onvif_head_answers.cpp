// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's answers, and their absence.
#include "drivers/onvif/onvif_head.h"

#include <algorithm>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::drivers {

using onvif::SoapAnswer;
using sensing::degrees;
using sensing::radians;

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

void OnvifHead::on_login(Time now) {
  camera_ = login_.camera();
  spaces_ = onvif::velocity_spaces(camera_.options);
  position_space_ = onvif::position_space(camera_.options, options_.mechanics);
  const auto& status = camera_.status;
  const bool position =
      options_.feedback && status && status->position &&
      onvif::to_degrees(*status->position, position_space_, camera_.options, options_.mechanics);
  positions_ = position && !reports_.wrong();
  absolute_ = options_.absolute && position && position_space_ && !camera_.options.positions.empty();
  stops_by_zero_ = false;
  timeouts_ = Timeouts::given;
  warn_of_unused_range();
  online_ = true;
  zoom_lock_.on_sent(now);  // by the login
  if (options_.warn && !login_.warning().empty()) options_.warn(camera_name() + " " + login_.warning());
  retry_ = kParameters.reconnect;
  for (const SentStop& sent : stops_) soap_.cancel(sent.id);
  stops_.clear();
  begin_stop(now);
}

void OnvifHead::warn_once(bool& warned, const std::string& text) {
  if (!std::exchange(warned, true) && options_.warn) options_.warn(camera_name() + " " + text);
}

void OnvifHead::warn_of_unused_range() {
  const auto& status = camera_.status;
  if (!options_.mechanics.least) return;
  const std::string end = ": range= is not used";
  if (!options_.feedback) return warn_once(warned_of_range_, "has no-feedback" + end);
  if (!status || !status->position) return warn_once(warned_of_range_, "reports no position" + end);
  switch (onvif::unit_of(*status->position, position_space_)) {
    case onvif::Unit::generic:
      return;
    case onvif::Unit::degrees:
      return warn_once(warned_of_range_, "reports its position in degrees" + end);
    case onvif::Unit::unknown:
      return warn_once(warned_of_range_,
                       "reports its position in a space of its own (" + status->position->uri + ")" + end);
  }
}

void OnvifHead::on_stop(const SentStop& sent, const SoapAnswer& answer, Time now) {
  if (!stopping_ || !answer.arrived) return;
  if (answer.not_authorized()) return log_in_again(now);
  if (answer.fault) {
    stops_by_zero_ = !stops_by_zero_;
    return;
  }
  if (!answer.good()) return;
  reckoned_.on_stopped(sent.time);
  if (!sent.last || !online_) return;
  for (const SentStop& other : stops_) soap_.cancel(other.id);
  stops_.clear();
  stopping_ = moved_ = false;
  verifying_ = seen_moving_ && seen_idle_;
}

void OnvifHead::on_move(const SoapAnswer& answer, Time now) {
  move_ = 0;
  if (answer.good()) {
    if (!tries_) return;
    timeouts_ = Timeouts::refused;
    return warn_once(warned_of_timeout_,
                     "takes no Timeout in a move: if cerberus-head is killed, nothing stops it");
  }
  if (homing_.busy() && answer.fault && !answer.not_authorized()) return refuse(*answer.fault, now);
  const bool home = homing_.busy();  // whose request put no speeds in force
  if (home) homing_.want();
  const bool angle = std::exchange(sent_angle_, false);
  sent_velocity_ = {};                               // it is sent again, or something better
  if (!answer.fault && !answer.bad_request) return;  // the camera may have obeyed it all the same
  if (!home) reckoned_.on_refused();
  if (answer.not_authorized()) return log_in_again(now);
  on_refused_move(angle, answer.fault.value_or(onvif::Fault{"BadRequest", {"BadRequest"}, "HTTP 400"}), now);
}

// Cameras refuse a Timeout by any fault, and moves for other reasons by the same ones: what helps is found by trying.
void OnvifHead::on_refused_move(bool angle, const onvif::Fault& fault, Time now) {
  if (angle) {
    absolute_ = false;  // from now on angles are reached at speeds
  } else if (refuses_space(fault) && spaces_.size() > 1 && !fault.has("TimeoutNotSupported")) {
    spaces_.erase(spaces_.begin());
  } else if (timeouts_ == Timeouts::given) {
    timeouts_ = Timeouts::tried_without;
  } else {
    if (timeouts_ == Timeouts::tried_without) timeouts_ = Timeouts::given;
    refuse(fault, now);
  }
}

void OnvifHead::refuse(const onvif::Fault& fault, Time now) {
  fault_ = camera_name() + " refuses to move: " + fault.text();
  stop(now);
  move_refused_until_ = now + kParameters.after_fault;
}

void OnvifHead::on_status(const SoapAnswer& answer, Time now) {
  inquiry_ = 0;
  if (answer.not_authorized()) return log_in_again(now);
  const auto status = onvif::read_status(answer.body);
  if (!status) return;
  if (const auto zoom = onvif::zoom_share(*status, camera_.options)) on_zoom(*zoom, now);
  if (options_.feedback && status->position)
    if (const auto at =
            onvif::to_degrees(*status->position, position_space_, camera_.options, options_.mechanics))
      on_position(*at, now);
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

void OnvifHead::on_position(const onvif::Angles& at, Time now) {
  const bool were = positions_;
  const motion::PanTilt here = reckoned_.position(inquiry_sent_);
  reports_.add({at.pan, at.tilt}, {degrees(here.pan), degrees(here.tilt)}, inquiry_sent_);
  positions_ = !reports_.wrong();
  if (positions_) {
    position_ = at;
    position_time_ = inquiry_sent_ + (now - inquiry_sent_) / 2;
    pose_ = PoseLine{{radians(at.pan), 0, 0}, {radians(at.tilt), 0, 0}, 0};
    return;
  }
  if (!were) return;
  position_.reset();
  pose_.reset();
  sent_angle_ = false;
  reckoned_.report_again(now);
  warn_once(warned_of_reports_,
            "turns and reports the same position all the time: its positions are not used (no-feedback)");
}

// A camera may take any AbsoluteMove as the end of the move before: the zoom waits until the head stands.
void OnvifHead::on_zoom(double position, Time now) {
  zoom_ = position;
  if (moved_ || stopping_ || homing_.busy() || !camera_.options.zoom || !zoom_lock_.on_zoom(position, now))
    return;
  send(zoom_request(camera_, options_.login.zoom), now);
  zoom_lock_.on_sent(now);
}

void OnvifHead::lose(const std::string& why, Time now) {
  fault_ = camera_name() + " " + why;
  if (std::exchange(online_, false)) {
    for (const unsigned id : {move_, inquiry_}) soap_.cancel(id);
    move_ = inquiry_ = 0;
    login_tried_ = now;  // reported before it is tried again
    stop(now);
    reckoned_.on_stop_lost();
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

}  // namespace cerberus::drivers
