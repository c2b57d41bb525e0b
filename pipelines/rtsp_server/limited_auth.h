// SPDX-License-Identifier: LGPL-2.1-or-later
// The log-in of RTSP clients, with a limit on wrong passwords.
#pragma once

#include <gst/rtsp-server/rtsp-server.h>

namespace cerberus::rtsp {

// A GstRTSPAuth that refuses an address with a user for a while after some wrong passwords, for longer each time
// (publish::RateLimit). A refused request is answered as one with a wrong password.
GstRTSPAuth* limited_auth_new();

}  // namespace cerberus::rtsp
