// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/network_output.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// What rounding in a network adds to a score. Derived: ten times what half precision does.
constexpr double kRounding = 0.01;

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

// What is not finite is no score of a person, and no mistake of the layout.
bool is_score(double value) {
  return !std::isfinite(value) || (value >= -kRounding && value <= 1 + kRounding);
}

// Boxes of YOLOX that are not decoded: cells of all sides row by row, the smallest first.
// x = (cell + dx) side, width = exp(dw) side.
Box decoded(const NetworkTable& table, int i, Size input, std::span<const int> sides) {
  int cell = i;
  for (const int side : sides) {
    const int columns = (input.width + side - 1) / side, rows = (input.height + side - 1) / side;
    if (cell >= columns * rows) {
      cell -= columns * rows;
      continue;
    }
    const double width = std::exp(table.at(i, 2)) * side, height = std::exp(table.at(i, 3)) * side;
    return {(cell % columns + table.at(i, 0)) * side - width / 2,
            (cell / columns + table.at(i, 1)) * side - height / 2, width, height};
  }
  return {};
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
std::string NetworkReader::read_rows(std::span<const NetworkOutput> outputs, double threshold,
                                     std::vector<PersonDetection>& hits) const {
  const NetworkLayout& layout = *layout_;
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

std::optional<std::string> NetworkReader::read(std::span<const NetworkOutput> outputs, double threshold,
                                               std::vector<PersonDetection>& hits) {
  std::string wrong;
  for (const NetworkOutput& output : outputs)
    if (output.values.size() != size_of(output.shape)) wrong = "the shape has another size than the numbers";
  if (wrong.empty() && !layout_) layout_ = decide_layout(outputs, input_, person_, wrong);
  const std::size_t before = hits.size();
  if (wrong.empty() && layout_) wrong = read_rows(outputs, threshold, hits);
  if (wrong.empty()) return std::nullopt;
  hits.resize(before);
  return shapes_of(outputs) + " cannot be read: " + wrong + ".";
}

}  // namespace cerberus::vision
