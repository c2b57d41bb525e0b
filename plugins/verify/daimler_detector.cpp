// SPDX-License-Identifier: LGPL-2.1-or-later
#include "daimler_detector.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include <cstdlib>

namespace cerberus::plugin {

namespace {

// The detector's window and grid, as the weights were trained.
const cv::Size kWindow(48, 96), kBlock(16, 16), kBlockStride(8, 8), kCell(8, 8);
constexpr int kBins = 9;
// Step between scales of the pyramid, and between windows, pixels.
constexpr double kScaleStep = 1.05;
const cv::Size kWindowStride(8, 8);
// Where in the window a person is. Shares of the window, measured on TUD-Campus and PETS09-S2L1.
constexpr double kLeft = 0.17, kTop = 0.07, kWidth = 0.66, kHeight = 0.86;

class DaimlerDetector : public vision::PersonDetector {
 public:
  explicit DaimlerDetector(double threshold)
      : hog_(kWindow, kBlock, kBlockStride, kCell, kBins), threshold_(threshold) {
    hog_.setSVMDetector(cv::HOGDescriptor::getDaimlerPeopleDetector());
  }

  std::optional<std::string> detect(vision::GrayView picture, double scale,
                                    std::vector<vision::PersonDetection>& hits) override {
    // OpenCV's Mat takes no constant data; nothing writes through this one.
    const cv::Mat given(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.data),
                        static_cast<std::size_t>(picture.stride));
    cv::resize(given, enlarged_, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    if (enlarged_.cols < kWindow.width || enlarged_.rows < kWindow.height) return std::nullopt;
    windows_.clear(), scores_.clear();
    hog_.detectMultiScale(enlarged_, windows_, scores_, threshold_, kWindowStride, {}, kScaleStep, 0);
    const double sx = static_cast<double>(picture.width) / enlarged_.cols;
    const double sy = static_cast<double>(picture.height) / enlarged_.rows;
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      const cv::Rect& w = windows_[i];
      hits.push_back({{sx * (w.x + kLeft * w.width), sy * (w.y + kTop * w.height), sx * kWidth * w.width,
                       sy * kHeight * w.height},
                      scores_[i]});
    }
    return std::nullopt;
  }

 private:
  cv::HOGDescriptor hog_;
  double threshold_;
  cv::Mat enlarged_;
  std::vector<cv::Rect> windows_;
  std::vector<double> scores_;
};

}  // namespace

std::unique_ptr<vision::PersonDetector> make_daimler_detector(double threshold) {
  return std::make_unique<DaimlerDetector>(threshold);
}

}  // namespace cerberus::plugin
