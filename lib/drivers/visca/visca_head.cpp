// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/visca/visca_head.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using sensing::degrees;
using sensing::radians;

// No answer at all for so long means that the camera is gone.
constexpr Time kSilence = std::chrono::milliseconds(800);

}  // namespace

std::string ViscaHead::connect(Time now) {
  tried_ = now;
  if (std::string wrong = stream_.open(options_.device, options_.baud); !wrong.empty()) return wrong;
  cutter_ = {};
  waiting_ = false;
  sent_pan_ = sent_tilt_ = 0;
  asked_ = now;
  unanswered_.reset();
  connected_ = true;
  last_pose_.reset();
  if (stream_.datagrams() && options_.header) {
    sequence_ = 0;
    stream_.write(visca::reset_sequence());
  } else if (!stream_.datagrams() && options_.device.starts_with("serial:")) {
    send(visca::address_set());
    send(visca::interface_clear());
  }
  return {};
}

std::string ViscaHead::open(const HeadSetup& setup, Time now) {
  limits_ = setup.limits;
  if (options_.address < 1 || options_.address > 7) return "a VISCA address is 1 to 7";
  if (std::string wrong = connect(now); !wrong.empty()) return wrong;
  stop(now);
  if (!options_.feedback) return {};
  send(visca::position_inquiry(options_.address));
  const auto begin = std::chrono::steady_clock::now();
  while (!reports_ && stream_.is_open() && std::chrono::steady_clock::now() - begin < kAnswerTime) {
    pollfd wait{stream_.fd(), POLLIN, 0};
    ::poll(&wait, 1, 10);
    read(now);
  }
  return {};
}

HeadAbilities ViscaHead::abilities() const {
  return {.position = false, .velocity = true, .feedback = reports_, .rate = kRate};
}

void ViscaHead::send(const visca::Message& message) {
  if (stream_.datagrams() && options_.header)
    stream_.write(visca::with_header(message, sequence_++));
  else
    stream_.write(message);
}

// True for a head that stands at its stop, or beyond it, and would go on outwards.
bool ViscaHead::beyond(double position, int step, const motion::AxisLimits& axis) const {
  return step > 0 ? position >= axis.to : step < 0 && position <= axis.from;
}

void ViscaHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  const auto step = [](const AxisCommand& command, const std::vector<double>& table) {
    return command.kind == AxisCommand::Kind::velocity ? visca::speed_step(table, degrees(command.value)) : 0;
  };
  pan_ = step(pan, options_.speeds.pan);
  tilt_ = step(tilt, options_.speeds.tilt);
  if (pan_ != 0 || tilt_ != 0) stopping_ = false;
  send_drive(now);
}

void ViscaHead::limit(const motion::Limits& limits, Time now) {
  limits_ = limits;
  send_drive(now);
}

void ViscaHead::stop(Time now) noexcept {
  pan_ = tilt_ = sent_pan_ = sent_tilt_ = 0;
  answers_owed_ = waiting_ ? 2 : 1;
  stopping_ = true;
  stops_ = 1;
  send(visca::stop(options_.address));
  moved_ = waiting_ = true;
  sent_ = now;
  if (!unanswered_) unanswered_ = now;
}

// What is in force at the camera is what it has acknowledged: a command without an answer is sent again, also to a camera
// that never answers.
void ViscaHead::send_drive(Time now) {
  if (stopping_ || !stream_.is_open()) return;
  int pan = pan_, tilt = tilt_;
  if (last_pose_ && beyond(last_pose_->pan.position, pan, limits_.pan)) pan = 0;
  if (last_pose_ && beyond(last_pose_->tilt.position, tilt, limits_.tilt)) tilt = 0;
  if (pan == 0 && tilt == 0) {
    const int wanted_pan = pan_, wanted_tilt = tilt_;
    if (moved_) stop(now);
    pan_ = wanted_pan;
    tilt_ = wanted_tilt;
    return;
  }
  const bool unanswered = waiting_ && now - sent_ >= kAnswerTime;
  if (pan == sent_pan_ && tilt == sent_tilt_ && !unanswered) return;
  if (waiting_ && !unanswered) return;
  if (now - sent_ < Time(static_cast<Time::rep>(1e9 / kRate))) return;
  send(visca::drive(options_.address, pan, tilt));
  sent_pan_ = pan;
  sent_tilt_ = tilt;
  moved_ = waiting_ = true;
  sent_ = now;
  if (!unanswered_) unanswered_ = now;
}

