// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_client.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::AxisState;
using motion::Pose;
using Kind = AxisCommand::Kind;

struct Parameters {
  Time fresh =
      std::chrono::milliseconds(500);  // feedback older than this corrects nothing and measures no pose
  double correction_gain =
      0.3;  // share of the difference to a reported pose; derived: settles in ten reports
  // After the dead time, until a head that was to hold stands. chosen: as ReportWatch's grace.
  Time settling = std::chrono::milliseconds(500);
  double least_place =
      sensing::radians(.1);    // from where the model is; chosen: the steps of encoders are finer
  double least_change = 1e-4;  // radians a second: slower changes of a speed are not sent
  // Radians a second for each radian between the model and the reckoned pose when a command takes effect. derived: a
  // step that is 20 % too fast at 20 degrees a second stays within 1.3 degrees.
  double follow_gain = 3;
  // derived: 340 degrees at a camera's slow 10 degrees a second, and its start
  Time home_timeout = std::chrono::seconds(45);
};
constexpr Parameters kParameters;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::string HelperClient::open(const HeadSetup& setup) {
  HeadSetup rigid = setup;  // play would hide from the head the turn that takes it up
  rigid.backlash = 0;
  rigid.zoom_table = {};  // the head reports its own
  reckoning_.set_play(setup.play);
  if (std::string wrong = model_.open(rigid); !wrong.empty()) return wrong;
  setup_ = setup;
  return {};
}

void HelperClient::begin(Time now) {
  HeadSetup here = setup_;
  Pose pose, model;
  if (state(now, pose).empty() && model_.state(now, model).empty()) {
    here.pan = pose.pan.position;
    here.tilt = pose.tilt.position;
    // It stands until the next command.
    model_.place(now, {here.pan - model.pan.position, here.tilt - model.tilt.position}, true);
  }
  last_.pan = last_.tilt = {};
  follows_ = false;
  ready_ = pressed_ = reckons_ = false;
  fault_.clear();
  last_move_.clear();
  adopts_ = true;
  pan_ = tilt_ = {};
  measured_.reset();
  homing_.reset();
  zoom_.reset();
  send_(hello_line(here, setup_.helper_timeout));
}

void HelperClient::lose(std::string why) {
  ready_ = false;
  fault_ = loss_ = std::move(why);
}

bool HelperClient::is_fresh(Time now) const {
  return measured_ && now - *measured_ < kParameters.fresh;
}

double HelperClient::field_of_view() const {
  if (!zoom_) return 0;
  if (!setup_.zoom_table.empty()) return setup_.zoom_table.field_of_view(*zoom_);
  return setup_.lock_zoom ? 0 : std::numeric_limits<double>::quiet_NaN();
}

void HelperClient::send_command(Time now) {
  const auto direct = [this](const AxisCommand& c) {
    return c.kind == Kind::hold || (c.kind == Kind::position && abilities_.position) ||
           (c.kind == Kind::velocity && abilities_.velocity && abilities_.position);
  };
  follows_ = !direct(last_.pan) || !direct(last_.tilt);
  if (follows_) {
    next_follow_ = Time{};
    follow(now);
    return;
  }
  const std::string line = move_line(last_.pan, last_.tilt);
  if (line != last_move_) send_(line);
  last_move_ = line;
}

// What was commanded is over: the head stands until the next command.
void HelperClient::stand(Time now) {
  model_.place(now, {}, true);
  last_.pan = last_.tilt = {};
  follows_ = false;
  homing_.reset();
  last_move_.clear();
}

// Only to a zoom of which it is known where it is. Once: what becomes of it is reported.
void HelperClient::send_zoom() {
  const auto zoom = std::exchange(last_.zoom, std::nullopt);
  if (zoom && abilities_.zoom && zoom_ && !last_.stop && !pressed_) send_(zoom_line({*zoom}) + '\n');
}

// The protocol's stop, which ends homing, too.
void HelperClient::send_stop() {
  follows_ = false;
  last_move_.clear();
  send_("stop\n");
}

