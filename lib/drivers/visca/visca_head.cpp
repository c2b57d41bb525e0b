// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/visca/visca_head.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::PanTilt;
using sensing::degrees;
using sensing::radians;

// The zoom is set again where it is off by more than this share of its range.
constexpr double kZoomSlack = 0.01;
// A zoom takes some seconds from one end to the other.
constexpr Time kZoomPatience = std::chrono::seconds(5);
// No answer at all for so long means that the camera is gone.
constexpr Time kSilence = std::chrono::milliseconds(800);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Radians a second of a signed step.
double speed_of(int step, const std::vector<double>& table) {
  if (step == 0) return 0;
  const auto n = std::min<std::size_t>(static_cast<std::size_t>(std::abs(step)), table.size() - 1);
  return radians(step > 0 ? table[n] : -table[n]);
}

// The step nearest to the commanded speed, of those that are no faster than the limit.
int step_for(const AxisCommand& command, const std::vector<double>& table, double fastest) {
  if (command.kind != AxisCommand::Kind::velocity || !std::isfinite(command.value)) return 0;
  int step = visca::speed_step(table, degrees(command.value));
  while (std::abs(step) > 1 && std::abs(speed_of(step, table)) > fastest + 1e-9) step += step > 0 ? -1 : 1;
  return step;
}

}  // namespace

void ViscaHead::reset_sequence() {
  sequence_ = 0;
  stream_.write(visca::reset_sequence());
}

void ViscaHead::on_connected(Time now) {
  cutter_ = {};
  unanswered_orders_.clear();
  sent_pan_ = sent_tilt_ = 0;
  asked_ = now;
  unanswered_.reset();
  versions_asked_ = 0;
  last_pose_.reset();
  homing_.reset();
  strange_numbers_ = 0;
  if (has_header()) {
    reset_sequence();
  } else if (!stream_.datagrams() && options_.device.starts_with("serial:")) {
    send(visca::address_set());
    send(visca::interface_clear());
  }
  stop(now);  // it stands until the next move
  zoom_unanswered_ = 0;
  zoom_order_.reset();
  if (options_.zoom >= 0) zoom_order_ = options_.zoom;
}

std::string ViscaHead::check() const {
  if (options_.address < 1 || options_.address > 7) return "a VISCA address is 1 to 7";
  if (options_.zoom > visca::kMostZoom)
    return "the zoom of a VISCA camera is kept at 0 to " + text::significant(visca::kMostZoom, 3).string() +
           " (lock-zoom), not at " + text::significant(options_.zoom, 4).string();
  return check_device();
}

std::string ViscaHead::open(const HeadSetup& setup, Time now) {
  if (std::string wrong = check(); !wrong.empty()) return wrong;
  if (std::string wrong = connect(setup, now); !wrong.empty()) return wrong;
  if (!options_.feedback) return {};
  send(visca::position_inquiry(options_.address));
  using Clock = std::chrono::steady_clock;
  const auto last = Clock::now() + kFirstAnswerTime;
  auto end = last;
  while (!reports_ && stream_.is_open() && Clock::now() < end) {
    pollfd wait{stream_.fd(), POLLIN, 0};
    const bool answers = ::poll(&wait, 1, 10) > 0;
    read(now);
    if (answers) end = std::min(last, Clock::now() + kAnswerTime);
  }
  return check_answers();
}

std::string ViscaHead::check_answers() const {
  if (has_answered_) return {};
  const bool serial = options_.device.starts_with("serial:");
  const std::string check = serial ? "baud=" + std::to_string(options_.baud) + " and address="
                                   : "its port, and whether it needs no-header";
  if (received_ >= kLeastReply && !has_visca_)
    return "what the " + title() + " sends is no VISCA: check " + check;
  if (options_.warn)
    options_.warn("the " + title() +
                  " answers nothing, and is driven all the same. If it does not move, check its power "
                  "and cable, " +
                  check);
  return {};
}

