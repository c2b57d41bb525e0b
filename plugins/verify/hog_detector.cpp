// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hog_detector.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include <cmath>
#include <vector>

namespace cerberus::plugin {

namespace {

// The grid of the descriptor, as both detectors were trained.
const cv::Size kBlock(16, 16), kBlockStride(8, 8), kCell(8, 8);
constexpr int kBins = 9;
// Step between windows, pixels.
const cv::Size kWindowStride(8, 8);

class HogDetector : public vision::PersonDetector {
 public:
  HogDetector(HogWeights weights, const HogScan& scan)
      : hog_(weights == HogWeights::daimler ? cv::Size(48, 96) : cv::Size(64, 128), kBlock, kBlockStride,
             kCell, kBins),
        scan_(scan) {
    hog_.setSVMDetector(weights == HogWeights::daimler ? cv::HOGDescriptor::getDaimlerPeopleDetector()
                                                       : cv::HOGDescriptor::getDefaultPeopleDetector());
  }

  std::optional<std::string> detect(const vision::PersonPicture& whole, double scale,
                                    std::vector<vision::PersonDetection>& hits) override {
    const vision::GrayView picture = whole.luma;
    // OpenCV's Mat takes no constant data; nothing writes through this one.
    const cv::Mat given(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.data),
                        static_cast<std::size_t>(picture.stride));
    const cv::Size size(static_cast<int>(std::lround(scale * picture.width)),
                        static_cast<int>(std::lround(scale * picture.height)));
    const cv::Size padding(scan_.padding, scan_.padding);
    if (size.empty() || size.width + 2 * padding.width < hog_.winSize.width ||
        size.height + 2 * padding.height < hog_.winSize.height)
      return std::nullopt;
    cv::resize(given, enlarged_, size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    windows_.clear(), scores_.clear();
    hog_.detectMultiScale(enlarged_, windows_, scores_, scan_.threshold, kWindowStride, padding,
                          scan_.scale_step, 0);
    const double sx = static_cast<double>(picture.width) / enlarged_.cols;
    const double sy = static_cast<double>(picture.height) / enlarged_.rows;
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      const cv::Rect& w = windows_[i];
      hits.push_back({{sx * w.x, sy * w.y, sx * w.width, sy * w.height}, scores_[i]});
    }
    return std::nullopt;
  }

 private:
  cv::HOGDescriptor hog_;
  HogScan scan_;
  cv::Mat enlarged_;
  std::vector<cv::Rect> windows_;
  std::vector<double> scores_;
};

}  // namespace

std::unique_ptr<vision::PersonDetector> make_hog_detector(HogWeights weights, const HogScan& scan) {
  return std::make_unique<HogDetector>(weights, scan);
}

}  // namespace cerberus::plugin
