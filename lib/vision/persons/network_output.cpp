// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/network_output.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

std::size_t size_of(const std::vector<int>& shape) {
  std::size_t size = 1;
  for (const int n : shape) size *= n > 0 ? static_cast<std::size_t>(n) : 0;
  return size;
}

// "its output 1 x 6 x 300", or "its outputs 1 x 300 x 4, 1 x 300 x 80".
std::string shapes_of(std::span<const NetworkOutput> outputs) {
  std::string all = outputs.size() == 1 ? "its output" : "its outputs";
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t n = 0; n < outputs[i].shape.size(); ++n)
      all += (n > 0 ? " x " : i > 0 ? ", " : " ") + std::to_string(outputs[i].shape[n]);
  return all;
}

// Boxes of YOLOX that are not decoded: cells of all sides row by row, the smallest first.
// x = (cell + dx) side, width = exp(dw) side.
Box decoded(const NetworkTable& table, int i, Size input, std::span<const int> sides) {
  const NetworkCell cell = cell_at(input, sides, i);
  const double width = std::exp(table.at(i, 2)) * cell.side, height = std::exp(table.at(i, 3)) * cell.side;
  return {(cell.column + table.at(i, 0)) * cell.side - width / 2,
          (cell.row + table.at(i, 1)) * cell.side - height / 2, width, height};
}

// A network that returns boxes all over the picture gives each a size, or its boxes are not decoded. Lists of found
// objects may hold nothing but a box that was clipped away at the picture's edge.
bool mostly_sizeless(const NetworkTable& table, const NetworkLayout& layout) {
  if (layout.box != NetworkLayout::Box::middle) return false;
  int boxes = 0, sizeless = 0;
  for (int i = 0; i < table.boxes; ++i) {
    if (!table.holds_box(i, layout.first)) continue;
    ++boxes;
    sizeless += table.at(i, layout.first + 2) <= 0 || table.at(i, layout.first + 3) <= 0;
  }
  return 2 * sizeless > boxes;
}

Box box_of(const NetworkTable& table, int i, const NetworkLayout& layout, Size input) {
  const auto n = [&](int k) { return table.at(i, layout.first + k); };
  if (layout.box == NetworkLayout::Box::cells) {
    const auto sides = cells_of(input, table.boxes);
    return sides ? decoded(table, i, input, *sides) : Box{};
  }
  const double across = layout.in_shares ? input.width : 1, down = layout.in_shares ? input.height : 1;
  if (layout.box == NetworkLayout::Box::corners)
    return {n(0) * across, n(1) * down, (n(2) - n(0)) * across, (n(3) - n(1)) * down};
  return {(n(0) - n(2) / 2) * across, (n(1) - n(3) / 2) * down, n(2) * across, n(3) * down};
}

}  // namespace

// Returns what is wrong.
std::string NetworkReader::read_rows(const NetworkLayout& layout, std::span<const NetworkOutput> outputs,
                                     double threshold, std::vector<PersonDetection>& hits) const {
  const auto count = static_cast<int>(outputs.size());
  if (layout.boxes_output >= count || layout.scores_output >= count) return "there are fewer than before";
  const auto boxes =
      table_of(outputs[static_cast<std::size_t>(layout.boxes_output)], layout.box_numbers, layout.by_box);
  const auto scores =
      table_of(outputs[static_cast<std::size_t>(layout.scores_output)], layout.score_numbers, layout.by_box);
  if (!boxes || !scores || boxes->boxes != scores->boxes) return "the shape was another one before";
  if (mostly_sizeless(*boxes, layout)) return "boxes have no size: export it with its boxes decoded";
  for (int i = 0; i < boxes->boxes; ++i) {
    if (!boxes->holds_box(i, layout.first)) continue;
    double score = scores->at(i, layout.score);
    const double object = layout.object_score < 0 ? 1 : scores->at(i, layout.object_score);
    if (!is_score(score) || !is_score(object))
      return "scores are no probabilities (" + std::to_string(is_score(score) ? object : score) +
             "): export it with the sigmoid or softmax of its scores";
    if (layout.class_column >= 0 && scores->at(i, layout.class_column) != layout.person) continue;
    score = std::min(score * object, 1.0);
    if (!(score >= threshold)) continue;
    const Box box = box_of(*boxes, i, layout, input_);
    if (!std::isfinite(box.width) || !std::isfinite(box.height)) continue;
    if (box.width <= 0 || box.height <= 0) continue;  // clipped at the picture's edge
    hits.push_back({box, score});
  }
  return {};
}

std::string NetworkReader::decide(std::span<const NetworkOutput> outputs) {
  std::string wrong;
  if (darknet_classes_ > 0) {
    decide_darknet(outputs, wrong);
  } else if (nanodet_ = find_nanodet(outputs, input_, person_, wrong); !nanodet_ && wrong.empty()) {
    if (const auto layout = decide_layout(outputs, input_, person_, wrong)) layouts_.push_back(*layout);
  }
  return wrong;
}

// OpenCV decodes the yolo layers, and multiplies the scores of classes by the object's.
void NetworkReader::decide_darknet(std::span<const NetworkOutput> outputs, std::string& wrong) {
  constexpr int kBoxAndObject = 5;
  if (person_.number >= darknet_classes_ || person_.classes > darknet_classes_) {
    wrong = "it has " + std::to_string(darknet_classes_) + " classes, and the labels name " +
            std::to_string(person_.classes);
    return;
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const int numbers = kBoxAndObject + darknet_classes_;
    if (!table_of(outputs[i], numbers, true)) {
      wrong = "a box has " + std::to_string(numbers) + " numbers by its configuration";
      return;
    }
    NetworkLayout layout;
    layout.boxes_output = layout.scores_output = static_cast<int>(i);
    layout.box_numbers = layout.score_numbers = numbers;
    layout.in_shares = true;
    layout.score = kBoxAndObject + std::max(person_.number, 0);
    layouts_.push_back(layout);
  }
}

NetworkInput NetworkReader::usual_input() const {
  if (nanodet_) return {kNanodetMean, kNanodetScale, true};
  if (!layouts_.empty() && layouts_.front().takes_bytes) return {.scale = {1, 1, 1}, .blue_first = true};
  return {};
}

std::optional<std::string> NetworkReader::read(std::span<const NetworkOutput> outputs, double threshold,
                                               std::vector<PersonDetection>& hits) {
  std::string wrong;
  for (const NetworkOutput& output : outputs)
    if (output.values.size() != size_of(output.shape)) wrong = "the shape has another size than the numbers";
  if (wrong.empty() && layouts_.empty() && !nanodet_) wrong = decide(outputs);
  const std::size_t before = hits.size();
  if (wrong.empty() && nanodet_) wrong = read_nanodet(*nanodet_, outputs, input_, threshold, hits);
  for (const NetworkLayout& layout : layouts_)
    if (wrong.empty()) wrong = read_rows(layout, outputs, threshold, hits);
  if (wrong.empty()) return std::nullopt;
  hits.resize(before);
  return shapes_of(outputs) + " cannot be read: " + wrong + ".";
}

}  // namespace cerberus::vision
