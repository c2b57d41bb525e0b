// SPDX-License-Identifier: LGPL-2.1-or-later
// What a station has to tell: poses to everybody upstream, states and warnings to the application.
#pragma once

#include <gst/base/gstbasesink.h>

#include <string>
#include <vector>

#include "control/pose.h"

namespace cerberus::plugin {

struct Status {
  const char* state = "stopped";  // one of the words of cerberus-pantilt
  std::string reason;
  control::Pose pose;
  control::Time time{};
};

struct Outbox {
  std::vector<control::Pose> poses;
  std::vector<Status> statuses;
  std::string refusal;  // why the head cannot be opened: for an error
  std::string fault;    // new: for a warning
  guint lost = 0;       // the identity that was to be followed and is not there: for a warning
};

// The error of a head that cannot be opened.
void refuse(GstElement* element, const char* head, const std::string& why);
// Sends it off for `sink`, whose head is `head` (may be nullptr). No lock held.
void send(const Outbox& out, GstBaseSink* sink, const char* head);

}  // namespace cerberus::plugin
