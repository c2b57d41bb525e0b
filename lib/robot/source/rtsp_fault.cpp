// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/source/rtsp_fault.h"

#include <algorithm>
#include <array>

namespace cerberus::robot {

namespace {

struct Name {
  Codec codec;
  std::string_view key, encoding;
};
constexpr std::array<Name, 3> kNames{{
    {Codec::h264, "h264", "H264"},
    {Codec::h265, "h265", "H265"},
    {Codec::jpeg, "jpeg", "JPEG"},
}};

const Name& name_of(Codec codec) {
  return *std::ranges::find(kNames, codec, &Name::codec);
}

// What it sends, and what to write instead.
std::string of_streams(const SourceSettings& source, const std::vector<RtspStream>& offered) {
  std::string videos, others;
  const Name* usable = nullptr;
  for (const RtspStream& stream : offered) {
    std::string& list = stream.media == "video" ? videos : others;
    const std::string what = stream.encoding.empty() ? "an unknown encoding" : stream.encoding;
    list += (list.empty() ? "" : ", ") + what + (stream.media == "video" ? "" : " (" + stream.media + ')');
    const auto found = std::ranges::find(kNames, stream.encoding, &Name::encoding);
    if (stream.media == "video" && usable == nullptr && found != kNames.end()) usable = &*found;
  }
  if (videos.empty())
    return "it sends no video" + (others.empty() ? "" : ", but " + others) +
           "; take the path of its video stream, which the camera's manual names";
  const std::string text =
      "it sends " + videos + ", and \"codec\" is \"" + std::string(name_of(source.codec).key) + "\"; ";
  return usable != nullptr ? text + "write codec = \"" + std::string(usable->key) + '"'
                           : text + "set the camera to H.264, H.265 or JPEG";
}

}  // namespace

std::string rtp_encoding(Codec codec) {
  return std::string(name_of(codec).encoding);
}

std::string describe(RtspProblem problem, const SourceSettings& source, const std::string& uri,
                     const std::vector<RtspStream>& offered, const std::string& detail) {
  const std::string where = uri + ": ";
  switch (problem) {
    case RtspProblem::refused:
      return where +
             "the connection is refused; is RTSP switched on in the camera, and is this its port (554 "
             "without one)?";
    case RtspProblem::unknown_host:
      return where + "unknown host; check the name, or write the camera's address";
    case RtspProblem::unreachable:
      return where + "there is no way to this address; check the address, the network and its cables";
    case RtspProblem::no_answer:
      return where + "no answer; is the camera on, and is this its address?";
    case RtspProblem::no_rtsp:
      return where + "what answers is no RTSP server; is this the right port?";
    case RtspProblem::unauthorized:
      return where + (source.user.empty()
                          ? "it asks for a log-in (unauthorized); give \"user\" and \"password-file\""
                          : "it refuses the log-in of \"" + source.user +
                                "\" (unauthorized); check the name and the password in its file");
    case RtspProblem::not_found:
      return where + "the camera has no such path (not found); its manual names the paths of its streams";
    case RtspProblem::streams:
      return where + of_streams(source, offered);
    case RtspProblem::other:
      break;
  }
  return where + detail;
}

}  // namespace cerberus::robot
