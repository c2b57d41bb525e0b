// SPDX-License-Identifier: LGPL-2.1-or-later
#include "deferred_notifications.hpp"

#include <cerberus/cerberus.h>

#include <type_traits>

#include "cerberus/private/messages.hpp"
#include "fusion/chosen.h"
#include "shared/pose_feed.hpp"
#include "shared/times.hpp"

namespace cerberus::plugin {

namespace {

CerberusPose told(const motion::Pose& pose, const char* head) {
  CerberusPose out = to_c(pose);
  if (head) out.head = head;
  return out;
}

CerberusPantiltState state_of(const char* nick) {
  static gpointer const states = g_type_class_ref(CERBERUS_TYPE_PANTILT_STATE);
  const GEnumValue* value = g_enum_get_value_by_nick(G_ENUM_CLASS(states), nick);
  return static_cast<CerberusPantiltState>(value->value);
}

// Posts each kind of notice.
struct Posting {
  GstBaseSink* sink;
  const char* head;

  void operator()(const Status& status) const {
    CerberusPantilt pantilt;
    cerberus_pantilt_init(&pantilt);
    pantilt.state = state_of(status.state);
    pantilt.pose = told(status.pose, head);
    std::string reason = status.reason;
    pantilt.reason = reason.data();
    CerberusStamp stamp;
    cerberus_stamp_init(&stamp);
    stamp.running_time = clock_time(status.time);
    gst_element_post_message(GST_ELEMENT(sink),
                             cerberus_message_new_pantilt(GST_OBJECT(sink), &stamp, &pantilt));
  }
  void operator()(const Refusal& refusal) const { refuse(GST_ELEMENT(sink), head, refusal.why); }
  void operator()(const Fault& fault) const {
    CERBERUS_ELEMENT_WARNING(sink, RESOURCE, WRITE, ("The head \"%s\" fails: %s", head, fault.what.c_str()),
                             (nullptr));
  }
  void operator()(const Lost& lost) const {
    CERBERUS_ELEMENT_WARNING(
        sink, RESOURCE, NOT_FOUND,
        ("Track %u, which was to be followed, is on no frame for %d s: the usual choice goes on.", lost.id,
         static_cast<int>(fusion::Chosen::kPatience / std::chrono::seconds(1))),
        ("head %s", head));
  }
};

}  // namespace

void refuse(GstElement* element, const char* head, const std::string& why) {
  CERBERUS_ELEMENT_ERROR(element, RESOURCE, OPEN_READ_WRITE,
                         ("The head \"%s\" cannot be opened: %s.", head, why.c_str()), (nullptr));
}

bool Outgoing::replaces(const Of<Notice>& newer, const Of<Notice>& older) {
  if (newer.head != older.head || newer.thing.index() != older.thing.index()) return false;
  return std::visit(
      [&older]<typename Kind>(const Kind& said) {
        if constexpr (std::is_same_v<Kind, Status>)
          return true;
        else
          return said == std::get<Kind>(older.thing);
      },
      newer.thing);
}

void DeferredNotifications::send(GstBaseSink* sink) const {
  if (poses_)
    outgoing_.poses.tell([&](const auto& pose) {
      const CerberusPose event = told(pose.thing, pose.head);
      gst_pad_push_event(GST_BASE_SINK_PAD(sink), cerberus_event_new_pose(&event));
    });
  if (notices_)
    outgoing_.notices.tell([&](const auto& notice) { std::visit(Posting{sink, notice.head}, notice.thing); });
}

}  // namespace cerberus::plugin
