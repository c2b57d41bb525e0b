// SPDX-License-Identifier: LGPL-2.1-or-later
// The reports of a head controller as data: poses for the elements upstream, states and faults for the application. A
// controller queues them while it holds its lock; they are sent later, without any lock, in the order of queueing.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include "motion/pose.h"
#include "threads/in_order.h"

namespace cerberus::control {

enum class HeadState : std::uint8_t {
  stopped,
  tracking,
  turning,
  searching,
  zeroing,
  holding,
  manual,
  limited,
  fault,
  homing,
};
struct Status {
  HeadState state = HeadState::stopped;
  std::string reason;            // for a user
  bool waits_for_order = false;  // it stands until the next order by hand, or until it is given back
  motion::Pose pose;
  motion::Time time{};
};
struct Refusal {  // the head cannot be opened: an error
  std::string why;
  bool operator==(const Refusal&) const = default;
};
struct Fault {  // the head begins to fail: a warning
  std::string what;
  bool operator==(const Fault&) const = default;
};
struct Lost {  // the chosen track is on no frame any more: a warning
  std::uint32_t id = 0;
  bool operator==(const Lost&) const = default;
};
struct UnknownZoom {  // the head has a zoom, and what it sees is not known: a warning
  bool operator==(const UnknownZoom&) const = default;
};
struct MissingGyro {  // head and base turn, and nothing measures the base: a warning
  bool operator==(const MissingGyro&) const = default;
};
// The base is asked to turn, until another one comes, for half a second at most.
struct BaseTurnRequest {
  double yaw_rate = 0;  // radians a second, to the right; 0: it is asked no more
  bool operator==(const BaseTurnRequest&) const = default;
};
using Notice = std::variant<Status, Refusal, Fault, Lost, UnknownZoom, MissingGyro, BaseTurnRequest>;

// The notifications of all threads that were not sent yet. Each entry names its head, because the sender may drive
// another one when it sends.
struct NotificationQueue {
  template <typename T>
  struct Of {
    const char* head = nullptr;  // must live as long as the queue: an interned string
    T thing;
  };
  // A newer status replaces an older one of the same head; another notice is replaced by an equal one only.
  static bool replaces(const Of<Notice>& newer, const Of<Notice>& older) {
    if (newer.head != older.head || newer.thing.index() != older.thing.index()) return false;
    if (const auto* refusal = std::get_if<Refusal>(&newer.thing))
      return *refusal == std::get<Refusal>(older.thing);
    if (const auto* fault = std::get_if<Fault>(&newer.thing)) return *fault == std::get<Fault>(older.thing);
    if (const auto* lost = std::get_if<Lost>(&newer.thing)) return *lost == std::get<Lost>(older.thing);
    return true;
  }

  threads::InOrder<Of<motion::Pose>> poses;
  threads::InOrder<Of<Notice>> notices{replaces};
};

// The reports of one call of the controller.
class DeferredNotifications {
 public:
  // head: the present head's name; it is set before the controller opens that head.
  DeferredNotifications(NotificationQueue& queue, const std::atomic<const char*>& head)
      : queue_(queue), head_(head) {}
  // With the controller's lock held.
  void add(const motion::Pose& pose) {
    queue_.poses.put({head_, pose});
    poses_ = true;
  }
  void add(Notice notice) {
    queue_.notices.put({head_, std::move(notice)});
    notices_ = true;
  }
  // Calls send_pose(head, pose), then send_notice(head, notice), for all waiting entries of the queue. Call it with no
  // lock held.
  template <typename SendPose, typename SendNotice>
  void send(SendPose send_pose, SendNotice send_notice) const {
    if (poses_) queue_.poses.deliver([&](const auto& pose) { send_pose(pose.head, pose.thing); });
    if (notices_) queue_.notices.deliver([&](const auto& notice) { send_notice(notice.head, notice.thing); });
  }

 private:
  NotificationQueue& queue_;
  const std::atomic<const char*>& head_;
  bool poses_ = false, notices_ = false;
};

}  // namespace cerberus::control
