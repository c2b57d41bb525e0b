// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/network_layout.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cerberus::vision {

namespace {

using Box = NetworkLayout::Box;

constexpr int kBox = 4;      // numbers of a box
constexpr int kCorners = 6;  // numbers of a box end to end: corners, score, class
constexpr int kSsd = 7;      // numbers of a box of SSD
constexpr int kCoco = 80;    // classes of the data set that most networks are trained with
// What rounding in a network adds to an edge, in pixels or shares, and to a score. Derived: ten times what half precision
// adds to 1.
constexpr double kRounding = 0.01;
// The largest coordinate that can be a share: boxes go a little beyond the picture.
constexpr double kLargestShare = 1.5;
// To this the scores of a box add up to 1 after a softmax. Derived: without a background they add up to less where
// nothing is, which is at most places.
constexpr double kSumError = 0.05;
// Middles in pixels reach the far side of the picture; offsets in cells stay below this share of it. Derived: of the
// smallest network in use, 64 pixels, it is a cell of 8 pixels.
constexpr double kFarthestOffset = 1.0 / 8;
// Sides of the cells in pixels: YOLO 5 to 11 and X; tiny ones; those with a fourth size.
constexpr std::array<std::array<int, 4>, 5> kCells{
    {{8, 16, 32, 0}, {16, 32, 0, 0}, {8, 16, 32, 64}, {4, 8, 16, 32}, {8, 16, 0, 0}}};

// 1, 3 (YOLO 3, 5 and 7), or 0: no YOLO of this input has so many boxes.
int boxes_per_cell(Size input, int boxes) {
  for (const auto& sides : kCells)
    for (const int each : {1, 3})
      if (boxes == each * count_cells(input, sides)) return each;
  return 0;
}

// The lengths of an output of two dimensions (height: the first), beside dimensions of length 1.
std::optional<Size> two_lengths(const std::vector<int>& shape) {
  if (shape.size() < 2) return std::nullopt;
  std::array<int, 2> lengths{};
  std::size_t found = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const bool spare = shape[i] == 1 && shape.size() - i > 2 - found;
    if (spare) continue;
    if (found == 2) return std::nullopt;
    lengths[found++] = shape[i];
  }
  return Size{lengths[1], lengths[0]};
}

template <typename Holds>
bool all_boxes(const NetworkTable& table, int first, Holds&& holds) {
  for (int i = 0; i < table.boxes; ++i)
    if (table.holds_box(i, first) && !holds(i)) return false;
  return true;
}
bool is_empty(const NetworkTable& table, int first) {
  return all_boxes(table, first, [](int) { return false; });
}
bool is_in_shares(const NetworkTable& table, int first) {
  return all_boxes(table, first, [&](int i) {
    for (int n = first; n < first + kBox; ++n)
      if (std::abs(table.at(i, n)) > kLargestShare) return false;
    return true;
  });
}
bool has_corners(const NetworkTable& table, int first) {
  return all_boxes(table, first, [&](int i) {
    return table.at(i, first + 2) >= table.at(i, first) - kRounding &&
           table.at(i, first + 3) >= table.at(i, first + 1) - kRounding;
  });
}
bool has_class_numbers(const NetworkTable& table, int first, int column) {
  return all_boxes(table, first, [&](int i) {
    return table.at(i, column) >= 0 && table.at(i, column) == std::floor(table.at(i, column));
  });
}

// An output that may hold boxes and scores. Which of its lengths counts boxes: the one that a YOLO of this input has,
// else the larger one; YOLO 8's order where both are equal.
std::optional<NetworkTable> boxes_with_scores(const NetworkOutput& output, Size input) {
  const auto lengths = two_lengths(output.shape);
  if (!lengths) return std::nullopt;
  const int rows = lengths->height, columns = lengths->width;
  if (columns == kBox || (rows == kBox && columns > kCorners)) return std::nullopt;  // boxes without scores
  const bool on_rows = boxes_per_cell(input, rows) > 0, on_columns = boxes_per_cell(input, columns) > 0;
  const bool by_box = rows <= kBox || (columns > kBox && (on_rows != on_columns ? on_rows : rows > columns));
  const NetworkTable table{output.values, by_box ? rows : columns, by_box ? columns : rows, by_box};
  return table.numbers > kBox ? std::optional(table) : std::nullopt;
}

class Decision {
 public:
  Decision(std::span<const NetworkOutput> outputs, Size input, const PersonClass& person, std::string& wrong)
      : outputs_(outputs), input_(input), person_(person), wrong_(wrong) {}

  bool decide() { return two_outputs() || (wrong_.empty() && one_output()); }
  const NetworkLayout& layout() const { return layout_; }

 private:
  bool refuse(const std::string& why) {
    wrong_ = why;
    return false;
  }

