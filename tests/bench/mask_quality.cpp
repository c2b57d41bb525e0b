// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mask_quality.h"

#include <gst/video/video.h>

#include <algorithm>

#include "boxes.h"
#include "vision/change/fuzzy_threshold.h"
#include "vision/detector.h"
#include "vision/geometry/warp.h"
#include "vision/image/blur.h"
#include "vision/image/median.h"
#include "vision/image/morphology.h"

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

// How far a level is outside those of the 3x3 neighbourhood.
int distance(vision::GrayView picture, int x, int y, int level) {
  int least = 255, most = 0;
  for (int v = std::max(0, y - 1); v <= std::min(picture.height - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(picture.width - 1, x + 1); ++u) {
      least = std::min<int>(least, picture.at(u, v));
      most = std::max<int>(most, picture.at(u, v));
    }
  return std::max({least - level, level - most, 0});
}

class CompensatedDifference {
 public:
  // The mask of the next frame, 0 or 255; it lives until the next call.
  vision::GrayView update(vision::GrayView picture) {
    vision::DetectorFrame frame;
    frame.size = picture.size();
    frame.fresh = ++number_ == 1;
    frame.number = number_;
    const vision::Record record =
        detector_.begin({picture.data, picture.width, picture.height, picture.stride, 1, false, 0, 0, 0});
    const vision::Size size = (*record->luma)->size();
    for (auto* image : {&blurred_, &before_, &registered_, &mask_}) image->resize(size);
    bits_.resize(vision::bit_mask_size(size));
    vision::blur3((*record->luma)->view(), 3, blurred_.view());
    detector_.measure_camera(*record, frame);
    detector_.find_differences(*record, frame);
    mask_.fill_bytes(0);
    if (!frame.fresh && warp_.prepare(frame.motion.in(size, frame.size), size)) {
      warp_.bilinear(before_.view(), registered_.view());
      // The noise of the difference without tolerance: with it most pixels differ by nothing.
      const int threshold = vision::clamp_to_noise(0, vision::noise_sigma(record->differences->histogram));
      for (int y = 0; y < size.height; ++y)
        for (int x = warp_.spans()[static_cast<std::size_t>(y)].begin;
             x < warp_.spans()[static_cast<std::size_t>(y)].end; ++x)
          mask_.view().at(x, y) =
              distance(registered_.view(), x, y, blurred_.view().at(x, y)) > threshold ? 255 : 0;
      vision::pack(mask_.view(), bits_.view());
      morphology_.close(bits_.view(), size.width, kClosing);
      vision::unpack(bits_.view(), mask_.view());
    }
    before_.swap(blurred_);
    return mask_.view();
  }

 private:
  static constexpr int kClosing = 9;  // pixels
  vision::Detector detector_;
  vision::Warp warp_;
  vision::Morphology morphology_;
  vision::Image<std::uint8_t> blurred_, before_, registered_, mask_;
  vision::BitMask bits_;
  std::uint64_t number_ = 0;
};

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

Counts compensated_difference(const Sequence& s, const std::filesystem::path& data) {
  Counts counts;
  const auto frames = load_frames(source_of(s, data), "GRAY8", 0, 0, s.ahead + s.last - s.first + 1);
  const auto truth = load_truth(s, data);
  if (!frames || !truth) return counts;
  CompensatedDifference difference;
  for (int n = 0; n < static_cast<int>(frames->data.size()); ++n) {
    const vision::GrayView mask = difference.update(frames->grey(static_cast<std::size_t>(n)));
    if (const auto k = scored_truth(s, *truth, n)) score(counts, mask, truth->grey(*k), s);
  }
  return counts;
}

}  // namespace cerberus::bench