HeadAbilities ViscaHead::abilities() const {
  return {.position = false,
          .velocity = true,
          .feedback = reports_,
          .rate = kRate,
          .home = !reports_,
          .zoom = options_.feedback && options_.zoom < 0};
}

void ViscaHead::send(const visca::Message& message) {
  if (has_header())
    stream_.write(visca::with_header(message, options_.sequence.value_or(sequence_++)));
  else
    stream_.write(message);
}

void ViscaHead::send_order(Order order, const visca::Message& message, Time now) {
  if (unanswered_orders_.size() == kMostOrders) unanswered_orders_.erase(unanswered_orders_.begin());
  unanswered_orders_.push_back({order, sequence_, now});
  send(message);
  sent_ = now;
  // A camera that tells its version alone is silent while it moves.
  if (!unanswered_ && (reports_ || acknowledges_)) unanswered_ = now;
}

void ViscaHead::move(const AxisCommand& pan, const AxisCommand& tilt, Time now) {
  if (homing_) stop(now);
  pan_ = step_for(pan, options_.speeds.pan, limits_.pan.speed);
  tilt_ = step_for(tilt, options_.speeds.tilt, limits_.tilt.speed);
  if (pan_ != 0 || tilt_ != 0) stopping_ = false;
  send_drive(now);
}

void ViscaHead::limit(const motion::Limits& limits, Time now) {
  limits_.pan.from = limits.pan.from;
  limits_.pan.to = limits.pan.to;
  limits_.tilt.from = limits.tilt.from;
  limits_.tilt.to = limits.tilt.to;
  send_drive(now);
}

void ViscaHead::stop(Time now) noexcept {
  pan_ = tilt_ = sent_pan_ = sent_tilt_ = 0;
  homing_.reset();
  if (options_.zoom < 0) zoom_order_.reset();
  stopping_ = moved_ = true;
  stops_ = 1;
  send_order(Order::stop, visca::stop(options_.address), now);
  set_stopped(now);
}

void ViscaHead::home(Time now) {
  pan_ = tilt_ = sent_pan_ = sent_tilt_ = 0;
  stopping_ = homed_ = false;
  moved_ = true;
  homing_ = 0;
  send_order(Order::home, visca::home(options_.address), now);
}

std::optional<HomedLine> ViscaHead::take_homed(Time now) {
  if (!std::exchange(homed_, false)) return std::nullopt;
  set_reference({}, now);
  return HomedLine{};
}

// What is in force at the camera is what it has acknowledged: a command without an answer is sent again, also to a
// camera that never answers.
void ViscaHead::send_drive(Time now) {
  if (stopping_ || homing_ || !stream_.is_open()) return;
  const PanTilt wanted{speed_of(pan_, options_.speeds.pan), speed_of(tilt_, options_.speeds.tilt)};
  const PanTilt measured =
      last_pose_ ? PanTilt{last_pose_->pan.position, last_pose_->tilt.position} : PanTilt{kNan, kNan};
  const PanTilt allowed = confined(wanted, measured, now);
  const int pan = allowed.pan == 0 ? 0 : pan_, tilt = allowed.tilt == 0 ? 0 : tilt_;
  if (pan == 0 && tilt == 0) {
    const int wanted_pan = pan_, wanted_tilt = tilt_;
    if (moved_) stop(now);
    pan_ = wanted_pan;
    tilt_ = wanted_tilt;
    return;
  }
  const bool unanswered = waiting() && now - sent_ >= kAnswerTime;
  // While a camera without positions turns, its acknowledgement of the same speed is all that shows that it is there.
  const bool same = pan == sent_pan_ && tilt == sent_tilt_;
  const bool again = acknowledges_ && !reports_ && now - sent_ >= kSameAgain;
  if (same && !unanswered && !again) return;
  if (acknowledges_ && waiting() && !unanswered && (same || !repeated_)) return;
  if (now - sent_ < Time(static_cast<Time::rep>(1e9 / kRate))) return;
  send_order(Order::move, visca::drive(options_.address, pan, tilt), now);
  sent_pan_ = pan;
  sent_tilt_ = tilt;
  repeated_ = same;
  moved_ = true;
  set_speeds(allowed, now);
}