void ViscaHead::handle(const visca::Reply& reply, Time now) {
  using Kind = visca::Reply::Kind;
  if (reply.kind == Kind::other || reply.address != options_.address) return;
  unanswered_.reset();
  if (reply.kind == Kind::position) {
    reports_ = true;
    asked_ = now;
    PoseLine pose{{radians(reply.pan), 0, 0}, {radians(reply.tilt), 0, 0}, 0};
    pose_ = last_pose_ = pose;
    pose_time_ = now;
    return;
  }
  if (reply.kind == Kind::completion) return;  // the end of what was acknowledged before
  waiting_ = false;
  if (reply.kind == Kind::ack) {
    acknowledges_ = true;
    if (stopping_ && --answers_owed_ <= 0) stopping_ = moved_ = false;
    return;
  }
  // Refused: what was sent last is not in force, and is sent again; a stop by tick().
  if (!stopping_) sent_pan_ = sent_tilt_ = INT32_MIN;
}

void ViscaHead::read(Time now) {
  std::vector<std::uint8_t> bytes;
  while (stream_.read(bytes)) {
    cutter_.append(stream_.datagrams() ? visca::without_header(bytes) : std::span<const std::uint8_t>(bytes));
    bytes.clear();
    while (const auto message = cutter_.take()) handle(visca::parse_reply(*message), now);
  }
}

Time ViscaHead::tick(Time now) {
  read(now);
  if (!stream_.is_open()) {
    if (std::exchange(connected_, false)) tried_ = now;  // reported before it is tried again
    fault_ = "the VISCA camera at " + options_.device + " is gone";
    if (now - tried_ < kReconnect) return tried_ + kReconnect;
    if (!connect(now).empty()) return tried_ + kReconnect;
    stop(now);  // it stands until the next move
  }
  const bool silent = (reports_ || acknowledges_) && unanswered_ && now - *unanswered_ > kSilence;
  if (silent && fault_.empty()) {
    fault_ = "the VISCA camera at " + options_.device + " does not answer";
    stop(now);
  }
  if (!silent) fault_.clear();
  if (stopping_ && now - sent_ >= kStopAgain) {
    stopping_ = acknowledges_ || ++stops_ <= kStopsWithoutAnswer;
    if (!stopping_) moved_ = waiting_ = false;
    if (stopping_) {
      answers_owed_ = 1;
      send(visca::stop(options_.address));
      sent_ = now;
    }
  }
  send_drive(now);
  if (options_.feedback && now - asked_ >= kInquiryPeriod) {
    asked_ = now;
    send(visca::position_inquiry(options_.address));
    if (reports_ && !unanswered_) unanswered_ = now;
  }
  return now + (stopping_ || pan_ != sent_pan_ || tilt_ != sent_tilt_ ? Time(std::chrono::milliseconds(10))
                                                                      : Time(kInquiryPeriod) / 2);
}

std::optional<PoseLine> ViscaHead::take_pose(Time now) {
  std::optional<PoseLine> pose = std::exchange(pose_, std::nullopt);
  if (pose) pose->age = motion::seconds(now - pose_time_);
  return pose;
}

void ViscaHead::watch(std::vector<pollfd>& fds) const {
  if (stream_.is_open()) fds.push_back({stream_.fd(), POLLIN, 0});
}

}  // namespace cerberus::drivers