// Makes the head do what the model does.
void HelperClient::follow(Time now) {
  if (now < next_follow_) return;
  next_follow_ = now + period();
  // The model's motion from the time when this line takes effect until the next line does.
  const Time begin = now + setup_.latency;
  Pose ahead, next;
  if (!model_.state(begin, ahead).empty() || !model_.state(begin + period(), next).empty()) return;
  const bool corrected = is_fresh(now) && !reckons_;
  const Pose reckoned = reckoning_.at(begin);
  const auto error = [&](const AxisState& model_axis, const AxisState& reckoned_axis, double correction) {
    if (reckons_) return kParameters.follow_gain * (reckoned_axis.position - model_axis.position);
    return corrected ? correction : 0;
  };
  // A head that is to hold stands where it came to rest, which its pose shows, and does not creep to where the model
  // rests, unless it is beyond its limits.
  const auto rests = [&](const AxisCommand& command, double mean, double reported,
                         const motion::AxisLimits& limits) {
    return corrected && command.kind == Kind::hold && mean == 0 && reported >= limits.from &&
           reported <= limits.to;
  };
  const auto axis = [&](const AxisCommand& command, const AxisState& from, const AxisState& to,
                        double correction, double reported, const motion::AxisLimits& limits,
                        const motion::SpeedMap& map) -> AxisCommand {
    // The mean, not the speed at its begin: a head that rests would begin to turn a period later.
    const double mean = (to.position - from.position) / motion::seconds(period());
    if (!abilities_.velocity) return {Kind::position, to.position, std::abs(mean)};
    if (rests(command, mean, reported, limits)) return {};
    const double speed = std::clamp(mean - correction, -limits.speed, limits.speed);
    return std::abs(speed) < kParameters.least_change
               ? AxisCommand{}
               : AxisCommand{Kind::velocity, map.command_for(speed), 0};
  };
  const std::string line =
      move_line(axis(last_.pan, ahead.pan, next.pan, error(ahead.pan, reckoned.pan, pan_.correction),
                     reported_.pan, setup_.limits.pan, setup_.pan_speeds),
                axis(last_.tilt, ahead.tilt, next.tilt, error(ahead.tilt, reckoned.tilt, tilt_.correction),
                     reported_.tilt, setup_.limits.tilt, setup_.tilt_speeds));
  if (line != last_move_) send_(line);
  last_move_ = line;
  if (ahead.settled && !measured_ && (!reckons_ || reckoned.settled)) follows_ = false;
}

void HelperClient::check_homing(Time now) {
  if (!homing_ || now - *homing_ < kParameters.home_timeout) return;
  homing_.reset();
  send_("stop\n");
  notice_ = "the head did not find its reference";
}

std::optional<HelperLine> HelperClient::handle(const std::string& text, Time now) {
  auto line = parse_helper_line(text);
  if (line)
    take(*line, now);
  else if (text.starts_with("pose "))
    take_pose({kNoNumber, kNoNumber}, now, now);
  return line;
}

void HelperClient::take(const HelperLine& line, Time now) {
  if (const auto* came = std::get_if<ReadyLine>(&line)) {
    abilities_ = came->abilities;
    ready_ = true;
    fault_.clear();
  } else if (const auto* reported = std::get_if<FaultLine>(&line)) {
    const bool first = fault_.empty();
    fault_ = reported->text;
    if (!first) return;
    stand(now);
    send_("stop\n");
  } else if (std::get_if<RecoveredLine>(&line)) {
    fault_.clear();
    stand(now);
    adopts_ = true;
  } else if (const auto* emergency = std::get_if<EmergencyLine>(&line)) {
    pressed_ = emergency->pressed;
    was_pressed_ = was_pressed_ || pressed_;
    adopts_ = true;
  } else if (const auto* halted = std::get_if<StoppedLine>(&line)) {
    notice_ = "the helper stopped the head: " + halted->text;
    last_move_.clear();
  } else if (const auto* pose = std::get_if<PoseLine>(&line)) {
    take_pose(*pose, now);
  } else if (const auto* speeds = std::get_if<SpeedsLine>(&line)) {
    const Time at = now - Time(static_cast<Time::rep>(std::min(speeds->age, SpeedsLine::kMostAge) * 1e9)) +
                    setup_.latency;
    Pose here;
    if (!std::exchange(reckons_, true) && model_.state(now, here).empty())
      reckoning_.begin(at, {here.pan.position, here.tilt.position});
    reckoning_.turn(
        at, {setup_.pan_speeds.actual(speeds->speed.pan), setup_.tilt_speeds.actual(speeds->speed.tilt)});
  } else if (const auto* zoom = std::get_if<ZoomLine>(&line)) {
    zoom_ = zoom->position;
  } else if (const auto* homed = std::get_if<HomedLine>(&line)) {
    if (!std::exchange(homing_, std::nullopt)) return;
    measured_ = now;
    reckons_ = true;
    reckoning_.begin(*measured_, homed->at);
  }
}

