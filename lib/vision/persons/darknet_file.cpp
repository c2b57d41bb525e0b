// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/darknet_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "text/numbers.h"

namespace cerberus::vision {

namespace {

constexpr int kLargestSide = 8192;  // of a picture, pixels
constexpr int kPlanes = 3;
constexpr int kCell = 32;  // pixels: the side of a yolo layer's coarsest cells
// Pixels up to which a small network's input grows. swept on all development sequences: inputs of 320, 448 and 640 pixels
// squared give a MOTA of .761, .775 and .731 and a recall of one labelled person of .44, .44 and .40; 12, 22 and 40 ms a look.
constexpr int kMostPixels = 448 * 448;
// Of a layer's planes, filters and groups, and of a kernel's side. Chosen: beyond every network, and a layer has no more than
// 2^44 weights.
constexpr int kLargestCount = 1 << 16, kLargestKernel = 1 << 6;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<int> integer_in(std::string_view text) {
  text = trimmed(text);
  int value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() && read.ptr == text.data() + text.size() ? std::optional(value)
                                                                         : std::nullopt;
}

// Numbers with commas between them. nullopt: there is none, or one cannot be read.
std::optional<std::vector<int>> integers_in(std::string_view text) {
  std::vector<int> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    const auto number = integer_in(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers.empty() ? std::nullopt : std::optional(numbers);
}

struct Section {
  std::string_view name;
  std::vector<std::pair<std::string_view, std::string_view>> values;

  std::string_view text(std::string_view key) const {
    const auto found = std::ranges::find(values, key, [](const auto& value) { return value.first; });
    return found == values.end() ? std::string_view() : found->second;
  }
  // The usual value where there is none; -1 where it is no number.
  int number(std::string_view key, int usual) const {
    const std::string_view value = text(key);
    return value.empty() ? usual : integer_in(value).value_or(-1);
  }
};

// nullopt: a line is neither a section nor a value.
std::optional<std::vector<Section>> sections_in(std::string_view cfg) {
  std::vector<Section> sections;
  while (!cfg.empty()) {
    const std::size_t end = std::min(cfg.find('\n'), cfg.size());
    const std::string_view line = trimmed(cfg.substr(0, end));
    cfg.remove_prefix(std::min(end + 1, cfg.size()));
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    if (line.front() == '[' && line.back() == ']') {
      sections.push_back({line.substr(1, line.size() - 2), {}});
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || sections.empty()) return std::nullopt;
    sections.back().values.emplace_back(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
  }
  return sections;
}

// Follows the planes from layer to layer, and counts the weights.
class Layers {
 public:
  // Returns what is wrong.
  std::string add(const Section& layer) {
    int planes = planes_.empty() ? kPlanes : planes_.back();
    if (layer.name == "convolutional") {
      const int filters = layer.number("filters", 1), size = layer.number("size", 1),
                groups = layer.number("groups", 1);
      for (const int each : {filters, groups})
        if (each < 1 || each > kLargestCount) return said("has no usable filters, size or groups");
      if (size < 1 || size > kLargestKernel) return said("has no usable filters, size or groups");
      if (planes % groups != 0) return said("has groups that do not divide its planes");
      const auto of_filters = static_cast<std::uint64_t>(filters);
      // The kernels, a bias, and the scale, mean and variance of a normalisation.
      weights_ += of_filters * static_cast<std::uint64_t>(planes / groups) *
                      static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size) +
                  of_filters * (layer.number("batch_normalize", 0) > 0 ? 4 : 1);
      planes = filters;
    } else if (layer.name == "route") {
      const auto joined = joined_planes(layer);
      if (!joined) return said("names a layer that is not there");
      planes = *joined;
    } else if (std::ranges::find(kWithoutWeights, layer.name) == std::end(kWithoutWeights)) {
      counted_ = false;
    }
    planes_.push_back(planes);
    return {};
  }
  std::optional<std::uint64_t> weights() const { return counted_ ? std::optional(weights_) : std::nullopt; }

 private:
  static constexpr std::string_view kWithoutWeights[] = {"maxpool", "upsample", "dropout", "shortcut",
                                                         "avgpool", "softmax",  "yolo",    "region"};

  std::string said(const char* what) const {
    return "its layer " + std::to_string(planes_.size()) + " " + what;
  }

  std::optional<int> joined_planes(const Section& layer) const {
    const auto named = integers_in(layer.text("layers"));
    const int groups = layer.number("groups", 1), count = static_cast<int>(planes_.size());
    if (!named) return std::nullopt;
    int sum = 0;
    for (const int n : *named) {
      if (n >= count || n < -count) return std::nullopt;
      sum += planes_[static_cast<std::size_t>(n < 0 ? count + n : n)];
      if (sum > kLargestCount) return std::nullopt;
    }
    return sum > 0 && groups > 0 ? std::optional(std::max(1, sum / groups)) : std::nullopt;
  }

  std::vector<int> planes_;  // of each layer's output
  std::uint64_t weights_ = 0;
  bool counted_ = true;
};

}  // namespace

std::optional<DarknetNetwork> read_darknet_cfg(std::string_view cfg, std::string& wrong) {
  const auto refuse = [&](std::string why) {
    wrong = std::move(why);
    return std::nullopt;
  };
  const auto sections = sections_in(cfg);
  if (!sections || sections->empty() ||
      (sections->front().name != "net" && sections->front().name != "network"))
    return refuse("it is no darknet configuration, which begins with [net]");
  const Section& net = sections->front();
  DarknetNetwork network;
  network.input = {net.number("width", 0), net.number("height", 0)};
  for (const int side : {network.input.width, network.input.height})
    if (side < 1 || side > kLargestSide) return refuse("its [net] has no width and height");
  if (net.number("channels", kPlanes) != kPlanes) return refuse("it does not take pictures of three planes");
  Layers layers;
  for (const Section& layer : std::span(*sections).subspan(1)) {
    if (const std::string fault = layers.add(layer); !fault.empty()) return refuse(fault);
    if (layer.name != "yolo" && layer.name != "region") continue;
    const int classes = layer.number("classes", 0);
    if (classes < 1 || classes > kLargestCount)
      return refuse("a [" + std::string(layer.name) + "] layer names no classes");
    // OpenCV reads beyond the anchors.
    if (layer.name == "yolo") {
      const auto mask = integers_in(layer.text("mask"));
      const int anchors = layer.number("num", 1);
      if (!mask || std::ranges::any_of(*mask, [&](int n) { return n < 0 || n >= anchors; }))
        return refuse("the mask of a [yolo] layer names an anchor that is not there");
    }
    if (network.classes > 0 && classes != network.classes)
      return refuse("its [yolo] layers have different classes");
    network.classes = classes;
  }
  if (network.classes == 0) return refuse("it has no [yolo] layer, which finds boxes");
  network.weights = layers.weights();
  return network;
}

Size darknet_input_for(Size frame, Size own) {
  const auto scale_of = [&](Size s) {
    return std::min(static_cast<double>(s.width) / frame.width, static_cast<double>(s.height) / frame.height);
  };
  const int pixels = own.width * own.height;
  const int most = std::max(pixels, std::min(2 * pixels, kMostPixels));
  Size best = own;
  for (int width = kCell; width <= most / kCell; width += kCell) {
    const double needed = std::ceil(static_cast<double>(width) * frame.height / frame.width / kCell) * kCell;
    const int tallest = most / width / kCell * kCell;
    const Size size{width, needed < tallest ? static_cast<int>(needed) : tallest};
    if (scale_of(size) > scale_of(best)) best = size;
  }
  return best;
}

std::string darknet_cfg_with_threshold(std::string_view cfg, double threshold) {
  std::string changed;
  bool yolo = false;
  while (!cfg.empty()) {
    const std::size_t end = std::min(cfg.find('\n'), cfg.size());
    const std::string_view line = cfg.substr(0, end);
    cfg.remove_prefix(std::min(end + 1, cfg.size()));
    const std::string_view read = trimmed(line);
    const bool begins = read.starts_with('[');
    if (begins) yolo = read == "[yolo]";
    // Of two lines the last would count.
    if (yolo && trimmed(read.substr(0, read.find('='))) == "thresh") continue;
    changed.append(line).append("\n");
    if (begins && yolo) changed.append("thresh=").append(text::exact(threshold).string_view()).append("\n");
  }
  return changed;
}

std::optional<std::uint64_t> count_darknet_weights(std::string_view weights) {
  // Version (three 32-bit numbers), then the pictures seen so far, 32 bits before version 0.2 and 64 from it on.
  std::int32_t version[3];
  if (weights.size() < sizeof version) return std::nullopt;
  std::memcpy(version, weights.data(), sizeof version);
  constexpr std::int32_t kNewest = 1000;  // of either number, beyond which OpenCV takes another meaning
  for (const std::int32_t number : version)
    if (number < 0 || number >= kNewest) return std::nullopt;
  const std::size_t header = sizeof version + (version[0] * 10 + version[1] >= 2 ? 8 : 4);
  if (weights.size() < header || (weights.size() - header) % sizeof(float) != 0) return std::nullopt;
  return (weights.size() - header) / sizeof(float);
}

}  // namespace cerberus::vision