  // first: column of the first class; classes: at most so many.
  bool choose_class(int first, int classes, int unnamed) {
    if (person_.classes > classes || person_.number >= classes)
      return refuse("it has " + std::to_string(classes) + " classes, and the labels name " +
                    std::to_string(person_.classes));
    layout_.score = first + (person_.number < 0 ? unnamed : person_.number);
    if (layout_.score >= first + classes) return refuse("there is no class behind the background");
    return true;
  }

  // Boxes in one output of four numbers each, scores in another one.
  bool two_outputs() {
    int boxes = -1, scores = -1, pairs = 0;
    for (std::size_t b = 0; b < outputs_.size(); ++b) {
      const auto lengths = two_lengths(outputs_[b].shape);
      if (!lengths || (lengths->width != kBox && lengths->height != kBox)) continue;
      const bool by_box = lengths->width == kBox;
      for (std::size_t s = 0; s < outputs_.size(); ++s) {
        const auto other = two_lengths(outputs_[s].shape);
        if (s == b || !other || (by_box ? other->height != lengths->height : other->width != lengths->width))
          continue;
        boxes = static_cast<int>(b), scores = static_cast<int>(s), ++pairs;
        layout_.by_box = by_box, layout_.score_numbers = by_box ? other->width : other->height;
      }
    }
    if (pairs == 0) return false;
    if (pairs > 1) return refuse("several lists are as long as that of the boxes");
    layout_.boxes_output = boxes, layout_.scores_output = scores, layout_.box_numbers = kBox;
    layout_.box = Box::corners;
    const auto corners = table_of(outputs_[static_cast<std::size_t>(boxes)], kBox, layout_.by_box);
    const auto all =
        table_of(outputs_[static_cast<std::size_t>(scores)], layout_.score_numbers, layout_.by_box);
    if (is_empty(*corners, 0)) return false;
    if (!has_corners(*corners, 0)) return refuse("the boxes are not left, top, right and bottom");
    layout_.in_shares = is_in_shares(*corners, 0);
    bool background = layout_.score_numbers > 1;
    for (int i = 0; i < all->boxes && background; ++i) {
      if (!corners->holds_box(i, 0)) continue;
      double sum = 0;
      for (int n = 0; n < all->numbers; ++n) sum += all->at(i, n);
      background = !(std::abs(sum - 1) > kSumError);
    }
    // The labels of some networks do not name the background.
    const bool unnamed = background && person_.classes == layout_.score_numbers - 1;
    return unnamed ? choose_class(1, layout_.score_numbers - 1, 0)
                   : choose_class(0, layout_.score_numbers, background ? 1 : 0);
  }