void HelperClient::take_pose(const PoseLine& pose, Time now) {
  const Time at = now - Time(static_cast<Time::rep>(std::min(pose.age, 10.0) * 1e9));
  take_pose({pose.pan.position, pose.tilt.position}, at, now);
}

// reported: NaN where the line has no numbers. Of a head that does not work, or whose motors are off, nothing is expected.
void HelperClient::take_pose(const motion::PanTilt& reported, Time at, Time now) {
  using Verdict = motion::ReportWatch::Verdict;
  Pose model;
  if (!parted_.empty() || !model_.state(at, model).empty()) return;
  if (reckons_) model = reckoning_.at(at);
  const bool works = fault_.empty() && !pressed_, number = std::isfinite(reported.pan);
  adopts_ = adopts_ || !works;
  if (!works && !number) return;
  const motion::PanTilt here{motion::unwrapped(reported.pan, model.pan.position, setup_.limits.pan),
                             motion::unwrapped(reported.tilt, model.tilt.position, setup_.limits.tilt)};
  if (adopts_ && number) {
    adopts_ = false;
    pan_.watch.reset();
    tilt_.watch.reset();
    if (!reckons_) place(now, {here.pan - model.pan.position, here.tilt - model.tilt.position});
    model.pan.position = here.pan;
    model.tilt.position = here.tilt;
  }
  const double latency = motion::seconds(setup_.latency);
  const auto judge = [&](Reports& axis, const char* name, double position, const AxisState& commanded) {
    const Verdict verdict = axis.watch.add(at, position, commanded.position, commanded.speed, latency);
    if (verdict == Verdict::parted) part(name, position, commanded.position, now);
    return verdict == Verdict::plausible;
  };
  const bool pan = judge(pan_, "pan", here.pan, model.pan);
  const bool tilt = parted_.empty() && judge(tilt_, "tilt", here.tilt, model.tilt);
  if (!pan || !tilt) return;
  measured_ = at;
  reported_ = here;
  if (reckons_) return reckoning_.place(at, here);
  // Where it stands after a hold is where it was to stop, if it has followed so far.
  const Time settled = now - setup_.latency - kParameters.settling;
  const auto correct = [&](Reports& axis, const AxisCommand& command, const AxisState& commanded,
                           double position) {
    axis.correction += kParameters.correction_gain * (position - commanded.position - axis.correction);
    if (commanded.speed != 0 || command.kind != Kind::hold) {
      axis.moved = now;
      axis.rested = false;
    }
    if (axis.rested || axis.moved > settled || !axis.watch.take_rest(position, commanded.position))
      return 0.0;
    axis.rested = true;
    return position - commanded.position;
  };
  const motion::PanTilt by{correct(pan_, last_.pan, model.pan, here.pan),
                           correct(tilt_, last_.tilt, model.tilt, here.tilt)};
  place(now, by);
}

// The model is found to be `by` (radians) from where it is. Little of it is left to the corrections.
void HelperClient::place(Time now, motion::PanTilt by) {
  for (const auto& [way, axis] : {std::pair{&by.pan, &pan_}, {&by.tilt, &tilt_}}) {
    if (std::abs(*way) >= kParameters.least_place)
      axis->correction = 0;
    else
      *way = 0;
  }
  model_.place(now, by);
  pan_.watch.shift(by.pan);
  tilt_.watch.shift(by.tilt);
}

void HelperClient::part(const char* axis, double reported, double commanded, Time now) {
  const auto degrees = [](double angle) { return text::rounded(sensing::degrees(angle), 1).string(); };
  parted_ = std::string("the head reports ") +
            (std::isfinite(reported) ? degrees(reported) + " degrees of " : "no number as ") + axis +
            ", and its commands lead to " + degrees(commanded) +
            " degrees. It was stopped, and stands until the next order by hand or auto. Check what blocks or "
            "turns it, its limits, and the direction and unit of its reports";
  parted_untold_ = true;
  stand(now);
  send_stop();
}