void ViscaHead::zoom(double position, Time) {
  zoom_order_ = position;
}

// An answer without a number must not be taken as a stop's. One order of the zoom at a time, so that moves wait for few.
void ViscaHead::send_zoom(Time now) {
  if (!zoom_order_ || stopping_ || !stream_.is_open()) return;
  if (std::ranges::find(unanswered_orders_, Order::zoom, &Sent::order) != unanswered_orders_.end()) return;
  zoom_sent_ = now;
  const double position = *std::exchange(zoom_order_, std::nullopt);
  send_order(Order::zoom, visca::zoom(options_.address, position), now);
}

void ViscaHead::on_zoom(double position, Time now) {
  zoom_ = position;
  zoom_unanswered_ = 0;
  if (options_.zoom < 0 || stopping_ || now - zoom_sent_ < kZoomPatience) return;
  if (std::abs(position - options_.zoom) <= kZoomSlack) return;
  zoom_order_ = options_.zoom;
  send_zoom(now);
}

// While no order waits for its answer: a camera without a zoom refuses, and the refusal must not count for an order.
void ViscaHead::ask_zoom(Time now) {
  const Time period = zoom_unanswered_ < kZoomInquiries ? kZoomPeriod : kZoomSeldom;
  if (!options_.feedback || waiting() || now - zoom_asked_ < period) return;
  zoom_asked_ = now;
  ++zoom_unanswered_;
  send(visca::zoom_inquiry(options_.address));
}

// A camera without positions is silent at rest: whether it is there is known by what all cameras should answer.
void ViscaHead::ask_version(Time now) {
  const bool ask = tells_version_ || versions_asked_ < kVersionInquiries;
  if (reports_ || !ask || moved_ || waiting() || now - version_asked_ < kInquiryPeriod) return;
  version_asked_ = now;
  ++versions_asked_;
  send(visca::version_inquiry(options_.address));
  if (tells_version_ && !unanswered_) unanswered_ = now;
}

// Says once that a camera does not count, by whose numbers no answer finds its command.
void ViscaHead::count_number(int strange) {
  strange_numbers_ = std::max(0, strange_numbers_ + strange);
  if (strange_numbers_ < kMostStrangeNumbers || std::exchange(warned_of_numbers_, true) || !options_.warn)
    return;
  options_.warn("the " + title() +
                " refuses the sequence numbers of its commands, or answers with others: give sequence=0");
}

// The order that an answer belongs to; nothing: to none that is still waited for.
std::optional<ViscaHead::Sent> ViscaHead::answered(std::optional<std::uint32_t> number) {
  auto at = unanswered_orders_.begin();
  if (number) {
    at = std::ranges::find(unanswered_orders_, *number, &Sent::sequence);
    count_number(at == unanswered_orders_.end() ? 1 : -1);
  }
  if (at == unanswered_orders_.end()) return std::nullopt;
  const Sent sent = *at;
  unanswered_orders_.erase(unanswered_orders_.begin(), at + 1);  // earlier answers are lost
  return sent;
}

