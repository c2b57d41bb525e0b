// SPDX-License-Identifier: LGPL-2.1-or-later
// Pixel F of OpenCV's MOG2 and KNN, scored as tests/bench/quality.cpp scores ours: of the first four sequences the
// data folder's README has the same figures, so that this checks the scoring itself.
#include <gst/gst.h>

#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>

#include "sequences.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

double f_of(const Sequence& s, const Frames& frames, const Frames& truth, cv::BackgroundSubtractor& peer) {
  Counts counts;
  for (int n = 0; n < static_cast<int>(frames.data.size()); ++n) {
    const vision::GrayView v = frames.grey(static_cast<std::size_t>(n));
    const cv::Mat frame(v.height, v.width, CV_8UC1, const_cast<std::uint8_t*>(v.data),
                        static_cast<std::size_t>(v.stride));
    cv::Mat small, mask;
    cv::resize(frame, small, {320, 320 * frame.rows / frame.cols}, 0, 0, cv::INTER_AREA);
    peer.apply(small, mask);  // what the peer calls a shadow counts too, as in the README's table
    if (const auto k = scored_truth(s, truth, n))
      score(counts, {mask.data, mask.cols, mask.rows, static_cast<std::ptrdiff_t>(mask.step)}, truth.grey(*k),
            s);
  }
  return counts.f();
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  cv::setNumThreads(1);
  const auto data = tests::data_folder();
  if (!data) {
    std::printf("skipped: %s\n", tests::kNoData);
    return 77;
  }
  std::printf("Masks of OpenCV's subtractors      MOG2    KNN   by the README\n");
  for (const auto& group : {sequences(), followed_sequences()})
    for (const Sequence& s : group) {
      const auto frames = load_frames(source_of(s, *data), "GRAY8", 0, 0, s.ahead + s.last - s.first + 1);
      const auto truth = load_truth(s, *data);
      if (!frames || !truth) return 1;
      auto mog2 = cv::createBackgroundSubtractorMOG2();
      auto knn = cv::createBackgroundSubtractorKNN();
      std::printf("  %-28s %8.3f %6.3f   %s\n", s.name, f_of(s, *frames, *truth, *mog2),
                  f_of(s, *frames, *truth, *knn), s.reference);
    }
  return 0;
}
