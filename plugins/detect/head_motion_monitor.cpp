// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_motion_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cerberus/private/messages.hpp"
#include "shared/camera_mount.hpp"
#include "shared/poses.hpp"

namespace cerberus::plugin {

namespace {

using control::SlipFault;
using motion::PanTilt;
using motion::Time;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// Numbers that are none, or another head's: there is a head, and where it looks is not known.
constexpr PanTilt kStrange{kUnknown, kUnknown};

struct Words {
  const char* fault;
  std::string text;
};

Words in_words(const control::SlipFinding& finding, const char* head, const char* axis) {
  const std::string name = std::string("The head \"") + head + "\" ";
  const std::string told = std::to_string(std::lround(degrees(finding.travel))) + " degrees of " + axis;
  switch (finding.fault) {
    case SlipFault::slips:
      return {"slips", name + "does not turn: it was told " + told +
                           ", and the picture did not move. Check its power and cables, and what slips or "
                           "blocks (belt, gear, grub screw)."};
    case SlipFault::reversed:
      return {"reversed", name + "turns the wrong way: it was told " + told +
                              ", and the picture shows the opposite. Swap the motor's wires or the driver's "
                              "direction; a mirrored picture looks the same."};
    case SlipFault::scale:
    case SlipFault::none:
      break;
  }
  return {"scale",
          name + "turns by another angle than it is told: of " + told + " the picture shows " +
              std::to_string(std::lround(100 * finding.gain)) +
              " %. Check horizontal-fov (of the whole frame's width) and the driver's steps a turn."};
}

void warn(GstElement* element, const control::SlipFinding& finding, const char* head, const char* axis) {
  const Words words = in_words(finding, head, axis);
  const double travel = degrees(finding.travel);
  CERBERUS_ELEMENT_MESSAGE(element, WARNING, RESOURCE, FAILED, (words.text), (nullptr),
                           gst_structure_new("details", "head", G_TYPE_STRING, head, "axis", G_TYPE_STRING,
                                             axis, "fault", G_TYPE_STRING, words.fault, "gain", G_TYPE_DOUBLE,
                                             finding.gain, "travel", G_TYPE_DOUBLE, travel, nullptr));
}

}  // namespace

void HeadMotionMonitor::forget() {
  comparison_.reset();
  pose_.reset();
  pose_thread_.forget();
  const std::lock_guard guard(lock_);
  poses_.clear();
  told_base_.clear();
}

void HeadMotionMonitor::hear(GstEvent* event, const std::string& head) {
  g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(event);
  const bool counts = pose && (head.empty() || head == pose->head);
  if (counts) pose_thread_.on_pose(pose->head);
  const std::lock_guard guard(lock_);
  if (counts)
    poses_.insert(time_of(pose->valid_from), *pose);
  else if (g_autoptr(CerberusBase) base = cerberus_event_parse_base(event);
           base && std::isfinite(base->yaw_rate))
    told_base_.add(time_of(base->valid_from), base->yaw_rate);
}

control::HeadComparison::Head HeadMotionMonitor::head_of(GstElement* element, Frame& frame,
                                                         const std::string& head) {
  if (const CerberusPose* carried = cerberus_buffer_peek_pose(frame.buffer)) {
    if (!head.empty() && head != carried->head) return {.look = kStrange, .name = carried->head};
    return {frame.look ? PanTilt{frame.look->pan, frame.look->tilt} : kStrange, carried->head};
  }
  if (!GST_CLOCK_TIME_IS_VALID(frame.running_time) || !pose_thread_.poses_count(element)) return {};
  const Time time = time_of(frame.running_time);
  const std::lock_guard guard(lock_);
  const CerberusPose* heard = poses_.at(time);
  if (!heard) return {};
  // The same piece from the time of the frame on; of one that has expired, its end.
  CerberusPose pose = to_c(from_c(*heard).at(time));
  pose.head = heard->head;
  cerberus_buffer_set_pose(frame.buffer, &pose);
  poses_.forget_before(time);
  return {look_of(pose, frame.running_time).value_or(kStrange), pose.head, true};
}

std::optional<vision::Transform> HeadMotionMonitor::look(GstElement* element, Frame& frame,
                                                         const std::string& head, double field_of_view) {
  const control::HeadComparison::Head now = head_of(element, frame, head);
  frame.read_pose();
  const auto motion = comparison_.expect(now, frame.lens(field_of_view));
  pose_.reset();
  if (const CerberusPose* pose = cerberus_buffer_peek_pose(frame.buffer)) {
    pose_ = *pose;
    holds_ = cerberus_pose_evaluate(pose, frame.running_time, &pose_->pan, &pose_->tilt);
    pose_->pan_speed = pose_->tilt_speed = pose_->pan_acceleration = pose_->tilt_acceleration = 0;
  }
  return motion;
}

// Priority: meta on the frame, then upstream event, then image estimate.
void HeadMotionMonitor::attach_base(Frame& frame, double measured) {
  if (cerberus_buffer_peek_base(frame.buffer)) return;
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = degrees(measured);
  if (GST_CLOCK_TIME_IS_VALID(frame.running_time)) {
    const Time time = time_of(frame.running_time);
    const std::lock_guard guard(lock_);
    if (const auto told = told_base_.at(time)) {
      base.yaw_rate = *told;
      base.source = CERBERUS_BASE_REPORTED;
    }
    told_base_.forget_before(time);
  }
  if (std::isfinite(base.yaw_rate)) cerberus_buffer_set_base(frame.buffer, &base);
}

void HeadMotionMonitor::compare(GstElement* element, Frame& frame, double field_of_view,
                                const vision::Transform& motion, double confidence) {
  const vision::Lens lens = frame.lens(field_of_view);
  const Time time = known_time(frame.running_time).value_or(Time::zero());
  attach_base(
      frame, comparison_.base_rate({frame.size, motion, confidence, time, frame.seconds, frame.fresh}, lens));
  const CerberusBase* base = cerberus_buffer_peek_base(frame.buffer);
  const double reported = base && base->source == CERBERUS_BASE_REPORTED ? radians(base->yaw_rate) : 0;
  const auto [pan, tilt] = comparison_.faults(frame.seconds, reported);
  const char* head = comparison_.head().name;
  if (pan) warn(element, *pan, head, "pan");
  if (tilt) warn(element, *tilt, head, "tilt");
}

void HeadMotionMonitor::repeat(Frame& frame) {
  if (pose_ && !cerberus_buffer_peek_pose(frame.buffer)) {
    CerberusPose pose = *pose_;
    if (holds_ && GST_CLOCK_TIME_IS_VALID(frame.running_time))
      pose.valid_from = pose.valid_until = frame.running_time;
    cerberus_buffer_set_pose(frame.buffer, &pose);
  }
  attach_base(frame, comparison_.base_rate(known_time(frame.running_time).value_or(Time::zero())));
}

}  // namespace cerberus::plugin
