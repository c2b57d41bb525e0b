// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mask_quality.h"

#include <gst/video/video.h>

#include "boxes.h"

namespace cerberus::bench {
namespace {

// The frame as motionview makes it, any format with its luma plane first.
void score_frame(Counts& counts, GstSample* sample, vision::GrayView truth, const Sequence& s) {
  GstVideoInfo info;
  GstVideoFrame frame;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
      !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return;
  score(counts,
        {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)), info.width, info.height,
         GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0)},
        truth, s);
  gst_video_frame_unmap(&frame);
}

}  // namespace

Counts mask_quality(const Sequence& s, const std::filesystem::path& data, const std::string& detector) {
  Counts counts;
  const auto truth = load_truth(s, data);
  if (!truth || !for_each_sample(source_of(s, data) + " ! " + detector +
                                     " ! motionview stage=mask ! videoconvert ! video/x-raw,format=GRAY8 ! "
                                     "appsink name=out sync=false",
                                 [&](GstSample* sample, int n) {
                                   if (const auto k = scored_truth(s, *truth, n))
                                     score_frame(counts, sample, truth->grey(*k), s);
                                 }))
    return {};
  return counts;
}

}  // namespace cerberus::bench
