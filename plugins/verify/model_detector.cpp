// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_detector.hpp"

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "text/file.h"
#include "vision/persons/darknet_file.h"
#include "vision/persons/network_output.h"
#include "vision/persons/onnx_file.h"

namespace cerberus::plugin {

namespace {

constexpr double kBorder = 114;  // grey level around a picture of another aspect, as YOLO models are trained
constexpr std::size_t kLargestModel = std::size_t{1} << 30, kLargestText = 1 << 20;  // bytes of files
constexpr std::string_view kWeights = ".weights", kConfig = ".cfg";

std::string not_run(const std::string& name, const std::exception& why) {
  return "The model " + name + " cannot be run by OpenCV " + CV_VERSION + ": " + why.what();
}

// What the settings say of the input; nullopt: the layout decides.
struct InputSettings {
  std::optional<std::array<double, 3>> mean, scale;
};

struct Network {
  cv::dnn::Net net;
  vision::Size input;
  int darknet_classes = 0;
};

class ModelDetector : public vision::PersonDetector {
 public:
  ModelDetector(const std::string& name, const Network& network, vision::PersonClass person,
                const InputSettings& settings, double threshold)
      : name_(name),
        net_(network.net),
        outputs_of_net_(net_.getUnconnectedOutLayersNames()),
        reader_(network.input, person, network.darknet_classes),
        own_input_(network.input),
        takes_any_size_(network.darknet_classes > 0),
        input_(network.input),
        settings_(settings),
        threshold_(threshold) {}

  // Once on an empty picture, before the first frame: layers that OpenCV cannot run are thrown as cv::Exception, outputs
  // that cannot be read are returned.
  std::optional<std::string> try_out() {
    const vision::Image<std::uint8_t> nothing(input_);
    std::vector<vision::PersonDetection> none;
    return look(vision::GrayView(nothing.view()), none);
  }

  // What the first picture did not show is found here.
  std::optional<std::string> detect(const vision::PersonPicture& picture, double,
                                    std::vector<vision::PersonDetection>& hits) override {
    try {
      return look(picture, hits);
    } catch (const cv::Exception& e) {
      return not_run(name_, e);
    }
  }
  bool sees_colours() const override { return true; }

