// SPDX-License-Identifier: LGPL-2.1-or-later
#include "outbox.hpp"

#include <cerberus/cerberus.h>

#include "fusion/chosen.h"
#include "times.hpp"

namespace cerberus::plugin {

namespace {

CerberusPose to_c(const control::Pose& pose, const char* head) {
  using sensing::degrees;
  CerberusPose out;
  cerberus_pose_init(&out);
  if (head) out.head = head;
  out.pan = degrees(pose.pan.position);
  out.tilt = degrees(pose.tilt.position);
  out.pan_speed = degrees(pose.pan.speed);
  out.tilt_speed = degrees(pose.tilt.speed);
  out.pan_acceleration = degrees(pose.pan.acceleration);
  out.tilt_acceleration = degrees(pose.tilt.acceleration);
  out.valid_from = clock_time(pose.from);
  out.valid_until = pose.until == control::kNever ? GST_CLOCK_TIME_NONE : clock_time(pose.until);
  out.source = pose.measured ? CERBERUS_POSE_MEASURED : CERBERUS_POSE_COMMANDED;
  out.moving = pose.moving();
  out.settled = pose.settled;
  return out;
}

}  // namespace

void refuse(GstElement* element, const char* head, const std::string& why) {
  GST_ELEMENT_ERROR(element, RESOURCE, OPEN_READ_WRITE,
                    ("The head \"%s\" cannot be opened: %s.", head, why.c_str()), (nullptr));
}

void send(const Outbox& out, GstBaseSink* sink, const char* head) {
  for (const control::Pose& pose : out.poses) {
    const CerberusPose event = to_c(pose, head);
    gst_pad_push_event(GST_BASE_SINK_PAD(sink), cerberus_event_new_pose(&event));
  }
  for (const Status& status : out.statuses) {
    const CerberusPose pose = to_c(status.pose, head);
    gst_element_post_message(GST_ELEMENT(sink),
                             cerberus_message_new_pantilt(GST_OBJECT(sink), clock_time(status.time),
                                                          status.state, status.reason.c_str(), &pose));
  }
  if (!out.refusal.empty()) refuse(GST_ELEMENT(sink), head, out.refusal);
  if (!out.fault.empty())
    GST_ELEMENT_WARNING(sink, RESOURCE, WRITE, ("The head \"%s\" fails: %s", head, out.fault.c_str()),
                        (nullptr));
  if (out.lost != 0)
    GST_ELEMENT_WARNING(
        sink, RESOURCE, NOT_FOUND,
        ("Track %u, which was to be followed, is on no frame for %d s: the usual choice goes on.", out.lost,
         static_cast<int>(fusion::Chosen::kPatience / std::chrono::seconds(1))),
        ("head %s", head));
}

}  // namespace cerberus::plugin
