// SPDX-License-Identifier: LGPL-2.1-or-later
// What a station has to tell: poses to everybody upstream, states and warnings to the application.
#pragma once

#include <gst/base/gstbasesink.h>

#include <string>
#include <utility>
#include <variant>

#include "control/pose.h"
#include "threads/in_order.h"

namespace cerberus::plugin {

struct Status {
  const char* state = "stopped";  // one of the words of cerberus-pantilt
  std::string reason;
  control::Pose pose;
  control::Time time{};
};
struct Refusal {  // why the head cannot be opened: for an error
  std::string why;
};
struct Fault {  // new: for a warning
  std::string what;
};
struct Lost {  // the identity that was to be followed and is not there: for a warning
  guint id;
};

// What all threads have put in and nobody has sent off yet.
struct Outgoing {
  threads::InOrder<control::Pose> poses;
  threads::InOrder<std::variant<Status, Refusal, Fault, Lost>> notices;
};

// What one call puts in, with the station's lock held: so it goes out in the order in which it came to be.
class Outbox {
 public:
  explicit Outbox(Outgoing& outgoing) : outgoing_(outgoing) {}
  void tell(const control::Pose& pose) {
    outgoing_.poses.put(pose);
    poses_ = true;
  }
  template <typename Notice>
  void say(Notice notice) {
    outgoing_.notices.put(std::move(notice));
    notices_ = true;
  }
  // Sends it off for `sink`, whose head is `head` (may be nullptr). No lock held.
  void send(GstBaseSink* sink, const char* head) const;

 private:
  Outgoing& outgoing_;
  bool poses_ = false, notices_ = false;
};

// The error of a head that cannot be opened.
void refuse(GstElement* element, const char* head, const std::string& why);

}  // namespace cerberus::plugin
