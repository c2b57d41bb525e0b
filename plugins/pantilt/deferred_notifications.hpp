// SPDX-License-Identifier: LGPL-2.1-or-later
// What a station has to tell: poses to everybody upstream, states and warnings to the application.
#pragma once

#include <gst/base/gstbasesink.h>

#include <atomic>
#include <string>
#include <utility>
#include <variant>

#include "motion/pose.h"
#include "threads/in_order.h"

namespace cerberus::plugin {

struct Status {
  const char* state = "stopped";  // one of the words of cerberus-pantilt
  std::string reason;
  motion::Pose pose;
  motion::Time time{};
};
struct Refusal {  // why the head cannot be opened: for an error
  std::string why;
  bool operator==(const Refusal&) const = default;
};
struct Fault {  // new: for a warning
  std::string what;
  bool operator==(const Fault&) const = default;
};
struct Lost {  // the identity that was to be followed and is not there: for a warning
  guint id;
  bool operator==(const Lost&) const = default;
};

using Notice = std::variant<Status, Refusal, Fault, Lost>;

// What all threads have put in and nobody has sent off yet; of which head (interned; may be nullptr), for whoever sends
// it may have begun when the sink drove another one.
struct Outgoing {
  template <typename T>
  struct Of {
    const char* head = nullptr;
    T thing;
  };
  // A newer state says all that an older one does; a warning is replaced by the same one only.
  static bool replaces(const Of<Notice>& newer, const Of<Notice>& older);

  threads::InOrder<Of<motion::Pose>> poses;
  threads::InOrder<Of<Notice>> notices{replaces};
};

// What one call puts in, with the station's lock held: so it goes out in the order in which it came to be.
class DeferredNotifications {
 public:
  // head: whose what is put in is at that moment; it is set before the station has that head.
  DeferredNotifications(Outgoing& outgoing, const std::atomic<const gchar*>& head)
      : outgoing_(outgoing), head_(head) {}
  void tell(const motion::Pose& pose) {
    outgoing_.poses.put({head_, pose});
    poses_ = true;
  }
  void say(Notice notice) {
    outgoing_.notices.put({head_, std::move(notice)});
    notices_ = true;
  }
  // Sends it off for `sink`. No lock held.
  void send(GstBaseSink* sink) const;

 private:
  Outgoing& outgoing_;
  const std::atomic<const gchar*>& head_;
  bool poses_ = false, notices_ = false;
};

// The error of a head that cannot be opened.
void refuse(GstElement* element, const char* head, const std::string& why);

}  // namespace cerberus::plugin
