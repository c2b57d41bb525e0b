// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_detector.hpp"

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <vector>

#include "vision/verification/network_output.h"
#include "vision/verification/onnx_input.h"

namespace cerberus::plugin {

namespace {

constexpr double kBorder = 114;  // grey level around a picture of another aspect, as YOLO models are trained
constexpr double kWhite = 255;   // becomes 1

class ModelDetector : public vision::PersonDetector {
 public:
  ModelDetector(cv::dnn::Net net, vision::Size input, int person, double threshold)
      : net_(std::move(net)),
        names_(net_.getUnconnectedOutLayersNames()),
        input_(input),
        person_(person),
        threshold_(threshold) {}

  void detect(vision::GrayView picture, double, std::vector<vision::PersonDetection>& hits) override {
    // OpenCV's Mat takes no constant data; nothing writes through this one.
    const cv::Mat given(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.data),
                        static_cast<std::size_t>(picture.stride));
    const double scale = std::min(static_cast<double>(input_.width) / picture.width,
                                  static_cast<double>(input_.height) / picture.height);
    const cv::Size inner(std::clamp(static_cast<int>(scale * picture.width), 1, input_.width),
                         std::clamp(static_cast<int>(scale * picture.height), 1, input_.height));
    cv::resize(given, scaled_, inner, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    framed_.create(input_.height, input_.width, CV_8UC1);
    framed_.setTo(cv::Scalar(kBorder));
    scaled_.copyTo(framed_(cv::Rect({0, 0}, inner)));
    cv::cvtColor(framed_, colours_, cv::COLOR_GRAY2BGR);
    cv::dnn::blobFromImage(colours_, blob_, 1 / kWhite);
    net_.setInput(blob_);
    net_.forward(results_, names_);
    outputs_.clear();
    for (const cv::Mat& result : results_) {
      if (result.type() != CV_32F || !result.isContinuous())
        throw std::runtime_error("an output of the model is not of floats");
      outputs_.push_back(
          {{result.ptr<float>(), result.total()}, {result.size.p, result.size.p + result.dims}});
    }
    const std::size_t before = hits.size();
    if (!vision::read_persons(outputs_, input_, person_, threshold_, hits))
      throw std::runtime_error(
          "the outputs of the model are not those of a YOLO or SSD network with this class");
    for (std::size_t i = before; i < hits.size(); ++i) {
      vision::Box& box = hits[i].box;
      box = {box.x / scale, box.y / scale, box.width / scale, box.height / scale};
    }
  }

 private:
  cv::dnn::Net net_;
  std::vector<cv::String> names_;
  vision::Size input_;
  int person_;
  double threshold_;
  cv::Mat scaled_, framed_, colours_, blob_;
  std::vector<cv::Mat> results_;
  std::vector<vision::NetworkOutput> outputs_;
};

// The number of the line `person`.
std::optional<int> person_in(std::istream& labels) {
  std::string line;
  for (int n = 0; std::getline(labels, line); ++n) {
    if (line.ends_with('\r')) line.pop_back();
    if (line == "person") return n;
  }
  return std::nullopt;
}

}  // namespace

std::unique_ptr<vision::PersonDetector> make_model_detector(const std::string& model,
                                                            const std::string& labels, double threshold,
                                                            std::string& wrong) {
  std::ifstream file(model, std::ios::binary);
  if (!file) return wrong = "The model " + model + " cannot be read.", nullptr;
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  const auto input = vision::onnx_input_size(bytes);
  if (!input)
    return wrong = "The model " + model +
                   " is no ONNX file with an input of 1 x 3 x height x width numbers: export it with a fixed "
                   "size.",
           nullptr;
  int person = -1;
  if (!labels.empty()) {
    std::ifstream lines(labels);
    if (!lines) return wrong = "The labels " + labels + " cannot be read.", nullptr;
    const auto line = person_in(lines);
    if (!line) return wrong = "The labels " + labels + " have no line that says person.", nullptr;
    person = *line;
  }
  try {
    auto detector = std::make_unique<ModelDetector>(
        cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size()), *input, person,
        threshold);
    // Once on an empty picture: layers that OpenCV cannot run, and heads that are not known, are reported now.
    vision::Image<std::uint8_t> nothing(*input);
    std::vector<vision::PersonDetection> none;
    detector->detect(nothing.view(), 1, none);
    return detector;
  } catch (const std::exception& e) {
    return wrong = "The model " + model + " cannot be run by OpenCV " + CV_VERSION + ": " + e.what(), nullptr;
  }
}

}  // namespace cerberus::plugin