void ViscaHead::handle(const visca::Reply& reply, std::optional<std::uint32_t> number, Time now) {
  using Kind = visca::Reply::Kind;
  if (reply.kind == Kind::other || reply.address != options_.address) return;
  has_answered_ = true;
  unanswered_.reset();
  if (reply.kind == Kind::position) {
    reports_ = true;
    asked_ = now;
    PoseLine pose{{radians(reply.pan), 0, 0}, {radians(reply.tilt), 0, 0}, 0};
    pose_ = last_pose_ = pose;
    pose_time_ = now;
    return;
  }
  if (reply.kind == Kind::zoom) return on_zoom(reply.zoom, now);
  if (reply.kind == Kind::version) {
    tells_version_ = true;
    return;
  }
  if (reply.kind == Kind::completion) {  // the end of what was acknowledged before
    const bool home = homing_ && reply.socket == *homing_;
    if (!home) return;
    homing_.reset();
    moved_ = false;
    homed_ = true;
    return;
  }
  const std::optional<Sent> sent = answered(number);
  if (reply.kind == Kind::ack) {
    acknowledges_ = true;
    if (!sent) return;
    if (sent->order == Order::stop && stopping_) {
      stopping_ = moved_ = false;
      // Without numbers it may be the answer to a later one, if it comes late.
      on_stopped(number || now - sent->time <= kAnswerTime ? sent->time : sent_);
    }
    if (sent->order == Order::home && homing_) homing_ = reply.socket;
    return;
  }
  // Refused: what was sent last is not in force, and is sent again; a stop by tick().
  if (!sent) return;
  if (sent->order == Order::home) homing_.reset();
  if (sent->order == Order::zoom) return;
  if (!stopping_) sent_pan_ = sent_tilt_ = INT32_MIN;
}

void ViscaHead::read(Time now) {
  std::vector<std::uint8_t> bytes;
  while (stream_.read(bytes)) {
    visca::Datagram datagram{.payload = bytes};
    if (stream_.datagrams()) datagram = visca::parse_datagram(bytes);
    if (has_header() && visca::is_sequence_error(datagram)) {
      count_number(kRefusedNumber);
      reset_sequence();
      unanswered_orders_.clear();
      sent_pan_ = sent_tilt_ = INT32_MIN;  // what was sent meanwhile is not in force
      if (stopping_) sent_ = now - kStopAgain;
    } else if (!datagram.control) {
      cutter_.append(datagram.payload);
    }
    const auto number = numbered() && datagram.header ? std::optional(datagram.sequence) : std::nullopt;
    received_ += datagram.payload.size();
    has_answered_ = has_answered_ || datagram.control;
    bytes.clear();
    while (const auto message = cutter_.take()) {
      has_visca_ = has_visca_ || (message->size() >= 3 && message->front() >= 0x80);
      handle(visca::parse_reply(*message), number, now);
    }
  }
  // An answer that was lost belongs to no later command.
  std::erase_if(unanswered_orders_, [now](const Sent& sent) { return now - sent.time > kForgotten; });
}

void ViscaHead::repeat_stop(Time now) {
  if (!stopping_ || now - sent_ < kStopAgain) return;
  stopping_ = acknowledges_ || ++stops_ <= kStopsWithoutAnswer;
  if (stopping_) return send_order(Order::stop, visca::stop(options_.address), now);
  moved_ = false;
  unanswered_orders_.clear();
}

Time ViscaHead::tick(Time now) {
  read(now);
  if (Time next; !is_there(now, next)) return next;
  set_silent((reports_ || acknowledges_ || tells_version_) && unanswered_ && now - *unanswered_ > kSilence,
             now);
  repeat_stop(now);
  send_drive(now);
  if (options_.feedback && now - asked_ >= kInquiryPeriod) {
    asked_ = now;
    send(visca::position_inquiry(options_.address));
    if (reports_ && !unanswered_) unanswered_ = now;
  }
  send_zoom(now);
  ask_zoom(now);
  ask_version(now);
  return now + (stopping_ || pan_ != sent_pan_ || tilt_ != sent_tilt_ ? Time(std::chrono::milliseconds(10))
                                                                      : Time(kInquiryPeriod) / 2);
}

std::optional<PoseLine> ViscaHead::take_pose(Time now) {
  std::optional<PoseLine> pose = std::exchange(pose_, std::nullopt);
  if (pose) pose->age = motion::seconds(now - pose_time_);
  return pose;
}

}  // namespace cerberus::drivers