 private:
  // OpenCV's Mat takes no constant data; nothing writes through this one.
  static cv::Mat mat_of(vision::GrayView plane) {
    return {plane.height, plane.width, CV_8UC1, const_cast<std::uint8_t*>(plane.data),
            static_cast<std::size_t>(plane.stride)};
  }
  static void fit(vision::GrayView plane, cv::Size size, cv::Mat& to) {
    cv::resize(mat_of(plane), to, size, 0, 0, size.width < plane.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  }

  // The picture in the input's upper left corner, as red, green and blue, and a border around it.
  void frame(const vision::PersonPicture& picture, cv::Size inner) {
    fit(picture.luma, inner, luma_);
    const bool coloured = picture.planes != vision::ColourPlanes::none;
    if (coloured) fit(picture.blue, inner, blue_), fit(picture.red, inner, red_);
    const cv::Rect place({0, 0}, inner);
    for (cv::Mat& plane : rgb_) {
      plane.create(input_.height, input_.width, CV_8UC1);
      plane.setTo(cv::Scalar(kBorder));
      if (!coloured) luma_.copyTo(plane(place));
    }
    for (int y = 0; coloured && y < inner.height; ++y) {
      const std::uint8_t *luma = luma_.ptr(y), *blue = blue_.ptr(y), *red = red_.ptr(y);
      for (int x = 0; x < inner.width; ++x) {
        const auto rgb = vision::rgb_of(luma[x], blue[x], red[x], picture.planes);
        for (std::size_t n = 0; n < rgb.size(); ++n) rgb_[n].ptr(y)[x] = rgb[n];
      }
    }
  }

  // rgb_ as the network takes it.
  void fill_blob() {
    const vision::NetworkInput usual = reader_.usual_input();
    const std::array<double, 3> mean = settings_.mean.value_or(usual.mean),
                                scale = settings_.scale.value_or(usual.scale);
    const int sizes[] = {1, static_cast<int>(rgb_.size()), input_.height, input_.width};
    blob_.create(4, sizes, CV_32F);
    for (std::size_t n = 0; n < rgb_.size(); ++n) {
      cv::Mat levels(input_.height, input_.width, CV_32F, blob_.ptr<float>(0, static_cast<int>(n)));
      rgb_[usual.blue_first ? rgb_.size() - 1 - n : n].convertTo(levels, CV_32F, scale[n],
                                                                 -mean[n] * scale[n]);
    }
  }

  std::optional<std::string> look(const vision::PersonPicture& picture,
                                  std::vector<vision::PersonDetection>& hits) {
    const vision::Size size = picture.luma.size();
    if (takes_any_size_) {
      input_ = vision::darknet_input_for(size, own_input_);
      reader_.set_input(input_);
    }
    const double scale = std::min(static_cast<double>(input_.width) / size.width,
                                  static_cast<double>(input_.height) / size.height);
    frame(picture, {std::clamp(static_cast<int>(scale * size.width), 1, input_.width),
                    std::clamp(static_cast<int>(scale * size.height), 1, input_.height)});
    fill_blob();
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
  const vision::Size own_input_;  // as its file says
  const bool takes_any_size_;
  vision::Size input_;
  const InputSettings settings_;
  const double threshold_;
  cv::Mat luma_, blue_, red_, blob_;
  std::array<cv::Mat, 3> rgb_;
  std::vector<cv::Mat> results_;
  std::vector<vision::NetworkOutput> outputs_;
};

// what: "model", "labels", ...; nullopt: it cannot be read, and `wrong` says so.
std::optional<std::string> contents(const char* what, const std::string& path, std::size_t most,
                                    std::string& wrong) {
  text::File file = text::read_file(path, most);
  switch (file.fault) {
    case text::File::Fault::none:
      return std::move(file.text);
    case text::File::Fault::failed:
      wrong = std::string("The ") + what + " " + path + " cannot be read: " + std::strerror(file.error) + ".";
      break;
    case text::File::Fault::irregular:
      wrong = std::string("The ") + what + " " + path + " cannot be read: it is no file.";
      break;
    case text::File::Fault::too_large:
      wrong = std::string("The ") + what + " " + path + " is too large.";
      break;
  }
  return std::nullopt;
}

// The number of the line `person`; empty lines at the end are no class.
std::optional<vision::PersonClass> person_in(std::string_view labels) {
  vision::PersonClass person;
  for (int n = 1; !labels.empty(); ++n) {
    const std::size_t end = std::min(labels.find('\n'), labels.size());
    std::string_view line = labels.substr(0, end);
    labels.remove_prefix(std::min(end + 1, labels.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!line.empty()) person.classes = n;
    if (line == "person" && person.number < 0) person.number = n - 1;
  }
  return person.number < 0 ? std::nullopt : std::optional(person);
}

std::optional<InputSettings> input_in(const ModelSettings& settings, std::string& wrong) {
  InputSettings input;
  const auto read = [&](const char* name, const std::string& text, std::optional<std::array<double, 3>>& to) {
    if (text.empty() || (to = vision::plane_numbers(text))) return true;
    wrong = std::string("The property ") + name + " takes one number or three, not \"" + text + "\".";
    return false;
  };
  if (!read("mean", settings.mean, input.mean) || !read("scale", settings.scale, input.scale))
    return std::nullopt;
  return input;
}

std::unique_ptr<ModelDetector> onnx_detector(const ModelSettings& settings, const std::string& model,
                                             const vision::PersonClass& person, const InputSettings& input,
                                             std::string& wrong) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(model.data()), model.size());
  const auto size = vision::onnx_input_size(bytes);
  if (!size)
    return wrong = "The model " + settings.model +
                   " is no ONNX file with an input of 1 x 3 x height x width numbers (export it with a fixed "
                   "size), and no darknet weights, whose name ends in .weights.",
           nullptr;
  const auto detector = [&](std::span<const std::uint8_t> file) {
    const Network network{cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(file.data()), file.size()),
                          *size};
    auto made = std::make_unique<ModelDetector>(settings.model, network, person, input, settings.threshold);
    if (const auto refusal = made->try_out()) wrong = *refusal, made.reset();
    return made;
  };
  try {
    return detector(bytes);
  } catch (const cv::Exception&) {
    const auto other = vision::onnx_with_full_factors(bytes);
    if (!other) throw;
    return detector(*other);
  }
}

std::unique_ptr<ModelDetector> darknet_detector(const ModelSettings& settings, const std::string& weights,
                                                const vision::PersonClass& person, const InputSettings& input,
                                                std::string& wrong) {
  const std::string path =
      !settings.config.empty()
          ? settings.config
          : settings.model.substr(0, settings.model.size() - kWeights.size()).append(kConfig);
  const auto cfg = contents("configuration", path, kLargestText, wrong);
  if (!cfg) {
    wrong += " The weights " + settings.model + " need it: beside them, or named by config=.";
    return nullptr;
  }
  std::string fault;
  const auto network = vision::read_darknet_cfg(*cfg, fault);
  if (!network) return wrong = "The configuration " + path + " cannot be used: " + fault + ".", nullptr;
  const auto count = vision::count_darknet_weights(weights);
  if (!count) return wrong = "The model " + settings.model + " holds no darknet weights.", nullptr;
  if (network->weights && *network->weights != *count)
    return wrong = "The model " + settings.model + " has " + std::to_string(*count) +
                   " weights, and its configuration " + path + " needs " + std::to_string(*network->weights) +
                   ": it is another network's, or incomplete.",
           nullptr;
  const std::string lowered = vision::darknet_cfg_with_threshold(*cfg, settings.threshold);
  const Network loaded{
      cv::dnn::readNetFromDarknet(lowered.data(), lowered.size(), weights.data(), weights.size()),
      network->input, network->classes};
  auto made = std::make_unique<ModelDetector>(settings.model, loaded, person, input, settings.threshold);
  if (const auto refusal = made->try_out()) wrong = *refusal, made.reset();
  return made;
}

}  // namespace

std::unique_ptr<vision::PersonDetector> make_model_detector(const ModelSettings& settings,
                                                            std::string& wrong) {
  const auto model = contents("model", settings.model, kLargestModel, wrong);
  if (!model) return nullptr;
  vision::PersonClass person;
  if (!settings.labels.empty()) {
    const auto labels = contents("labels", settings.labels, kLargestText, wrong);
    if (!labels) return nullptr;
    const auto line = person_in(*labels);
    if (!line) return wrong = "The labels " + settings.labels + " have no line that says person.", nullptr;
    person = *line;
  }
  const auto input = input_in(settings, wrong);
  if (!input) return nullptr;
  try {
    return settings.model.ends_with(kWeights) ? darknet_detector(settings, *model, person, *input, wrong)
                                              : onnx_detector(settings, *model, person, *input, wrong);
  } catch (const std::exception& e) {
    return wrong = not_run(settings.model, e), nullptr;
  }
}

}  // namespace cerberus::plugin
