// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/payloaders.h"

#include <utility>

namespace cerberus::publish {

namespace {

// A client that joins needs the parameter sets, which may stand in no session description (plain RTP): the payloader
// repeats them before the first slice of a keyframe, unless it sent some within the last second (config-interval=1).
// With -1 it puts them before every slice of a keyframe (GStreamer 1.22). In the middle of a picture they end it for
// FFmpeg's decoder, which then conceals what is missing, also in all pictures that follow.
constexpr std::pair<std::string_view, std::string_view> kPayloaders[] = {
    {"video/x-h264", "rtph264pay config-interval=1 aggregate-mode=zero-latency"},
    {"video/x-h265", "rtph265pay config-interval=1 aggregate-mode=zero-latency"},
    {"video/x-vp8", "rtpvp8pay"},
    {"video/x-vp9", "rtpvp9pay"},
    {"image/jpeg", "rtpjpegpay"},
    {"application/x-onvif-metadata", "rtponvifmetapay"}};

}  // namespace

std::string_view payloader_of(std::string_view media) {
  for (const auto& [name, payloader] : kPayloaders)
    if (name == media) return payloader;
  return {};
}

}  // namespace cerberus::publish
