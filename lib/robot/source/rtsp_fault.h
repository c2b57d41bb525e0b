// SPDX-License-Identifier: LGPL-2.1-or-later
// Why a network camera gives no picture, in words for the one who can mend it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot/settings.h"

namespace cerberus::robot {

enum class RtspProblem : std::uint8_t {
  refused,       // nothing listens at the port
  unknown_host,  // the name has no address
  unreachable,   // there is no way to the address
  no_answer,     // nothing comes back
  no_rtsp,       // what comes back is another protocol
  unauthorized,
  not_found,  // the server has no such path
  streams,    // what it has is not what the file says
  other,
};

// What an RTSP server offers: "video", "audio", "application", and the RTP encoding, as "H265".
struct RtspStream {
  std::string media, encoding;
};

// The RTP encoding that a codec of the file means.
std::string rtp_encoding(Codec codec);

// "rtsp://camera/main: the connection is refused; ...". `detail`: what GStreamer says, for `other`.
std::string describe(RtspProblem problem, const SourceSettings& source, const std::string& uri,
                     const std::vector<RtspStream>& offered, const std::string& detail);

}  // namespace cerberus::robot