  bool one_output() {
    std::optional<NetworkTable> found;
    int candidates = 0, of_cells = 0;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      const std::vector<int>& shape = outputs_[i].shape;
      if (shape.size() == 4 && shape[1] == 1 && shape[3] == kSsd) return ssd(static_cast<int>(i));
      const auto table = boxes_with_scores(outputs_[i], input_);
      const bool vector = table && table->boxes == 1 && (outputs_.size() > 1 || table->numbers > kCorners);
      if (!table || vector) continue;
      const bool has_cells = boxes_per_cell(input_, table->boxes) > 0;
      ++candidates, of_cells += has_cells;
      if (has_cells ? of_cells == 1 : candidates == 1)
        found = table, layout_.boxes_output = static_cast<int>(i);
    }
    if (!found || of_cells > 1 || (of_cells == 0 && candidates > 1))
      return refuse(candidates > 1
                        ? "more than one may be the list of boxes"
                        : "there is no list of boxes: export it with its boxes decoded, in one list");
    layout_.scores_output = layout_.boxes_output;
    layout_.box_numbers = layout_.score_numbers = found->numbers, layout_.by_box = found->by_box;
    return !is_empty(*found, 0) && (end_to_end(*found) || (wrong_.empty() && yolo(*found)));
  }

  bool ssd(int output) {
    layout_.boxes_output = layout_.scores_output = output;
    layout_.box_numbers = layout_.score_numbers = kSsd, layout_.box = Box::corners;
    layout_.first = 3, layout_.score = 2, layout_.class_column = 1;
    layout_.person = person_.number < 0 ? 1 : person_.number;
    const auto table = table_of(outputs_[static_cast<std::size_t>(output)], kSsd, true);
    if (is_empty(*table, 3)) return false;
    if (!has_corners(*table, 3) || !has_class_numbers(*table, 3, 1))
      return refuse("the seven numbers of a box are not those of SSD");
    layout_.in_shares = is_in_shares(*table, 3);
    return true;
  }

  // YOLO has boxes all over the picture: the middles of some are farther to the right than their boxes are wide, so that
  // they are no corners. A small network may have as many boxes as others have end to end.
  bool end_to_end(const NetworkTable& table) {
    const bool of_yolo = boxes_per_cell(input_, table.boxes) > 0;
    if (table.numbers > kCorners || (table.numbers < kCorners && of_yolo) || !has_corners(table, 0))
      return false;
    layout_.box = Box::corners, layout_.in_shares = is_in_shares(table, 0);
    layout_.score = kBox;
    if (table.numbers < kCorners)
      return (outputs_.size() == 1 && person_.classes <= 1) || refuse("the classes of its boxes are missing");
    layout_.class_column = kBox + 1, layout_.person = std::max(person_.number, 0);
    if (has_class_numbers(table, 0, layout_.class_column)) return true;
    std::swap(layout_.class_column, layout_.score);
    return !of_yolo && has_class_numbers(table, 0, layout_.class_column);
  }

  // Whether each box has a score that there is an object, before those of the classes. nullopt: it cannot be told.
  std::optional<bool> has_object_score(const NetworkTable& table) const {
    const int each = boxes_per_cell(input_, table.boxes), classes = table.numbers - kBox;
    if (classes == 1) return false;
    if (each == 3) return true;
    if (!table.by_box) return false;
    if (person_.classes > 0 && classes == person_.classes + 1) return true;
    if (person_.classes > 0 && classes == person_.classes) return false;
    if (classes == kCoco || classes == kCoco + 1) return classes != kCoco;
    // Six numbers that are not those of end to end: one class. With a box for each cell there may be two.
    return table.numbers == kCorners && each == 0 && person_.classes == 0 ? std::optional(true)
                                                                          : std::nullopt;
  }

  bool yolo(const NetworkTable& table) {
    layout_.box = Box::middle, layout_.class_column = -1;
    const auto object = has_object_score(table);
    if (!object)
      return refuse("a box has " + std::to_string(table.numbers) + " numbers, " +
                    (person_.classes > 0
                         ? "which are not 4 or 5 and the " + std::to_string(person_.classes) +
                               " classes that the labels name"
                         : "which may be 4 or 5 and the classes: name all of them with labels="));
    layout_.object_score = *object ? kBox : -1;
    layout_.in_shares = is_in_shares(table, 0);
    if (!choose_class(kBox + *object, table.numbers - kBox - *object, 0)) return false;
    bool sized = true;
    double farthest = 0;
    bool certain = true;  // that there is an object: YOLO 6 says so of each box
    for (int i = 0; i < table.boxes; ++i) {
      if (!table.holds_box(i, 0)) continue;
      sized = sized && table.at(i, 2) > 0 && table.at(i, 3) > 0;
      farthest = std::max({farthest, table.at(i, 0), table.at(i, 1)});
      certain = certain && table.at(i, kBox) == 1;
    }
    const bool of_yolox = *object && !certain && cells_of(input_, table.boxes);
    layout_.takes_bytes = of_yolox;
    const double reach = kFarthestOffset * std::max(input_.width, input_.height);
    if (of_yolox && (!sized || farthest < reach)) layout_.box = Box::cells, layout_.in_shares = false;
    return true;
  }

  std::span<const NetworkOutput> outputs_;
  Size input_;
  const PersonClass& person_;
  std::string& wrong_;
  NetworkLayout layout_;
};

}  // namespace

std::optional<NetworkTable> table_of(const NetworkOutput& output, int numbers, bool by_box) {
  const auto lengths = two_lengths(output.shape);
  if (!lengths || (by_box ? lengths->width : lengths->height) != numbers) return std::nullopt;
  return NetworkTable{output.values, by_box ? lengths->height : lengths->width, numbers, by_box};
}

std::optional<NetworkTable> table_of_boxes(const NetworkOutput& output, int boxes, bool by_box) {
  const auto lengths = two_lengths(output.shape);
  if (!lengths || (by_box ? lengths->height : lengths->width) != boxes) return std::nullopt;
  return NetworkTable{output.values, boxes, by_box ? lengths->width : lengths->height, by_box};
}

bool is_score(double value) {
  return !std::isfinite(value) || (value >= -kRounding && value <= 1 + kRounding);
}

int count_cells(Size input, std::span<const int> sides) {
  int cells = 0;
  for (const int side : sides)
    if (side > 0) cells += ((input.width + side - 1) / side) * ((input.height + side - 1) / side);
  return cells;
}

NetworkCell cell_at(Size input, std::span<const int> sides, int number) {
  for (const int side : sides) {
    if (side <= 0) break;
    const int columns = (input.width + side - 1) / side, rows = (input.height + side - 1) / side;
    if (number < columns * rows) return {number % columns, number / columns, side};
    number -= columns * rows;
  }
  return {};
}

std::optional<std::span<const int>> cells_of(Size input, int boxes) {
  for (const auto& sides : kCells)
    if (boxes == count_cells(input, sides)) return sides;
  return std::nullopt;
}

std::optional<NetworkLayout> decide_layout(std::span<const NetworkOutput> outputs, Size input,
                                           const PersonClass& person, std::string& wrong) {
  Decision decision(outputs, input, person, wrong);
  return decision.decide() ? std::optional(decision.layout()) : std::nullopt;
}

}  // namespace cerberus::vision