// A head that is at fault obeys nothing, neither now nor when it works again.
std::string HelperClient::accept(const HeadCommand& command) {
  const bool moves = command.pan.kind != Kind::hold || command.tilt.kind != Kind::hold;
  if (moves && !parted_untold_ && !parted_.empty()) {
    parted_.clear();
    adopts_ = true;
  }
  HeadCommand obeyed = command;
  if (!loss_.empty() || !why_idle().empty()) {
    obeyed.pan = obeyed.tilt = {};
    obeyed.zoom.reset();
  }
  if (std::string wrong = model_.command(obeyed); !wrong.empty()) return wrong;
  last_ = obeyed;
  if (std::exchange(homing_, std::nullopt)) last_move_.clear();
  return {};
}

std::string HelperClient::why_idle() const {
  if (!fault_.empty()) return fault_;
  if (!parted_.empty()) return parted_;
  return ready_ ? "" : "the head's helper has been started again and is not ready yet";
}

std::string HelperClient::fault_at_rest() {
  if (std::string loss = std::exchange(loss_, {}); !loss.empty()) return loss;
  return pressed_ ? std::string() : why_idle();
}

bool HelperClient::turns(Time now) {
  if (!ready_ || !fault_.empty() || pressed_) return false;
  if (follows_ && abilities_.velocity) return last_move_.find(" at ") != std::string::npos;
  Pose pose;
  return !last_move_.empty() && model_.state(now, pose).empty() && pose.moving();
}

std::string HelperClient::execute(Time now) {
  if (std::string loss = std::exchange(loss_, {}); !loss.empty()) return loss;
  if (std::string wrong = why_idle(); !wrong.empty()) return wrong;
  if (last_.stop)
    send_stop();
  else
    send_command(now);
  send_zoom();
  return std::exchange(notice_, {});
}

void HelperClient::stop(Time now) noexcept {
  model_.stop(now);
  last_.pan = last_.tilt = {};
  homing_.reset();
  send_stop();
}

std::string HelperClient::limit(Time now, const motion::Limits& limits) {
  if (std::string wrong = model_.limit(now, limits); !wrong.empty()) return wrong;
  setup_.limits = limits;
  send_(limits_line(limits));
  // The model returns within the limits from wherever it rests: a head that only turns at speeds must be driven there.
  Pose ahead;
  const bool moves = model_.state(now + setup_.latency, ahead).empty() && !ahead.settled;
  if (moves && !abilities_.position) {
    follows_ = true;
    next_follow_ = Time{};
  }
  return {};
}

std::string HelperClient::home(Time now) {
  if (!ready_ || !abilities_.home) return "the head has no way to find its reference";
  if (std::string wrong = why_idle(); !wrong.empty()) return wrong;
  const AxisCommand zero{Kind::position, 0, setup_.limits.pan.speed};
  if (std::string wrong = model_.command({now, zero, zero}); !wrong.empty()) return wrong;
  follows_ = false;
  homing_ = now;
  send_("home\n");
  return {};
}

Time HelperClient::serve(Time now) {
  // Positions that have ceased: the limits hold where the last ones leave the head.
  if (measured_ && !reckons_ && !is_fresh(now)) place(now, {pan_.correction, tilt_.correction});
  if (is_following()) follow(now);
  check_homing(now);
  return is_following() ? next_follow_ : motion::kNever;
}

std::string HelperClient::state(Time time, Pose& pose) {
  if (std::string wrong = model_.state(time, pose); !wrong.empty()) return wrong;
  if (reckons_) pose = reckoning_.at(time);
  pose.field_of_view = field_of_view();
  pose.measured = is_fresh(time);
  pose.by_speeds = reckons_;
  if (reckons_ || !measured_) return {};
  // A correction that lags behind a head that brakes leads beyond no limit, unless the head is there.
  const auto correct = [](double position, double correction, double reported,
                          const motion::AxisLimits& limits) {
    return std::clamp(position + correction, std::min({limits.from, position, reported}),
                      std::max({limits.to, position, reported}));
  };
  pose.pan.position = correct(pose.pan.position, pan_.correction, reported_.pan, setup_.limits.pan);
  pose.tilt.position = correct(pose.tilt.position, tilt_.correction, reported_.tilt, setup_.limits.tilt);
  return {};
}

}  // namespace cerberus::drivers
