// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/network_output.h"

#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kBox = 4;  // numbers of a box

std::vector<int> without_ones(const std::vector<int>& shape, std::size_t least) {
  std::vector<int> rest = shape;
  while (rest.size() > least && rest.front() == 1) rest.erase(rest.begin());
  return rest;
}

std::size_t size_of(const std::vector<int>& shape) {
  std::size_t size = 1;
  for (const int n : shape) size *= n > 0 ? static_cast<std::size_t>(n) : 0;
  return size;
}

void add(std::vector<PersonDetection>& hits, double left, double top, double width, double height,
         double score) {
  const bool sane = std::isfinite(left) && std::isfinite(top) && std::isfinite(width) &&
                    std::isfinite(height) && width > 0 && height > 0;
  if (sane) hits.push_back({{left, top, width, height}, score});
}

bool read_yolo(const NetworkOutput& output, const std::vector<int>& shape, int person, double threshold,
               std::vector<PersonDetection>& hits) {
  const bool by_box = shape[0] > shape[1];  // version 5: a box after the other
  const int boxes = by_box ? shape[0] : shape[1], numbers = by_box ? shape[1] : shape[0];
  const int first = by_box ? kBox + 1 : kBox, wanted = first + std::max(person, 0);
  if (wanted >= numbers) return false;
  const auto at = [&](int box, int n) -> double {
    return output.values[by_box ? static_cast<std::size_t>(box) * numbers + n
                                : static_cast<std::size_t>(n) * boxes + box];
  };
  for (int i = 0; i < boxes; ++i) {
    const double score = at(i, wanted) * (by_box ? at(i, kBox) : 1);
    if (score >= threshold)
      add(hits, at(i, 0) - at(i, 2) / 2, at(i, 1) - at(i, 3) / 2, at(i, 2), at(i, 3), score);
  }
  return true;
}

void read_ssd(const NetworkOutput& output, int boxes, Size input, int person, double threshold,
              std::vector<PersonDetection>& hits) {
  for (int i = 0; i < boxes; ++i) {
    const auto n = output.values.subspan(static_cast<std::size_t>(i) * 7, 7);
    if (n[2] >= threshold && static_cast<int>(n[1]) == person)
      add(hits, n[3] * input.width, n[4] * input.height, (n[5] - n[3]) * input.width,
          (n[6] - n[4]) * input.height, n[2]);
  }
}

}  // namespace

bool read_persons(std::span<const NetworkOutput> outputs, Size input, int person, double threshold,
                  std::vector<PersonDetection>& hits) {
  for (const NetworkOutput& output : outputs)
    if (output.values.size() != size_of(output.shape)) return false;
  const int after_background = person < 0 ? 1 : person;
  if (outputs.size() == 1) {
    const auto shape = without_ones(outputs[0].shape, 2);
    if (shape.size() != 2) return false;
    if (outputs[0].shape.size() == 4) {
      if (shape[1] != 7) return false;
      read_ssd(outputs[0], shape[0], input, after_background, threshold, hits);
      return true;
    }
    return read_yolo(outputs[0], shape, person, threshold, hits);
  }
  if (outputs.size() != 2) return false;
  auto first = without_ones(outputs[0].shape, 2), second = without_ones(outputs[1].shape, 2);
  if (first.size() != 2 || second.size() != 2 || first[0] != second[0]) return false;
  const bool boxes_first = first[1] == kBox;
  const NetworkOutput &boxes = outputs[boxes_first ? 0 : 1], &scores = outputs[boxes_first ? 1 : 0];
  const int classes = boxes_first ? second[1] : first[1];
  if ((boxes_first ? first[1] : second[1]) != kBox || after_background >= classes) return false;
  for (int i = 0; i < first[0]; ++i) {
    const double score = scores.values[static_cast<std::size_t>(i) * classes + after_background];
    const auto n = boxes.values.subspan(static_cast<std::size_t>(i) * kBox, kBox);
    if (score >= threshold)
      add(hits, n[0] * input.width, n[1] * input.height, (n[2] - n[0]) * input.width,
          (n[3] - n[1]) * input.height, score);
  }
  return true;
}

}  // namespace cerberus::vision
