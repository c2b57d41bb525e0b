// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_detector.hpp"

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vision/persons/network_output.h"
#include "vision/persons/onnx_file.h"

namespace cerberus::plugin {

namespace {

constexpr double kBorder = 114;  // grey level around a picture of another aspect, as YOLO models are trained
constexpr double kWhite = 255;   // becomes 1

std::string not_run(const std::string& name, const std::exception& why) {
  return "The model " + name + " cannot be run by OpenCV " + CV_VERSION + ": " + why.what();
}

class ModelDetector : public vision::PersonDetector {
 public:
  ModelDetector(const std::string& name, std::span<const std::uint8_t> model, vision::Size input,
                vision::PersonClass person, double threshold)
      : name_(name),
        net_(cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(model.data()), model.size())),
        outputs_of_net_(net_.getUnconnectedOutLayersNames()),
        reader_(input, person),
        input_(input),
        threshold_(threshold) {}

  // Once on an empty picture, before the first frame: layers that OpenCV cannot run are thrown as cv::Exception, outputs
  // that cannot be read are returned.
  std::optional<std::string> try_out() {
    const vision::Image<std::uint8_t> nothing(input_);
    std::vector<vision::PersonDetection> none;
    return look(nothing.view(), none);
  }

  // What the first picture did not show is found here.
  std::optional<std::string> detect(vision::GrayView picture, double,
                                    std::vector<vision::PersonDetection>& hits) override {
    try {
      return look(picture, hits);
    } catch (const cv::Exception& e) {
      return not_run(name_, e);
    }
  }

 private:
  std::optional<std::string> look(vision::GrayView picture, std::vector<vision::PersonDetection>& hits) {
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
    cv::dnn::blobFromImage(colours_, blob_, reader_.takes_bytes() ? 1 : 1 / kWhite);
    net_.setInput(blob_);
    net_.forward(results_, outputs_of_net_);
    outputs_.clear();
    for (const cv::Mat& result : results_)
      if (result.type() == CV_32F && result.isContinuous())
        outputs_.push_back(
            {{result.ptr<float>(), result.total()}, {result.size.p, result.size.p + result.dims}});
    const std::size_t before = hits.size();
    if (const auto wrong = reader_.read(outputs_, threshold_, hits))
      return "The model " + name_ + " cannot be used: " + *wrong;
    for (std::size_t i = before; i < hits.size(); ++i) {
      vision::Box& box = hits[i].box;
      box = {box.x / scale, box.y / scale, box.width / scale, box.height / scale};
    }
    return std::nullopt;
  }

  const std::string name_;
  cv::dnn::Net net_;
  const std::vector<cv::String> outputs_of_net_;
  vision::NetworkReader reader_;
  const vision::Size input_;
  const double threshold_;
  cv::Mat scaled_, framed_, colours_, blob_;
  std::vector<cv::Mat> results_;
  std::vector<vision::NetworkOutput> outputs_;
};

// The number of the line `person`; empty lines at the end are no class.
std::optional<vision::PersonClass> person_in(std::istream& labels) {
  vision::PersonClass person;
  std::string line;
  for (int n = 1; std::getline(labels, line); ++n) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty()) person.classes = n;
    if (line == "person" && person.number < 0) person.number = n - 1;
  }
  return person.number < 0 ? std::nullopt : std::optional(person);
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
  vision::PersonClass person;
  if (!labels.empty()) {
    std::ifstream lines(labels);
    if (!lines) return wrong = "The labels " + labels + " cannot be read.", nullptr;
    const auto line = person_in(lines);
    if (!line) return wrong = "The labels " + labels + " have no line that says person.", nullptr;
    person = *line;
  }
  const auto detector = [&](std::span<const std::uint8_t> file_bytes) {
    auto made = std::make_unique<ModelDetector>(model, file_bytes, *input, person, threshold);
    if (const auto refusal = made->try_out()) wrong = *refusal, made.reset();
    return made;
  };
  try {
    try {
      return detector(bytes);
    } catch (const cv::Exception&) {
      const auto other = vision::onnx_with_full_factors(bytes);
      if (!other) throw;
      return detector(*other);
    }
  } catch (const std::exception& e) {
    return wrong = not_run(model, e), nullptr;
  }
}

}  // namespace cerberus::plugin
